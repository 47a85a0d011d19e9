# SPDX-License-Identifier: Apache-2.0
"""At a switch the hand is where it takes or puts down a block."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Final

import casadi as ca

from scene_graph import base_name

from ..nlp import Demand
from ..phases import Phase
from ..robots.model import ArmModel
from ..settings import PathSettings
from .constraint import Constraint
from .situation import AtSwitch

REFERENCE_SIZE: Final = 3


def tool_on_line(model: ArmModel, reference: ca.SX) -> ca.SX:
    """x and y of the tool centre point less the reference's [m], sine of the angle of the fingers'
    direction to the reference's, height of the point [m]; shape (4, 1).

    Args:
        reference: x, y [m] and yaw [rad], shape (REFERENCE_SIZE, 1).
    """
    rotation, _ = model.hand_pose
    point = model.tool_center
    cos, sin = ca.cos(reference[2]), ca.sin(reference[2])
    return ca.vertcat(
        point[:2] - reference[:2], rotation[1, 1] * cos - rotation[0, 1] * sin, point[2]
    )


class SwitchPose(Constraint):
    """Rows: see :func:`tool_on_line`. Parameters: the reference."""

    name = "switch_pose"
    of_the_hand = True

    def parameter_count(self, stacks: int) -> int:
        """See :class:`Constraint`."""
        return REFERENCE_SIZE

    def expression(self, model: ArmModel, parameters: ca.SX, stacks: int) -> ca.SX:
        """See :func:`tool_on_line`."""
        return tool_on_line(model, parameters)

    def row_names(self, phase: Phase) -> Sequence[str]:
        """See :class:`Constraint`."""
        switch = phase.switch
        assert switch is not None
        place = base_name(switch.stack)
        x, y, z = switch.position_world
        reach = f"reach of the hand to ({x:.2f}, {y:.2f}, {z:.2f}) at {place}"
        return (reach, reach, f"direction of the fingers at {place}", reach)

    def at_switch(self, moment: AtSwitch) -> Demand:
        """Exactly there."""
        switch = moment.switch
        x, y, z = switch.position_world
        exact = (0.0, 0.0, 0.0, z)
        return Demand.constant(1, exact, exact, (x, y, switch.yaw))

    def path_steps(self, shape: PathSettings) -> tuple[float, ...]:
        """None: P2 has fixed the switches by then."""
        return ()
