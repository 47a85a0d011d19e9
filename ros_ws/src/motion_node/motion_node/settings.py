# SPDX-License-Identifier: Apache-2.0
"""Everything about plans that can be tuned."""

from __future__ import annotations

from dataclasses import dataclass, field

from .nlp import DEFAULT_SOLVER
from .timing.time_paths import TimingSettings


@dataclass(frozen=True)
class PhaseSettings:
    """Tolerances of grasping and placing.

    Attributes:
        max_grasp_width: widest block that the open fingers go around [m].
        place_gap: height above its support at which a block is let go [m].
        max_overhang: see :func:`motion_node.blocks.placed`.
    """

    max_grasp_width: float = 0.07
    place_gap: float = 0.002
    max_overhang: float = 0.2


@dataclass(frozen=True)
class PathSettings:
    """Shape of a phase.

    Attributes:
        steps: intervals a phase.
        vertical: of these, at its start and its end, along a vertical line.
        lift: height of the vertical lines at least [m].
        margin: clearance of the arm with what it holds to blocks and table [m].
        max_lean: how far the hand may lean from vertical in between [rad].
    """

    steps: int = 9
    vertical: int = 2
    lift: float = 0.02
    margin: float = 0.015
    max_lean: float = 0.15


@dataclass(frozen=True)
class Settings:
    """What :class:`motion_node.planner.MotionPlanner` is made with.

    Attributes:
        phases, path, timing: see there.
        squeeze: how much farther than the block's half width each finger is sent [m].
        limit_margin: distance kept to the joints' position limits [rad].
        solver: a name of :data:`motion_node.nlp.SOLVERS`.
        joint: whether all phases and switches are optimised at once, from what they are one by one.
    """

    phases: PhaseSettings = field(default_factory=PhaseSettings)
    path: PathSettings = field(default_factory=PathSettings)
    timing: TimingSettings = field(default_factory=TimingSettings)
    squeeze: float = 0.01
    limit_margin: float = 0.05
    solver: str = DEFAULT_SOLVER
    joint: bool = False
