# SPDX-License-Identifier: Apache-2.0
"""Tasks: what is to be built, and whether it was, judged by the simulator's ground truth."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import asdict, dataclass
from typing import Any, Final

import numpy as np

from planner_node.errors import UnknownObjectError
from planner_node.goals import parse_goal, resolve_name
from scene_graph import BASIC_COLORS, BOX, Relation, Stacks, object_name, up_relations
from sim_node.layouts import MAX_BLOCKS, random_arrangement, random_layout

#: How many blocks the demo's scene has where neither the arguments nor the goal ask for more.
DEFAULT_BLOCKS: Final = 5
#: So many scenes are looked through for one that has what a goal names. Of 9 colours, one scene in
#: 126 or more has any given ones, so that this many hold one but for once in 10^30.
_SCENES_TRIED: Final = 10_000


@dataclass(frozen=True)
class Failure:
    """Where and why a task failed."""

    module: str
    reason: str


@dataclass(frozen=True)
class TaskResult:
    """The content of ``result.json``.

    Attributes:
        success: judged by the simulator's ground truth, not by the nodes.
        goal: the goal's text.
        initial, final: true up-relations before and after, as triples.
        moves_planned: moves of the first plan; ``moves_executed``: over all plans.
        timing_s: wall times perceive, plan, motion (optimisation), execute, total [s].
        failure: None on success.
    """

    success: bool
    goal: str
    initial: list[list[str]]
    final: list[list[str]]
    moves_planned: int
    moves_executed: int
    replans: int
    timing_s: dict[str, float]
    failure: Failure | None

    def to_json(self) -> dict[str, Any]:
        """The content of ``result.json``."""
        return asdict(self)


class SceneForGoalError(ValueError):
    """There is no scene for a goal; the sentence says what could be asked for instead."""


def scene_for_goal(goal: str, seed: int, blocks: int | None = None) -> tuple[int, int]:
    """Seed and number of blocks of a random scene that has every block that a goal names.

    The seed is the first from ``seed`` on whose scene has them; without a goal it is ``seed``.

    Args:
        blocks: how many the scene shall have; None: 5, or as many as the goal names.

    Raises:
        SceneForGoalError: the goal names more blocks than that, or some that no random scene has.
        PlannerError: the goal makes no sense, or a name in it fits several blocks.
    """
    if not goal:
        return seed, blocks or DEFAULT_BLOCKS
    boxes = [object_name(color, BOX) for color in BASIC_COLORS]
    named: set[str] = set()
    for words in parse_goal(goal).block_names:
        try:
            named.add(resolve_name(words, boxes))
        except UnknownObjectError as error:
            raise SceneForGoalError(
                f"'{words.text}' is in no scene of the demo; it has boxes, of the colours "
                f"{', '.join(BASIC_COLORS)}"
            ) from error
    count = blocks or max(DEFAULT_BLOCKS, len(named))
    if len(named) > min(count, MAX_BLOCKS):
        raise SceneForGoalError(
            f"the goal names {len(named)} blocks, the scene has {min(count, MAX_BLOCKS)}; "
            f"{MAX_BLOCKS} are possible"
        )
    for candidate in range(seed, seed + _SCENES_TRIED):
        if named <= {name for stack in random_layout(candidate, count) for name in stack}:
            return candidate, count
    raise SceneForGoalError(f"no scene of {count} blocks from seed {seed} on has all of {named}")


def random_goal(names: Sequence[str], seed: int, stack_count: int = 3) -> Stacks:
    """A complete goal: the named blocks in a random state, drawn apart from the start's seed."""
    rng = np.random.default_rng([seed, 1])
    return random_arrangement(sorted(names), rng, stack_count)


def goal_text(stacks: Stacks) -> str:
    """A complete goal in words, from the left and the bottom."""
    relations = [
        (relation.subject, relation.object)
        for relation in sorted(up_relations(stacks), key=lambda item: _order(stacks, item))
    ]
    return ", ".join(f"{subject} on {below}" for subject, below in relations)


def triples(relations: frozenset[Relation]) -> list[list[str]]:
    """Relations for a JSON file, sorted."""
    return [[item.subject, item.predicate, item.object] for item in sorted(relations)]


def _order(stacks: Stacks, relation: Relation) -> tuple[int, int]:
    for index, stack in enumerate(stacks):
        if relation.subject in stack:
            return index, stack.index(relation.subject)
    raise ValueError(f"{relation.subject} is in no stack")
