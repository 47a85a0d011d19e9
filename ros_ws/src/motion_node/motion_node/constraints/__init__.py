# SPDX-License-Identifier: Apache-2.0
"""The constraints of the motion problem, one file a kind; any may be left out or added.

    MotionPlanner(urdf, constraints=[*default_constraints(PANDA), MyConstraint()])

No other module knows a row of any of them.
"""

from __future__ import annotations

from ..robots import Arm
from .constraint import Constraint
from .hand_clearance import HandClearance
from .link_clearance import LinkClearance
from .obstacle_clearance import CAPACITIES, ObstacleClearance, capacity_for
from .situation import AlongPath, AtSwitch, Clearances, VerticalEnd, lowered
from .switch_pose import SwitchPose
from .table_clearance import TableClearance
from .upright import Upright
from .vertical_line import VerticalLine


def default_constraints(arm: Arm) -> tuple[Constraint, ...]:
    """What section 5.1 asks of an arm that moves blocks from stack to stack."""
    return (
        Upright(),
        HandClearance(arm),
        LinkClearance(arm),
        TableClearance(arm),
        SwitchPose(),
        VerticalLine(),
    )


__all__ = [
    "CAPACITIES",
    "AlongPath",
    "AtSwitch",
    "Clearances",
    "Constraint",
    "HandClearance",
    "LinkClearance",
    "ObstacleClearance",
    "SwitchPose",
    "TableClearance",
    "Upright",
    "VerticalEnd",
    "VerticalLine",
    "capacity_for",
    "default_constraints",
    "lowered",
]
