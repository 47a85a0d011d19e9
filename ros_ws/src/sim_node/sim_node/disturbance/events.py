# SPDX-License-Identifier: Apache-2.0
"""Events of the hand, read off the physics' contacts step by step: the same every time."""

from __future__ import annotations

from typing import Final

from ..world import World
from .hand import gap_beneath, touched_block
from .request import DEFAULT_HEIGHT, EVENTS, GRASP, IN_AIR, RELEASE, Request

#: A block is in the hand, or out of it, once the contacts say so in so many steps in a row: fingers
#: that close may bounce, and those that carry something may lose touch for a step.
STEADY_STEPS: Final = 5

_WORDS: Final = {GRASP: "grasp", RELEASE: "release", IN_AIR: "lift"}


class HoldWatch:
    """Which block is in the hand.

    Args:
        held: which one is now.

    Attributes:
        held: its name, or an empty string.
    """

    def __init__(self, held: str) -> None:
        self.held = held
        self._other, self._steps = held, 0

    def observe(self, touched: str) -> tuple[str, str]:
        """To be told of each step which block both fingers touch.

        Returns:
            Which block has left the hand now, and which one has come into it; empty strings for
            none.
        """
        if touched != self._other:
            self._other, self._steps = touched, 0
        self._steps += 1
        if touched == self.held or self._steps < STEADY_STEPS:
            return "", ""
        before, self.held = self.held, touched
        return before, touched


class EventWatch:
    """Waits for the n-th event of a kind from now on.

    Args:
        kind: GRASP, RELEASE or IN_AIR.
        count: the n, from 1.
        of: the block that is meant; empty: any.
        height: from which on a block is in the air [m].
    """

    def __init__(self, world: World, kind: str, count: int, of: str, height: float) -> None:
        assert kind in EVENTS
        self._world, self._kind, self._left, self._of = world, kind, count, of
        self._height = height
        self._hold = HoldWatch(touched_block(world))
        self._was_lifted = False

    def observe(self, touched: str) -> str:
        """The block of the awaited event if it is now, else an empty string; once a step."""
        name = self._happening(touched)
        if not name or self._of not in ("", name):
            return ""
        self._left -= 1
        return name if self._left == 0 else ""

    def _happening(self, touched: str) -> str:
        released, grasped = self._hold.observe(touched)
        if self._kind == GRASP:
            return grasped
        if self._kind == RELEASE:
            return released
        if released or grasped:
            self._was_lifted = False
        held = self._hold.held
        if self._was_lifted or held not in self._world.names:
            return ""
        self._was_lifted = gap_beneath(self._world, held) > self._height
        return held if self._was_lifted else ""


def watch_of(request: Request, world: World) -> EventWatch | None:
    """The watch that a request asks for; None for one that names no event."""
    if request.when not in EVENTS:
        return None
    height = request.height or DEFAULT_HEIGHT
    return EventWatch(world, request.when, max(request.count, 1), request.of, height)


def describe_moment(request: Request) -> str:
    """``at the 2nd grasp of red_box``, ``now``, … for people."""
    after = f"{request.delay:g} s after " if request.delay else ""
    if request.when in EVENTS:
        count = "" if request.count <= 1 else f"{_ordinal(request.count)} "
        which = f" of {request.of}" if request.of else ""
        word = _WORDS[request.when]
        if request.when == IN_AIR:
            which += f" to more than {request.height or DEFAULT_HEIGHT:g} m"
        return f"{after or 'at '}the {count or 'next '}{word}{which}"
    if request.step is not None:
        return f"{after or 'at '}the time asked for"
    return f"in {request.delay:g} s" if request.delay else "now"


def _ordinal(number: int) -> str:
    ending = "th" if number % 100 in (11, 12, 13) else {1: "st", 2: "nd", 3: "rd"}.get(
        number % 10, "th"
    )  # fmt: skip
    return f"{number}{ending}"
