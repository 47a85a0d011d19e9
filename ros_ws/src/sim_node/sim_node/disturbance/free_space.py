# SPDX-License-Identifier: Apache-2.0
"""Whether a block fits somewhere, asked of the physics without putting anything there."""

from __future__ import annotations

from collections.abc import Collection

import pybullet

from ..world import World
from .request import Vector

#: Blocks that rest on one another touch by so much less [m].
_TOUCH = 1e-3
#: What is put down may fall so far [m].
_DROP = 3e-3


def in_the_way(
    world: World, size: Vector, centre_world: Vector, ignoring: Collection[str] = ()
) -> str:
    """What an upright box of a size [m] would stand in: ``red_box``, ``the arm``; or empty."""
    client = world.client
    shape = pybullet.createCollisionShape(
        pybullet.GEOM_BOX, halfExtents=[0.5 * edge for edge in size], physicsClientId=client
    )
    try:
        for index in range(pybullet.getNumBodies(physicsClientId=client)):
            body = pybullet.getBodyUniqueId(index, physicsClientId=client)
            name = _name_of(world, body)
            if name in ignoring:
                continue
            near = pybullet.getClosestPoints(
                bodyA=-1,
                bodyB=body,
                distance=0.0,
                collisionShapeA=shape,
                collisionShapePositionA=centre_world,
                collisionShapeOrientationA=(0.0, 0.0, 0.0, 1.0),
                physicsClientId=client,
            )
            if any(point[8] < -_TOUCH for point in near):
                return name
    finally:
        pybullet.removeCollisionShape(shape, physicsClientId=client)
    return ""


def support(world: World, bottom_world: Vector) -> str:
    """What is just beneath a point: ``red_box``, ``the table``, …; empty: nothing."""
    x, y, z = bottom_world
    hit = pybullet.rayTest((x, y, z + _TOUCH), (x, y, z - _DROP), physicsClientId=world.client)[0]
    return _name_of(world, hit[0]) if hit[0] >= 0 else ""


def reach(world: World, name: str) -> tuple[float, float]:
    """Heights of the lowest and the highest point of a block [m]."""
    lower, upper = pybullet.getAABB(world.body(name), physicsClientId=world.client)
    return float(lower[2]), float(upper[2])


def _name_of(world: World, body: int) -> str:
    for name in world.names:
        if world.body(name) == body:
            return name
    for name, obstacle in world.obstacles.items():
        if obstacle == body:
            return name
    return "the arm" if body == world.robot else "the table"
