# SPDX-License-Identifier: Apache-2.0
"""The table, the blocks and what else stands around as bodies of the physics."""

from __future__ import annotations

from pathlib import Path
from typing import Any, Final

import numpy as np
import pybullet
from numpy.typing import NDArray

from scene_graph import BOX, COLORS, CYLINDER, PRISM, SPHERE

from .scene import Block, Obstacle
from .scene.blocks import centre_above_body
from .scene.obstacles import TRAY, TRAY_WALL
from .scene.table import TABLE_LOWER, TABLE_UPPER

_TABLE_THICKNESS: Final = 0.04
_TABLE_FRICTION: Final = 0.9
#: A prism of extents 1 x 1 x 1 around its centre of mass.
_PRISM_MESH: Final = str(Path(__file__).parent / "meshes" / "prism.obj")

Vector = tuple[float, float, float]


def create_table(client: int) -> int:
    """Puts the table into the world, its surface at z = 0; returns pybullet's body id."""
    (left, near), (right, far) = TABLE_LOWER, TABLE_UPPER
    half = ((right - left) / 2, (far - near) / 2, _TABLE_THICKNESS / 2)
    collision = pybullet.createCollisionShape(
        pybullet.GEOM_BOX, halfExtents=half, physicsClientId=client
    )
    visual = pybullet.createVisualShape(
        pybullet.GEOM_BOX,
        halfExtents=half,
        rgbaColor=(0.78, 0.74, 0.68, 1.0),
        physicsClientId=client,
    )
    centre = ((left + right) / 2, (near + far) / 2, -half[2])
    table = pybullet.createMultiBody(0.0, collision, visual, centre, physicsClientId=client)
    pybullet.changeDynamics(
        table, -1, lateralFriction=_TABLE_FRICTION, restitution=0.0, physicsClientId=client
    )
    return int(table)


def create_block(client: int, block: Block, position_world: NDArray[Any], yaw: float) -> int:
    """Puts a block into the world, upright; returns pybullet's body id.

    Args:
        client: physics server.
        block: which one.
        position_world: of the middle of its extents, shape (3,) [m].
        yaw: about the world's z axis [rad].
    """
    body = pybullet.createMultiBody(
        block.mass,
        _collision(client, block.shape, block.size),
        _visual(client, block.shape, block.size, block.paint or COLORS[block.color]),
        np.subtract(position_world, [0.0, 0.0, block.centre_above_body]),
        pybullet.getQuaternionFromEuler((0.0, 0.0, yaw)),
        physicsClientId=client,
    )
    _make_rough(client, body, block.shape, block.friction)
    return int(body)


def create_obstacle(client: int, item: Obstacle) -> int:
    """Puts something that is not a block into the world; returns pybullet's body id."""
    if item.shape == TRAY:
        parts = _tray_parts(item.size)
        collision = pybullet.createCollisionShapeArray(
            shapeTypes=[pybullet.GEOM_BOX] * len(parts),
            halfExtents=[[0.5 * edge for edge in size] for size, _ in parts],
            collisionFramePositions=[centre for _, centre in parts],
            physicsClientId=client,
        )
        visual = pybullet.createVisualShapeArray(
            shapeTypes=[pybullet.GEOM_BOX] * len(parts),
            halfExtents=[[0.5 * edge for edge in size] for size, _ in parts],
            visualFramePositions=[centre for _, centre in parts],
            rgbaColors=[[*item.color, 1.0]] * len(parts),
            physicsClientId=client,
        )
    else:
        collision = _collision(client, item.shape, item.size)
        visual = _visual(client, item.shape, item.size, item.color)
    x, y, z = item.position_world
    below = centre_above_body(item.shape, item.size)
    body = pybullet.createMultiBody(
        item.mass,
        collision,
        visual,
        (x, y, z - below),
        pybullet.getQuaternionFromEuler((0.0, 0.0, item.yaw)),
        physicsClientId=client,
    )
    _make_rough(client, body, item.shape, item.friction)
    return int(body)


def _make_rough(client: int, body: int, shape: str, friction: float) -> None:
    pybullet.changeDynamics(
        body,
        -1,
        lateralFriction=friction,
        spinningFriction=0.003,
        rollingFriction=1e-4 if shape == SPHERE else 0.0,
        restitution=0.0,
        physicsClientId=client,
    )
    if shape == PRISM:  # else it hovers by the millimetre that pybullet puts around a mesh
        pybullet.changeDynamics(body, -1, collisionMargin=0.0, physicsClientId=client)


def _collision(client: int, shape: str, size: Vector) -> int:
    kind, extents = _geometry(shape, size)
    if kind == pybullet.GEOM_CYLINDER:
        extents = {"radius": extents["radius"], "height": extents["length"]}
    return int(pybullet.createCollisionShape(kind, physicsClientId=client, **extents))


def _visual(client: int, shape: str, size: Vector, color: Vector) -> int:
    kind, extents = _geometry(shape, size)
    return int(
        pybullet.createVisualShape(kind, rgbaColor=(*color, 1.0), physicsClientId=client, **extents)
    )


def _geometry(shape: str, size: Vector) -> tuple[int, dict[str, Any]]:
    """pybullet's kind of shape, and its extents as a visual shape has them."""
    if shape == CYLINDER:
        return pybullet.GEOM_CYLINDER, {"radius": 0.5 * size[0], "length": size[2]}
    if shape == SPHERE:
        return pybullet.GEOM_SPHERE, {"radius": 0.5 * size[0]}
    if shape == PRISM:
        return pybullet.GEOM_MESH, {"fileName": _PRISM_MESH, "meshScale": list(size)}
    if shape == BOX:
        return pybullet.GEOM_BOX, {"halfExtents": [0.5 * edge for edge in size]}
    raise ValueError(f"there is no body for the shape {shape!r}")


def _tray_parts(size: Vector) -> list[tuple[Vector, Vector]]:
    """Sizes and centres of the bottom and the four sides of a tray [m]."""
    x, y, z = size
    wall = TRAY_WALL
    parts: list[tuple[Vector, Vector]] = [((x, y, wall), (0.0, 0.0, (wall - z) / 2))]
    for side in (-0.5, 0.5):
        parts.append(((wall, y, z - wall), (side * (x - wall), 0.0, wall / 2)))
        parts.append(((x - 2 * wall, wall, z - wall), (0.0, side * (y - wall), wall / 2)))
    return parts


def couple_fingers(client: int, robot: int, left: int, right: int) -> None:
    """The real hand drives both fingers with one motor; a gear joint does the same here."""
    gear = pybullet.createConstraint(
        robot,
        left,
        robot,
        right,
        pybullet.JOINT_GEAR,
        (1, 0, 0),
        (0, 0, 0),
        (0, 0, 0),
        physicsClientId=client,
    )
    pybullet.changeConstraint(gear, gearRatio=-1, erp=0.1, maxForce=50, physicsClientId=client)
    for finger in (left, right):
        pybullet.changeDynamics(
            robot,
            finger,
            lateralFriction=1.2,
            spinningFriction=0.01,
            restitution=0.0,
            physicsClientId=client,
        )
