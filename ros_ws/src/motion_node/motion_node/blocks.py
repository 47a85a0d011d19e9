# SPDX-License-Identifier: Apache-2.0
"""Blocks as upright prisms, how a hand takes them, and where they come to stand."""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

from scene_graph import BOX, SceneObject

from .errors import InvalidPlanError

#: A block whose vertical axis is farther than this from vertical is leaning [rad].
MAX_LEAN = 0.3


def rotation_from_quaternion(x: float, y: float, z: float, w: float) -> NDArray[np.float64]:
    """Rotation matrix (3, 3) of a quaternion of any positive norm."""
    x, y, z, w = np.array([x, y, z, w]) / np.linalg.norm([x, y, z, w])
    return np.array(
        [
            [1 - 2 * (y * y + z * z), 2 * (x * y - z * w), 2 * (x * z + y * w)],
            [2 * (x * y + z * w), 1 - 2 * (x * x + z * z), 2 * (y * z - x * w)],
            [2 * (x * z - y * w), 2 * (y * z + x * w), 1 - 2 * (x * x + y * y)],
        ]
    )


def wrap_line(angle: float) -> float:
    """The angle of an undirected line, in (-pi/2, pi/2] [rad]."""
    return float(np.pi / 2 - np.mod(np.pi / 2 - angle, np.pi))


@dataclass(frozen=True)
class Block:
    """A block standing upright.

    Attributes:
        position_world: centre [m].
        yaw: direction of its first horizontal axis, counter-clockwise from world x [rad].
        size: full extents along its first and second horizontal axis and vertically [m].
    """

    name: str
    position_world: tuple[float, float, float]
    yaw: float
    size: tuple[float, float, float]

    @property
    def top(self) -> float:
        """Height of the upper face [m]."""
        return self.position_world[2] + self.size[2] / 2

    @property
    def bottom(self) -> float:
        """Height of the lower face [m]."""
        return self.position_world[2] - self.size[2] / 2

    @property
    def half_world(self) -> tuple[float, float]:
        """Half extents along world x and y of the box that encloses it [m]."""
        c, s = abs(np.cos(self.yaw)), abs(np.sin(self.yaw))
        a, b = self.size[0] / 2, self.size[1] / 2
        return float(c * a + s * b), float(s * a + c * b)

    def moved(self, position_world: tuple[float, float, float], yaw: float) -> Block:
        """The same block elsewhere."""
        return replace(self, position_world=position_world, yaw=yaw)


def block_from_object(item: SceneObject) -> Block:
    """The block that was seen; whichever of its axes is nearest to vertical becomes the third.

    Raises:
        InvalidPlanError: if pose or size are not finite or positive, or the block leans.
    """
    numbers = np.array([*item.position_world, *item.quaternion_world, *item.size], dtype=float)
    norm = float(np.linalg.norm(numbers[3:7]))
    if not np.all(np.isfinite(numbers)) or min(item.size) <= 0 or not 0.5 < norm < 2.0:
        raise InvalidPlanError(f"{item.name} has no usable pose and size", object_name=item.name)
    if item.shape != BOX:  # round: turned however it likes, it looks the same from above
        return Block(item.name, item.position_world, 0.0, item.size)
    rotation = rotation_from_quaternion(*item.quaternion_world)
    vertical = int(np.argmax(np.abs(rotation[2])))
    lean = float(np.arccos(np.clip(abs(rotation[2, vertical]), -1.0, 1.0)))
    if lean > MAX_LEAN:
        raise InvalidPlanError(
            f"{item.name} leans by {np.degrees(lean):.0f} degrees and cannot be grasped from above",
            object_name=item.name,
        )
    first, second = [axis for axis in range(3) if axis != vertical]
    yaw = wrap_line(float(np.arctan2(rotation[1, first], rotation[0, first])))
    size = (item.size[first], item.size[second], item.size[vertical])
    return Block(item.name, item.position_world, yaw, size)


@dataclass(frozen=True)
class Grasp:
    """How a hand that points down takes a block.

    Attributes:
        yaw: direction of the fingers' motion, counter-clockwise from world x, in (-pi/2, pi/2].
        width: extent of the block between the fingers [m].
        depth: extent across the fingers [m].
        height: of the tool centre point above the block's centre [m].
        quarter_turned: whether the fingers close on the block's second horizontal axis.
    """

    yaw: float
    width: float
    depth: float
    height: float
    quarter_turned: bool


def grasps(block: Block, tip_below_tcp: float, palm_above_tcp: float) -> list[Grasp]:
    """The two ways to close the fingers on opposite faces, the one nearest to world x first.

    The hand is long in the direction of its fingers, and the stacks stand along y: with the
    fingers along x it does not sweep the neighbouring stacks.

    Args:
        tip_below_tcp: how far the fingertips reach below the tool centre point [m].
        palm_above_tcp: how far above it the palm is [m].
    """
    half = block.size[2] / 2
    # As near to the centre as the palm and what the block stands on allow (5 mm each).
    height = min(max(0.0, half + 0.005 - palm_above_tcp), half)
    height = max(height, tip_below_tcp + 0.005 - half)
    along_x = Grasp(wrap_line(block.yaw), block.size[0], block.size[1], height, False)
    along_y = Grasp(wrap_line(block.yaw + np.pi / 2), block.size[1], block.size[0], height, True)
    # Among equals the first axis wins: a tie must not be decided by rounding.
    return sorted((along_x, along_y), key=lambda grasp: round(abs(grasp.yaw), 3))


def placed(
    block: Block,
    grasp: Grasp,
    base_world: tuple[float, float, float],
    support: Block | None,
    max_overhang: float,
) -> Block:
    """The block after it was put onto a stack, with the fingers along world x.

    It goes to the middle of the place, so that errors of perception and grasping do not add up
    from block to block, but never farther than a share of the support's extent from the support's
    centre: a tower stands as long as each centre of mass is above the block below.

    Args:
        base_world: centre of the place on the table [m].
        support: the block it will stand on; None: the table.
        max_overhang: share of the support's horizontal extent, 0 to 0.5.
    """
    x, y, floor = base_world
    if support is not None:
        half_x, half_y = support.half_world
        limit_x, limit_y = 2 * max_overhang * half_x, 2 * max_overhang * half_y
        x = float(
            np.clip(x, support.position_world[0] - limit_x, support.position_world[0] + limit_x)
        )
        y = float(
            np.clip(y, support.position_world[1] - limit_y, support.position_world[1] + limit_y)
        )
        floor = support.top
    yaw = np.pi / 2 if grasp.quarter_turned else 0.0
    return block.moved((x, y, floor + block.size[2] / 2), yaw)
