# SPDX-License-Identifier: Apache-2.0
"""What of a new world lies inside of something else, where the physics would throw it out."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Final

import pybullet

from .scene import SceneConfig, SceneError

#: Bodies that touch overlap by less [m].
_TOLERANCE: Final = 0.002


def check_obstacles_are_free(
    client: int, config: SceneConfig, robot: int, bodies: Mapping[str, int]
) -> None:
    """Raises SceneError where an obstacle lies in the arm at home, or a loose one in another.

    Args:
        client: physics server.
        config: whose obstacles they are.
        robot: pybullet's body id of the arm.
        bodies: those of the obstacles by their names.
    """
    for number, item in enumerate(config.obstacles):
        key = f"obstacles[{number}].position"
        if (depth := _depth(client, bodies[item.name], robot)) > _TOLERANCE:
            raise SceneError(
                key,
                f"= {list(item.position)} puts {item.name} {1000 * depth:.0f} mm deep into the "
                "arm at home; put it farther away",
            )
        for other in config.obstacles[:number]:
            depth = _depth(client, bodies[item.name], bodies[other.name])
            if depth > _TOLERANCE and not (item.lies_still and other.lies_still):
                raise SceneError(
                    key,
                    f"= {list(item.position)} puts {item.name} {1000 * depth:.0f} mm deep into "
                    f"{other.name}; only what never moves may overlap",
                )


def check_arm_is_free(client: int, robot: int, table: int) -> None:
    """Raises SceneError where the arm at home reaches into the table."""
    depth = _depth(client, robot, table, foot=False)
    if depth > _TOLERANCE:
        raise SceneError(
            "arm.home", f"puts the arm {1000 * depth:.0f} mm deep into the table; lift it"
        )


def _depth(client: int, body: int, other: int, foot: bool = True) -> float:
    """How far two bodies reach into each other [m]; 0 if they do not."""
    points = pybullet.getClosestPoints(body, other, 0.0, physicsClientId=client)
    depths = [-point[8] for point in points if foot or point[3] > 0]
    return max([0.0, *depths])
