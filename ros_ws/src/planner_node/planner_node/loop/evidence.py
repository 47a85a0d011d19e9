# SPDX-License-Identifier: Apache-2.0
"""What contradicts a plan: frame by frame, and for certain once enough frames agree.

Frames are taken while the arm is in the view. A block that is seen somewhere else counts, however
much of the rest is hidden. One that is not seen counts where nothing hides where it is to be. What
is plain in one frame waits for no other: the hand may be about to close.
"""

from __future__ import annotations

import math
from collections.abc import Iterable
from dataclasses import dataclass
from enum import Enum
from typing import Final

from scene_graph import (
    UP,
    GraphStatus,
    Place,
    Relation,
    SceneGraph,
    SceneObject,
    hidden_place,
    is_hidden,
)

from .expectation import RESTING_TOLERANCE, Expectation, Point, Rest
from .likeness import by_name
from .scene import Sighting

#: Of a block whose outline is hidden further, nothing is believed.
MIN_VISIBLE: Final = 0.3
#: A block that was moved has come to rest when it is seen twice as near as this [m].
STILL: Final = 0.004
#: What is seen this near to the middle of a place, or of a block, from above, is over it [m].
OVER: Final = 0.036
#: A place that is hidden further may hide a block, ...
MAX_HIDDEN: Final = 0.02
#: ... though less than half of one up to this: a block is a tenth of what is over a place.
HALF_HIDDEN: Final = 0.05


class Kind(Enum):
    """How a block contradicts a plan."""

    ELSEWHERE = "elsewhere"
    UNSEEN = "unseen"
    FOREIGN = "foreign"
    NUDGED = "nudged"


#: A part of the arm can look like a block, though not in so many frames at one point.
FOREIGN_FRAMES: Final = 3
#: A block of which as much is seen, and that is this much further from where it was to be than it
#: may be [m], is plainly elsewhere.
PLAINLY: Final = 0.6
BEYOND: Final = 0.005
#: What is seen this near to where a block was to be [m] may be this block, badly measured.
NEAR: Final = 0.03
#: The hand lifts what it takes; what is seen no higher than this over its rest [m] it has not.
LIFTED: Final = 0.01


