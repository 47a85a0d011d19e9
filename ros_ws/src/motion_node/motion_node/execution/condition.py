# SPDX-License-Identifier: Apache-2.0
"""How the arm is: home, at rest or moving, what the hand holds, and where it is."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, replace
from typing import Final

import numpy as np
from numpy.typing import NDArray
from tamp_runtime.motion_report import SOMETHING, ArmPlace, MotionReport

from .arm_state import ArmState, ArmStates

Array = NDArray[np.float64]

#: Older joint states do not tell how the arm is [s].
FRESH_SECONDS: Final = 3.0
#: Standing still for this long is rest for those who ask how the arm is, by its own clock [s].
REST_SECONDS: Final = 0.15
#: Joints this near to home, or as near as an arrival needs, are home [rad].
HOME_TOLERANCE: Final = 0.05
#: Fingers this near to fully open hold nothing [m].
OPEN_MARGIN: Final = 0.0025
#: Fingers this near to each other, or to where they were sent, hold nothing [m].
CLOSED_MARGIN: Final = 0.002


@dataclass(frozen=True)
class Grip:
    """What is known of the hand from what it was told to do.

    Attributes:
        held: the block that it has taken and not let go; empty: none.
        move: index of the move that the block was taken for; -1: there is none.
        sent: where the fingers were sent last [m]; None: they have not been.
        known: whether a trajectory is watched that says what the hand does.
        doubtful: the arm went on unseen since; ``held`` may be another block by now.
    """

    held: str = ""
    move: int = -1
    sent: float | None = None
    known: bool = False
    doubtful: bool = False


def in_the_hand(state: ArmState, grip: Grip, travel: float) -> str:
    """What the hand holds, as far as fingers can tell: a block, SOMETHING, or nothing.

    Fingers that were stopped by something neither are open nor got to where they were sent.

    Args:
        travel: finger position when fully open [m].
    """
    opening = float(np.mean(state.positions.fingers))
    if opening >= travel - OPEN_MARGIN or opening <= CLOSED_MARGIN:
        return ""
    if grip.sent is not None and abs(opening - grip.sent) <= CLOSED_MARGIN:
        return ""
    if grip.held or grip.known:
        return grip.held
    return SOMETHING if state.resting >= REST_SECONDS else ""


class Condition:
    """Tells how the arm is, from its joint states and what the hand was told to do.

    Args:
        arm: where the arm's states arrive.
        grip: what is known of the hand.
        home: the configuration at rest, shape (n,) [rad].
        travel: finger position when fully open [m].
        tool_at: gives the point between the fingertips in world, shape (3,) [m]; None while the
            robot description is not there.
        tolerance: deviation of a joint that counts as arrived [rad].
    """

    def __init__(
        self,
        arm: ArmStates,
        grip: Callable[[], Grip],
        home: Array,
        travel: float,
        tool_at: Callable[[Array], Array | None] = lambda _q: None,
        tolerance: Callable[[], float] = lambda: 0.0,
    ) -> None:
        self._arm, self._grip = arm, grip
        self._home, self._travel = home, travel
        self._tool_at, self._tolerance = tool_at, tolerance

    @property
    def place(self) -> ArmPlace:
        """Where the arm is."""
        state = self._arm.newest()
        if state is None or self._arm.now() - state.received > FRESH_SECONDS:
            return ArmPlace.UNKNOWN
        if state.resting < REST_SECONDS:
            return ArmPlace.MOVING
        return ArmPlace.HOME if self.near_home(state) else ArmPlace.RESTING

    def near_home(self, state: ArmState) -> bool:
        """Whether the arm is home or passes by."""
        away = float(np.abs(state.positions.arm - self._home).max())
        return away <= max(HOME_TOLERANCE, 2 * self._tolerance())

    def held(self, state: ArmState | None = None) -> str:
        """What the hand holds, now or in another state; see :func:`in_the_hand`."""
        seen, grip = state or self._arm.newest(), self._grip()
        return grip.held if seen is None else in_the_hand(seen, grip, self._travel)

    @property
    def hand(self) -> tuple[float, float, float]:
        """The point between the fingertips in world [m]; where it was last."""
        state = self._arm.newest()
        point = None if state is None else self._tool_at(state.positions.arm)
        if point is None:
            return (0.0, 0.0, 0.0)
        x, y, z = (float(value) for value in point)
        return (x, y, z)

    @property
    def is_tidy(self) -> bool:
        """Whether the arm is at rest at home with an empty hand."""
        return self.place is ArmPlace.HOME and not self.held()

    def told_in(self, report: MotionReport) -> MotionReport:
        """The report, with how the arm is now."""
        return replace(report, arm=self.place, held=self.held(), hand=self.hand)
