# SPDX-License-Identifier: Apache-2.0
"""Tasks: what is to be built, and whether it was, judged by the simulator's ground truth."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import asdict, dataclass
from typing import Any

import numpy as np

from scene_graph import Relation, Stacks, up_relations
from sim_node.layouts import random_arrangement


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