@dataclass(frozen=True)
class Finding:
    """What one frame says of a block.

    Attributes:
        expected: where it was to rest; None for a foreign one.
        position_world: where it is seen [m]; None if it is not.
        frames: so many have to agree, of which one is enough that perception calls CONFIDENT.
    """

    name: str
    kind: Kind
    expected: Rest | None = None
    position_world: Point | None = None
    frames: int = 2

    def agrees_with(self, other: Finding) -> bool:
        """Whether both say the same; a block that is still on its way is not seen twice alike."""
        if self.kind != other.kind:
            return False
        here, there = self.position_world, other.position_world
        most = STILL if self.kind is Kind.NUDGED else RESTING_TOLERANCE
        return here is None or (there is not None and math.dist(here, there) <= most)


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
        nudged: the blocks that were moved a little before the plan has moved them, as they are seen
            now; that contradicts nothing.
    """

    def __init__(self, expectation: Expectation, patience: int = 1) -> None:
        self.expectation = expectation
        self.nudged: dict[str, SceneObject] = {}
        self._patience = patience
        self._suspicions: dict[str, Suspicion] = {}
        self._fresh: set[str] = set()  # of the newest frame
        self._in_place: set[str] = set()  # likewise

    @property
    def doubts(self) -> bool:
        """Whether anything in the newest frame speaks against the plan, though not for certain."""
        found = [self._suspicions[name].finding for name in self._fresh if name in self._suspicions]
        return any(item.kind is not Kind.FOREIGN or item.frames < FOREIGN_FRAMES for item in found)

    def is_in_place(self, name: str) -> bool:
        """Whether a block is seen in the newest frame where it is to rest."""
        return name in self._in_place

    def weigh(self, sighting: Sighting, steps: range) -> tuple[Suspicion, ...]:
        """Takes a frame; returns what is certain by now, and what else more than one frame says.

        Nothing is returned while nothing is certain.

        Args:
            steps: those of the plan that may have been under way, at least one.
        """
        graph = sighting.graph
        self._fresh.clear()
        self._in_place.clear()
        if not graph.objects:
            return ()
        # What is hidden there may be any block, and is none that is new.
        hidden = {hidden_place(item.name) for item in graph.objects}
        states = [self.expectation.at(step) for step in steps]
        seen = by_name([item for item in graph.objects if not is_hidden(item.name)], states)
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
            self._weigh_block(name, seen.get(name), options, graph, about_to_rise, steps)
        unknown = {hidden_place(name) for name in states[0]}
        visible = [item for item in graph.places if item.index not in unknown and not item.aside]
        for name, item in seen.items():
            if name not in states[0] and all(item.size) and _over_a_place(item, visible):
                frames = FOREIGN_FRAMES
                if item.confidence >= PLAINLY and _is_on_something(item, graph):
                    # It may be one of the others by another name, unless these are all seen.
                    frames = 1 if states[0].keys() <= seen.keys() else 2
                finding = Finding(name, Kind.FOREIGN, None, item.position_world, frames)
                self._suspect(finding, steps)
        for name in [name for name in self._suspicions if name not in states[0]]:
            if name not in seen:
                del self._suspicions[name]
        return self._certain(sighting.status)

    def _weigh_block(
        self,
        name: str,
        item: SceneObject | None,
        options: tuple[Rest, ...],
        graph: SceneGraph,
        about_to_rise: str,
        steps: range,
    ) -> None:
        lies = item is not None and not all(item.size)
        if item is not None and lies and any(_is_at(item, rest) for rest in options):
            return  # it stands, and is measured badly
        if item is None or lies:
            # What lies may be a part of the arm that looks like it: where it was to be tells.
            if all(_is_seen(rest, graph.places, HALF_HIDDEN) for rest in options):
                # Something else in its place may be it, by another name. What the hand is to take
                # it may have taken, and the report of that be on its way; by the next frame of a
                # machine that has a lot to do it has come. Meanwhile no fingers close.
                doubt = any(_is_at(other, rest) for other in graph.objects for rest in options)
                doubt |= not all(_is_seen(rest, graph.places) for rest in options)
                held = name == about_to_rise
                kind, where = Kind.UNSEEN, None
                if item is not None:
                    kind, where = Kind.ELSEWHERE, item.position_world
                self._suspect(Finding(name, kind, options[-1], where, 1 + doubt + held), steps)
            elif item is not None and item.confidence >= PLAINLY and name != about_to_rise:
                # It may be what hides where it was to be; the hand hides what it is at.
                where = item.position_world
                finding = Finding(name, Kind.ELSEWHERE, options[-1], where, FOREIGN_FRAMES)
                self._suspect(finding, steps)
            return
        if item.confidence < MIN_VISIBLE:
            return
        for rest in options:
            if rest.holds(item.position_world):
                self.expectation.learn(item, rest)
                self._suspicions.pop(name, None)
                self._in_place.add(name)
                return
        if self._is_nudged(item, options, graph):
            finding = Finding(name, Kind.NUDGED, options[-1], item.position_world, 2)
            if self._suspect(finding, steps).frames >= finding.frames:
                del self._suspicions[name]
                self._fresh.discard(name)
                self._in_place.add(name)
                self.nudged[name] = item
                self.expectation.move(item)
            return
        held = name == about_to_rise
        if held and _is_lifted(item, options[-1]):
            return
        held &= item.position_world[2] > options[-1].position_world[2] + LIFTED
        off = min(math.dist(item.position_world, r.position_world) - r.tolerance for r in options)
        doubt = item.confidence < PLAINLY or off <= BEYOND
        finding = Finding(name, Kind.ELSEWHERE, options[-1], item.position_world, 1 + doubt + held)
        self._suspect(finding, steps)

    def _is_nudged(self, item: SceneObject, options: tuple[Rest, ...], graph: SceneGraph) -> bool:
        """Whether a block stands on what it stood on, a little aside, and the plan can take it."""
        rest = options[-1]
        stands = Relation(item.name, UP, rest.support) in graph.relations
        near = all(option.nearly_holds(item.position_world) for option in options)
        return stands and near and item.confidence >= PLAINLY

    def _suspect(self, finding: Finding, steps: range) -> Suspicion:
        self._fresh.add(finding.name)
        before = self._suspicions.get(finding.name)
        if before is None or not finding.agrees_with(before.finding):
            self._suspicions[finding.name] = Suspicion(finding, 1, steps[-1])
        else:
            self._suspicions[finding.name] = Suspicion(finding, before.frames + 1, before.step)
        return self._suspicions[finding.name]

    def _certain(self, status: GraphStatus) -> tuple[Suspicion, ...]:
        certain = [
            item
            for name, item in self._suspicions.items()
            if name in self._fresh
            and item.finding.kind is not Kind.NUDGED
            and item.frames
            >= self._patience * (1 if status is GraphStatus.CONFIDENT else item.finding.frames)
        ]
        if not certain:
            return ()
        others = [item for item in self._suspicions.values()
                  if item.frames > 1 and item not in certain]  # fmt: skip
        return (*certain, *others)


def _is_at(item: SceneObject, rest: Rest) -> bool:
    """Whether what is seen there may be a block that rests there, measured badly."""
    return math.dist(item.position_world, rest.position_world) <= NEAR


def _is_on_something(item: SceneObject, graph: SceneGraph) -> bool:
    """Whether a block is seen to stand on a place or a block, and not in the air."""
    low = item.position_world[2] - 0.5 * item.size[2]
    tops = [place.position_world[2] for place in graph.places if not place.aside]
    tops += [
        other.position_world[2] + 0.5 * other.size[2]
        for other in graph.objects
        if math.dist(other.position_world[:2], item.position_world[:2]) <= OVER
    ]
    return any(abs(low - top) <= LIFTED for top in tops)


def _is_seen(rest: Rest, places: Iterable[Place], most: float = MAX_HIDDEN) -> bool:
    """Whether nothing hides a block that rests there.

    Args:
        most: how much of what is over its place may be hidden.
    """
    top = rest.position_world[2] + 0.5 * rest.height
    return _is_clear(rest, places, most) or any(
        place.index == rest.stack and top <= place.position_world[2] + place.seen_to
        for place in places
    )


def _is_clear(rest: Rest, places: Iterable[Place], most: float) -> bool:
    """Whether nothing is over the place of a block: not the hand either."""
    return any(place.index == rest.stack and place.hidden <= most for place in places)


def _is_lifted(item: SceneObject, rest: Rest) -> bool:
    """Whether a block is right above where it rested."""
    dx, dy, dz = (a - b for a, b in zip(item.position_world, rest.position_world))
    return math.hypot(dx, dy) <= OVER and dz > LIFTED


def _over_a_place(item: SceneObject, places: Iterable[Place]) -> bool:
    here = item.position_world[:2]
    return any(math.dist(here, place.position_world[:2]) <= OVER for place in places)
