# SPDX-License-Identifier: Apache-2.0
"""Joint states that go to and fro without getting anywhere: noise, in which nothing rests."""

from __future__ import annotations

from typing import Final

from ..robots.joints import JointValues

#: Stretches that are judged as one: at least so long, by the driver's clock, and so many states.
_STRETCH_SECONDS: Final = 2.0
_STRETCH_STATES: Final = 60
#: Who goes this many times as far as he ever gets from where he began, and never stands still for
#: so long [s], shakes. An arm that picks and places may be back where it was when a stretch ends.
_TO_AND_FRO: Final = 10.0
_STANDING_SECONDS: Final = 0.5
#: So many stretches in a row.
_STRETCHES: Final = 3


class Shaking:
    """Judges positions stretch by stretch."""

    def __init__(self) -> None:
        self._in_a_row, self._since, self._states = 0, 0.0, 0
        self._way = self._got = self._step = 0.0
        self._first: JointValues | None = None
        self._last: JointValues | None = None

    def problem(self, stamp: float, positions: JointValues, resting: float) -> str:
        """Takes in the next state; what is wrong with the last ones, empty: nothing.

        Args:
            stamp: by the clock of the arm's driver [s].
            resting: for how long no joint has moved, by that clock [s].
        """
        first, last = self._first, self._last
        if first is None or last is None or stamp < self._since or resting >= _STANDING_SECONDS:
            self._in_a_row = 0
            self._begin(stamp, positions)
            return ""
        self._states += 1
        self._way += float(max(positions.furthest(last)))
        self._got = max(self._got, *map(float, positions.furthest(first)))
        self._last = positions
        if stamp - self._since >= _STRETCH_SECONDS and self._states >= _STRETCH_STATES:
            shaken = self._way > _TO_AND_FRO * self._got
            self._in_a_row = self._in_a_row + 1 if shaken else 0
            self._step = self._way / self._states
            self._begin(stamp, positions)
        if self._in_a_row < _STRETCHES:
            return ""
        return (
            f"the joints shake by {self._step:.3f} rad from one of the joint_states to the next "
            "without getting anywhere, so nobody can tell when the arm is at rest"
        )

    def _begin(self, stamp: float, positions: JointValues) -> None:
        self._since, self._states, self._way, self._got = stamp, 0, 0.0, 0.0
        self._first = self._last = positions
