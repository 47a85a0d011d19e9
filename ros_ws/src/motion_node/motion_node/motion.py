# SPDX-License-Identifier: Apache-2.0
"""What the motion problem's solution is."""

from __future__ import annotations

from dataclasses import dataclass

from .phases import Phase, PhasePath
from .timing.trajectory import Trajectory


@dataclass(frozen=True)
class Motion:
    """A plan as a motion.

    Attributes:
        phases: the phases in order, the way home last.
        paths: their paths.
        trajectory: the paths in time.
        floor: height of the table [m].
        seconds: wall time that finding it took [s].
    """

    phases: tuple[Phase, ...]
    paths: tuple[PhasePath, ...]
    trajectory: Trajectory
    floor: float
    seconds: float
