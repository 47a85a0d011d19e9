# SPDX-License-Identifier: Apache-2.0
"""What the node's check of the arm says of a picture, of what the simulator publishes of it."""

from __future__ import annotations

import functools
from collections.abc import Mapping

from perception_node import BadImageError, Observation
from perception_node.arm import ArmShape, ArmSight
from sim_node import World, robot_description


def joint_states(world: World) -> dict[str, float]:
    """Positions of the joints by their names, as the topic has them now [rad, m]."""
    return dict(zip(world.arm.joints, world.joint_state()[0].tolist()))


def arm_problem(
    world: World, camera: str, observation: Observation, positions: Mapping[str, float]
) -> str:
    """A sentence where the picture contradicts the arm, else nothing; its joints rested.

    Args:
        positions: of :func:`joint_states` when it was taken.
    """
    sight = _sight(robot_description(world.arm))
    try:
        sight.check(camera, observation, positions, "world")
    except BadImageError as error:
        return str(error)
    return ""


@functools.cache
def _sight(description: str) -> ArmSight:
    return ArmSight(ArmShape(description))
