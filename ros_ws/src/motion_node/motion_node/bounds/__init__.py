# SPDX-License-Identifier: Apache-2.0
"""The bounds of 3.4, each over a list of constraints: pose (P1), keyframes (P2), path (P3)."""

from .joint import JointProblem
from .keyframes import Keyframes
from .path import PathProblem
from .pose import Poses, check_widths
from .switches import SwitchProblems
from .undivided import Undivided

__all__ = [
    "JointProblem",
    "Keyframes",
    "PathProblem",
    "Poses",
    "SwitchProblems",
    "Undivided",
    "check_widths",
]
