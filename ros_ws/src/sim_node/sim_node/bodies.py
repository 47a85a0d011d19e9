# SPDX-License-Identifier: Apache-2.0
"""The table and the blocks as bodies of the physics."""

from __future__ import annotations

from typing import Any, Final

import pybullet
from numpy.typing import NDArray

from scene_graph import COLORS, CYLINDER, SPHERE, split_object_name

from .scene import SceneConfig

_TABLE_HALF_EXTENTS: Final = (0.5, 0.6, 0.02)
_TABLE_CENTRE: Final = (0.35, 0.0, -0.02)
_FRICTION: Final = 0.9


def create_table(client: int) -> int:
    """Puts the table into the world, its surface at z = 0; returns pybullet's body id."""
    collision = pybullet.createCollisionShape(
        pybullet.GEOM_BOX, halfExtents=_TABLE_HALF_EXTENTS, physicsClientId=client
    )
    visual = pybullet.createVisualShape(
        pybullet.GEOM_BOX,
        halfExtents=_TABLE_HALF_EXTENTS,
        rgbaColor=(0.78, 0.74, 0.68, 1.0),
        physicsClientId=client,
    )
    table = pybullet.createMultiBody(0.0, collision, visual, _TABLE_CENTRE, physicsClientId=client)
    pybullet.changeDynamics(
        table, -1, lateralFriction=_FRICTION, restitution=0.0, physicsClientId=client
    )
    return int(table)


def create_block(
    client: int, name: str, config: SceneConfig, position_world: NDArray[Any], yaw: float
) -> int:
    """Puts a block into the world; returns pybullet's body id.

    Args:
        client: physics server.
        name: colour and shape, as ``red_box``.
        config: size and mass of blocks.
        position_world: of its centre, shape (3,) [m].
        yaw: about the world's z axis [rad].
    """
    color, shape = split_object_name(name)
    half = 0.5 * config.block_size
    if shape == CYLINDER:
        kind = pybullet.GEOM_CYLINDER
        collision_size: dict[str, Any] = {"radius": half, "height": 2.0 * half}
        visual_size: dict[str, Any] = {"radius": half, "length": 2.0 * half}
    elif shape == SPHERE:
        kind = pybullet.GEOM_SPHERE
        collision_size = visual_size = {"radius": half}
    else:
        kind = pybullet.GEOM_BOX
        collision_size = visual_size = {"halfExtents": [half] * 3}
    body = pybullet.createMultiBody(
        config.block_mass,
        pybullet.createCollisionShape(kind, physicsClientId=client, **collision_size),
        pybullet.createVisualShape(
            kind, rgbaColor=(*COLORS[color], 1.0), physicsClientId=client, **visual_size
        ),
        position_world,
        pybullet.getQuaternionFromEuler((0.0, 0.0, yaw)),
        physicsClientId=client,
    )
    pybullet.changeDynamics(
        body,
        -1,
        lateralFriction=_FRICTION,
        spinningFriction=0.003,
        rollingFriction=1e-4 if shape == SPHERE else 0.0,
        restitution=0.0,
        physicsClientId=client,
    )
    return int(body)
