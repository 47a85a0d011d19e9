# SPDX-License-Identifier: Apache-2.0
"""What ``motion_node`` exports; see there."""

from .constraints import AlongPath, AtSwitch, Clearances, Constraint, default_constraints
from .errors import (
    CancelledError,
    InfeasibleError,
    InvalidPlanError,
    MotionError,
    RobotDescriptionError,
)
from .grasps import GRASPS, Grasp
from .nlp import SOLVERS, Demand, Solver
from .phases import Phase, PhasePath
from .planner import Motion, MotionPlanner
from .robots import ARMS, PANDA, Arm, BodySphere, Gripper
from .robots.model import ArmModel
from .settings import PathSettings, PhaseSettings, Settings
from .timing.time_paths import TimingSettings
from .timing.trajectory import Trajectory

__all__ = [
    "ARMS",
    "GRASPS",
    "PANDA",
    "SOLVERS",
    "AlongPath",
    "Arm",
    "ArmModel",
    "AtSwitch",
    "BodySphere",
    "CancelledError",
    "Clearances",
    "Constraint",
    "Demand",
    "Grasp",
    "Gripper",
    "InfeasibleError",
    "InvalidPlanError",
    "Motion",
    "MotionError",
    "MotionPlanner",
    "PathSettings",
    "Phase",
    "PhasePath",
    "PhaseSettings",
    "RobotDescriptionError",
    "Settings",
    "Solver",
    "TimingSettings",
    "Trajectory",
    "default_constraints",
]
