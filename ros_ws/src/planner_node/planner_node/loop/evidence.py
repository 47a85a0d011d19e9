# SPDX-License-Identifier: Apache-2.0
"""What contradicts a plan: frame by frame, and for certain once enough frames agree.

Frames are taken while the arm is in the view. A block that is seen somewhere else counts, however
much of the rest is hidden. One that is not seen counts where nothing hides its place.
"""

from __future__ import annotations

import math
from collections.abc import Iterable
from dataclasses import dataclass
from enum import Enum
from typing import Final

from scene_graph import GraphStatus, Place, SceneObject, hidden_place, is_hidden

from .expectation import RESTING_TOLERANCE, Expectation, Point, Rest
from .scene import Sighting

#: Of a block whose outline is hidden further, nothing is believed.
MIN_VISIBLE: Final = 0.3
#: What is seen this near to the middle of a place, or of a block, from above, is over it [m].
OVER: Final = 0.036
#: A place that is hidden further may hide a block.
MAX_HIDDEN: Final = 0.02


class Kind(Enum):
    """How a block contradicts a plan."""

    ELSEWHERE = "elsewhere"
    UNSEEN = "unseen"
    FOREIGN = "foreign"


#: So many frames have to agree; one is enough that perception calls CONFIDENT. A part of the arm
#: can look like a block, though not for long at one point.
FRAMES: Final = {Kind.ELSEWHERE: 2, Kind.UNSEEN: 2, Kind.FOREIGN: 3}


@dataclass(frozen=True)
class Finding:
    """What one frame says of a block.

    Attributes:
        expected: where it was to rest; None for a foreign one.
        position_world: where it is seen [m]; None if it is not.
    """

    name: str
    kind: Kind
    expected: Rest | None = None
    position_world: Point | None = None

    def agrees_with(self, other: Finding) -> bool:
        """Whether both say the same; a block that is still on its way is not seen twice alike."""
        if self.kind != other.kind:
            return False
        here, there = self.position_world, other.position_world
        return here is None or (there is not None and math.dist(here, there) <= RESTING_TOLERANCE)


@dataclass(frozen=True)
class Suspicion:
    """What several frames say of a block.

    Attributes:
        finding: the newest.
        frames: how many agree.
        step: of the plan, at the first of them.
    """

    finding: Finding
    frames: int
    step: int


class Evidence:
    """Collects what frames say.

    Args:
        patience: so many times as many frames as usual have to agree.

    Attributes:
        expectation: where the blocks are to be, as far as it was learnt.
    """

    def __init__(self, expectation: Expectation, patience: int = 1) -> None:
        self.expectation = expectation
        self._patience = patience
        self._suspicions: dict[str, Suspicion] = {}
        self._fresh: set[str] = set()  # of the newest frame

    def weigh(self, sighting: Sighting, steps: range) -> tuple[Suspicion, ...]:
        """Takes a frame; returns what is certain by now, and what else more than one frame says.

        Nothing is returned while nothing is certain.

        Args:
            steps: those of the plan that may have been under way, at least one.
        """
        graph = sighting.graph
        if not graph.objects:
            return ()
        self._fresh.clear()
        seen = {item.name: item for item in graph.objects if not is_hidden(item.name)}
        # What is hidden there may be any block, and is none that is new.
        hidden = {hidden_place(item.name) for item in graph.objects}
        states = [self.expectation.at(step) for step in steps]
        # It may be in the hand before that is heard of.
        about_to_rise = self.expectation.picked(steps[-1])
        for name in states[0]:
            rests = [state[name] for state in states]
            if is_hidden(name):
                continue
            if None in rests:  # in the hand, or about to be
                self._suspicions.pop(name, None)
                continue
            options = tuple(rest for rest in rests if rest is not None)
            if name not in seen and any(rest.stack in hidden for rest in options):
                continue
            self._weigh_block(name, seen.get(name), options, graph.places, about_to_rise, steps)
        unknown = {hidden_place(name) for name in states[0]}
        visible = [place for place in graph.places if place.index not in unknown]
        for item in seen.values():
            if item.name not in states[0] and _over_a_place(item, visible):
                finding = Finding(item.name, Kind.FOREIGN, None, item.position_world)
                self._suspect(finding, steps)
        for name in [name for name in self._suspicions if name not in states[0]]:
            if name not in seen:
                del self._suspicions[name]
        return self._certain(sighting.status, about_to_rise)

    def _weigh_block(
        self,
        name: str,
        item: SceneObject | None,
        options: tuple[Rest, ...],
        places: tuple[Place, ...],
        about_to_rise: str,
        steps: range,
    ) -> None:
        if item is None:
            if all(_is_seen(rest.stack, places) for rest in options):
                self._suspect(Finding(name, Kind.UNSEEN, options[-1]), steps)
            return
        if item.confidence < MIN_VISIBLE or not all(item.size):
            return
        for rest in options:
            if rest.holds(item.position_world):
                self.expectation.learn(item, rest)
                self._suspicions.pop(name, None)
                return
        if name == about_to_rise and _is_lifted(item, options[-1]):
            return
        self._suspect(Finding(name, Kind.ELSEWHERE, options[-1], item.position_world), steps)

    def _suspect(self, finding: Finding, steps: range) -> None:
        self._fresh.add(finding.name)
        before = self._suspicions.get(finding.name)
        if before is None or not finding.agrees_with(before.finding):
            self._suspicions[finding.name] = Suspicion(finding, 1, steps[-1])
        else:
            self._suspicions[finding.name] = Suspicion(finding, before.frames + 1, before.step)

    def _certain(self, status: GraphStatus, about_to_rise: str) -> tuple[Suspicion, ...]:
        certain = [
            item
            for name, item in self._suspicions.items()
            if name in self._fresh
            and item.frames >= self._needed(item.finding, status, about_to_rise)
        ]
        if not certain:
            return ()
        others = [item for item in self._suspicions.values()
                  if item.frames > 1 and item not in certain]  # fmt: skip
        return (*certain, *others)

    def _needed(self, finding: Finding, status: GraphStatus, about_to_rise: str) -> int:
        if status is GraphStatus.CONFIDENT:
            return self._patience
        # A block that is seen may be in the hand already, and that report still be on its way.
        may_be_held = finding.kind is Kind.ELSEWHERE and finding.name == about_to_rise
        return self._patience * (FRAMES[finding.kind] + may_be_held)


def _is_seen(stack: int, places: Iterable[Place]) -> bool:
    return any(place.index == stack and place.hidden <= MAX_HIDDEN for place in places)


def _is_lifted(item: SceneObject, rest: Rest) -> bool:
    """Whether a block is right above where it rested."""
    dx, dy, dz = (a - b for a, b in zip(item.position_world, rest.position_world))
    return math.hypot(dx, dy) <= OVER and dz > 0.0


def _over_a_place(item: SceneObject, places: Iterable[Place]) -> bool:
    here = item.position_world[:2]
    return any(math.dist(here, place.position_world[:2]) <= OVER for place in places)
