# SPDX-License-Identifier: Apache-2.0
"""Sentences with what they mean, in a notation of their own that shares nothing with the reader.

A line of a file is ``scene | sentence | meaning``. A meaning is atoms joined by commas:
``red on blue``, ``red on 1`` (directly), ``red in 1``, ``red above blue``, ``red left blue``,
``red beside blue``, ``red with blue`` (in one stack), each behind ``not`` as well;
``2 all in 1``, ``0-2 all in 1``, ``1- red/blue on green`` (how many of them); ``?``: to be asked
back, since no state or more than one reading is meant.
"""

from __future__ import annotations

import re
from collections.abc import Iterator
from dataclasses import dataclass
from functools import lru_cache
from pathlib import Path
from typing import Final

from planner_states import all_states

from planner_node import PlannerError
from planner_node.goals import parse_goal, resolve_goal
from scene_graph import Stacks, spots_of

SCENES: Final = {
    "A": (3, ("red_box", "blue_box", "green_box", "yellow_box", "cyan_box")),
    "B": (3, ("red_box", "red_cylinder", "blue_box", "green_box", "yellow_sphere")),
    "C": (4, ("purple_box", "orange_box", "pink_cylinder", "brown_box", "white_box")),
}
_SPOTS: Final = lru_cache(maxsize=20_000)(spots_of)
_NUMBER: Final = re.compile(r"(\d+)(-?)(\d*) (\S+) (.*)")


@dataclass(frozen=True)
class Sentence:
    """What is said in which scene, and what it means."""

    scene: str
    text: str
    meaning: str

    def holds(self, stacks: Stacks) -> bool:
        """Whether a state is what is meant."""
        names = SCENES[self.scene][1]
        return all(_holds(atom, stacks, names) for atom in self.meaning.split(", "))

    def outcome(self) -> tuple[str, str]:
        """``right``, ``asked`` or ``wrong``; and what was understood, or asked."""
        places, names = SCENES[self.scene]
        try:
            goal = resolve_goal(parse_goal(self.text), names, places)
        except PlannerError as error:
            return ("right" if self.meaning == "?" else "asked"), str(error)
        states = _states(self.scene)[::7]

        def said(state: Stacks) -> bool:
            return goal.holds_at(_SPOTS(state))

        if self.meaning == "?":
            # What no state fulfils is refused before anything moves.
            return ("wrong" if any(map(said, states)) else "right"), str(goal)
        meant = [state for state in states if self.holds(state)]
        if len(meant) < 10:
            # So narrow a meaning is compared on all that it allows as well.
            meant = [state for state in _states(self.scene) if self.holds(state)]
        same = all(map(said, meant)) and all(self.holds(state) for state in states if said(state))
        return ("right" if same else "wrong"), str(goal)


def told_in(path: Path) -> Iterator[Sentence]:
    """The sentences of a file; lines that begin with # say who speaks."""
    for line in path.read_text(encoding="utf-8").splitlines():
        if line and not line.startswith("#"):
            scene, text, meaning = line.split(" | ")
            yield Sentence(scene, text, meaning)


@lru_cache(maxsize=3)
def _states(scene: str) -> tuple[Stacks, ...]:
    places, names = SCENES[scene]
    return tuple(all_states(names, places))


def _block(said: str, names: tuple[str, ...]) -> str:
    (found,) = [name for name in names if said in (name, name.split("_")[0])]
    return found


def _holds(atom: str, stacks: Stacks, names: tuple[str, ...]) -> bool:
    if atom.startswith("not "):
        return not _holds(atom.removeprefix("not "), stacks, names)
    if match := _NUMBER.fullmatch(atom):
        least, most = int(match[1]), int(match[3] or (99 if match[2] else match[1]))
        who = names if match[4] == "all" else match[4].split("/")
        return least <= sum(_holds(f"{one} {match[5]}", stacks, names) for one in who) <= most
    subject, relation, object_ = atom.split(" ")
    block = _block(subject, names)
    place = next(index for index, stack in enumerate(stacks) if block in stack)
    level = stacks[place].index(block)
    if object_.isdigit():
        return place == int(object_) and (relation == "in" or level == 0)
    other = _block(object_, names)
    theirs = next(index for index, stack in enumerate(stacks) if other in stack)
    below = stacks[theirs].index(other)
    return {
        "on": place == theirs and level == below + 1,
        "above": place == theirs and level > below,
        "left": place < theirs,
        "beside": abs(place - theirs) == 1,
        "with": place == theirs,
    }[relation]
