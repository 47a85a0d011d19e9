# SPDX-License-Identifier: Apache-2.0
"""Where inverse kinematics starts: postures of an arm that are likely to reach a place."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Protocol

import numpy as np
from numpy.typing import NDArray

Array = NDArray[np.float64]


class Seeding(Protocol):
    """A strategy for starting configurations, one an arm's structure."""

    @property
    def swings(self) -> int:
        """How many times the elbow is swung to either side in search of room; 0: it has none."""

    @property
    def swing_step(self) -> float:
        """By how much each time, along the arm's self-motion [rad]."""

    def turned(
        self, home: Array, home_yaw: float, azimuths: Array, yaws: Array, lower: Array, upper: Array
    ) -> tuple[Array, Array]:
        """Rest postures turned towards places, and the fingers' directions nearest to yaws.

        Args:
            home: the rest posture, shape (n,) [rad].
            home_yaw: direction of the fingers in it, about world z [rad].
            azimuths: directions of the places from the arm's base, shape (k,) [rad].
            yaws: wanted directions of the fingers, shape (k,) [rad]; half a turn is the same grasp.
            lower, upper: joint limits, shape (n,) [rad].

        Returns:
            Configurations (k, n) [rad], and the fingers' directions there, equal to ``yaws`` up
            to half turns, shape (k,) [rad].
        """


@dataclass(frozen=True)
class TurnedHome:
    """For arms whose first joint turns about the vertical and whose last one turns the hand.

    Attributes:
        swings, swing_step: see :class:`Seeding`; for arms with a joint more than a pose asks for.
    """

    swings: int = 0
    swing_step: float = 0.35

    def turned(
        self, home: Array, home_yaw: float, azimuths: Array, yaws: Array, lower: Array, upper: Array
    ) -> tuple[Array, Array]:
        """See :meth:`Seeding.turned`.

        Turning the first joint turns the hand; the last joint turns it back, and to the yaw. Of
        the grasps half a turn apart, the one nearest the last joint's middle is taken.
        """
        near = np.tile(home, (len(yaws), 1))
        near[:, 0] += azimuths
        turned = np.mod(azimuths + home_yaw - yaws, np.pi)
        last = home[-1] + turned[:, None] + np.pi * np.arange(-2, 2)
        middle = (lower[-1] + upper[-1]) / 2
        best = np.argmin(np.abs(last - middle), axis=1)
        near[:, -1] = last[np.arange(len(yaws)), best]
        return near, home_yaw + azimuths - (near[:, -1] - home[-1])
