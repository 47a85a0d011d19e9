# SPDX-License-Identifier: Apache-2.0
"""What a goal means where colours are in doubt: the same in all readings, or what is asked."""

from __future__ import annotations

import contextlib
import re
from collections.abc import Callable, Mapping, Sequence
from dataclasses import replace

from scene_graph import Relation, Stacks, base_name

from ..errors import (
    AmbiguousObjectError,
    ContradictoryGoalError,
    GoalImageError,
    InvalidGoalError,
    NeedsAnswerError,
    UnknownObjectError,
    UnreachableError,
)
from ..goals.goal import Count, Goal, ResolveGoal
from .readings import Doubt, doubts_in, readings_of, renamed
from .scene import Scene

#: What a goal is in one reading: itself, or why it makes no sense.
Meaning = Goal | AmbiguousObjectError | GoalImageError | InvalidGoalError | UnknownObjectError


def certain_goal(resolve: ResolveGoal, scene: Scene, plan: Callable[[Scene, Goal], object]) -> Goal:
    """The goal that fulfils what is wanted in every reading of the scene, in the scene's names.

    Where it means the same in all of them, that is it. Where it does not, it is all that it means
    at once: "every red box in stack0" holds if a box that may be red is there, too.

    Args:
        plan: tries whether that can be.

    Raises:
        NeedsAnswerError: it cannot, or the goal makes no sense in some readings.
        PlannerError: it makes no sense in any: as ``resolve``.
    """
    doubts = doubts_in(scene.graph)
    if not doubts:
        return resolve(scene.on_places, scene.rows)
    readings = list(readings_of(doubts, scene.names))
    meanings = [_meaning(resolve, scene, reading) for reading in readings]
    goals = [item for item in meanings if isinstance(item, Goal)]
    if not goals:
        assert not isinstance(meanings[0], Goal)
        raise meanings[0]
    if len(goals) == len(meanings):
        if len({*map(_content, goals)}) == 1:
            return goals[0]
        goal = _all_of(goals)
        with contextlib.suppress(ContradictoryGoalError, UnreachableError):
            plan(scene, goal)
            return goal
    colors = [tuple(reading.values()) for reading in readings]
    raise question(scene, _matters_most(doubts, dict(zip(colors, meanings))))


def question(scene: Scene, doubt: Doubt) -> NeedsAnswerError:
    """What has to be asked about a block in doubt."""
    *others, last = doubt.colors
    answers = " or ".join(f"answer:='{color}'" for color in doubt.colors)
    return NeedsAnswerError(
        doubt,
        f"is {_where(doubt.name, scene.stacks)} ({doubt.name}) {', '.join(others)} or {last}? The "
        f"goal means something else in each case; ask for it again with {answers}",
    )


class Answers:
    """What was answered beforehand, and a goal found by its help."""

    def __init__(
        self,
        text: str,
        settle: Callable[[Doubt, str], None],
        look: Callable[[], Scene],
        plan: Callable[[Scene, Goal], object],
    ) -> None:
        """See :class:`Answers`.

        Args:
            text: the answers in the order of the questions, with commas between.
            settle: takes it that a block has a colour.
            look: the scene thereafter.
            plan: see :func:`certain_goal`.
        """
        self._left = [part for part in text.split(",") if part.strip()]
        self._settle = settle
        self._look = look
        self._plan = plan

    def goal_in(self, scene: Scene, resolve: ResolveGoal) -> tuple[Scene, Goal]:
        """The scene as it is with the answers that are needed, and the goal in it.

        Raises:
            NeedsAnswerError: there is no answer, or none that fits.
            PlannerError: as :func:`certain_goal` and ``look``.
        """
        while True:
            try:
                return scene, certain_goal(resolve, scene, self._plan)
            except NeedsAnswerError as error:
                if not self._left:
                    raise
                self._settle(error.doubt, _answered(error, self._left.pop(0)))
                scene = self._look()


def _answered(error: NeedsAnswerError, answer: str) -> str:
    """The colour that an answer gives to a question: "orange", "it is the orange one".

    Raises:
        NeedsAnswerError: it is none of those that were asked for; the question once more.
    """
    words = set(re.findall(r"[a-z]+", answer.lower()))
    said = [color for color in error.doubt.colors if color in words]
    if len(said) == 1:
        return said[0]
    raise NeedsAnswerError(error.doubt, f"'{answer.strip()}' does not answer this: {error}")


def _meaning(resolve: ResolveGoal, scene: Scene, reading: Mapping[str, str]) -> Meaning:
    """What the goal is in a reading, in the names of the scene."""
    try:
        goal = resolve(renamed(scene.on_places, reading), scene.rows)
    except (AmbiguousObjectError, GoalImageError, InvalidGoalError, UnknownObjectError) as error:
        return error
    back = {other: name for name, other in reading.items()}
    counts = tuple(
        replace(item, relations=tuple(one.renamed(back) for one in item.relations))
        for item in goal.counts
    )
    return replace(
        goal, relations=tuple(one.renamed(back) for one in goal.relations), counts=counts
    )


def _all_of(goals: Sequence[Goal]) -> Goal:
    relations: dict[Relation, None] = {}
    counts: dict[tuple[frozenset[Relation], int, int], Count] = {}
    for goal in goals:
        relations |= dict.fromkeys(goal.relations)
        for item in goal.counts:
            counts.setdefault((frozenset(item.relations), item.least, item.most), item)
    return replace(goals[0], relations=tuple(relations), counts=tuple(counts.values()))


def _content(meaning: Meaning) -> object:
    """What tells meanings apart."""
    if not isinstance(meaning, Goal):
        return type(meaning)
    counts = frozenset((frozenset(c.relations), c.least, c.most) for c in meaning.counts)
    return frozenset(meaning.relations), counts


def _matters_most(doubts: Sequence[Doubt], meanings: Mapping[tuple[str, ...], Meaning]) -> Doubt:
    """The block about whose colour alone the meaning depends in the most cases."""

    def weight(index: int) -> int:
        groups: dict[tuple[str, ...], set[object]] = {}
        for names, meaning in meanings.items():
            rest = names[:index] + names[index + 1 :]
            groups.setdefault(rest, set()).add(_content(meaning))
        return sum(len(group) - 1 for group in groups.values())

    return doubts[max(range(len(doubts)), key=weight)]


def _where(name: str, stacks: Stacks) -> str:
    """The block by where it is: "the block on top of stack1"."""
    index, stack = next((i, stack) for i, stack in enumerate(stacks) if name in stack)
    place, level = base_name(index), stack.index(name)
    if len(stack) == 1:
        return f"the only block on {place}"
    if level == len(stack) - 1:
        return f"the block on top of {place}"
    if level == 0:
        return f"the lowest block on {place}"
    return f"the block on {stack[level - 1]} on {place}"
