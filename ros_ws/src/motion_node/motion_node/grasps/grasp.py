# SPDX-License-Identifier: Apache-2.0
"""What a grasp is, and what it is chosen by."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

from ..blocks import Block
from ..robots import Gripper

#: Kept between fingertips or palm and what is below and above a block [m].
SPARE = 0.005


@dataclass(frozen=True)
class Grasp:
    """How a hand that points down takes a block.

    Attributes:
        yaw: direction of the fingers' motion, counter-clockwise from world x, in (-pi/2, pi/2].
        width: extent of the block between the fingers [m].
        depth: extent across the fingers [m].
        height: of the tool centre point above the block's centre [m].
        placed_yaw: of the block when the fingers have been turned along world x to put it down
            [rad].
    """

    yaw: float
    width: float
    depth: float
    height: float
    placed_yaw: float


@dataclass(frozen=True)
class Circumstances:
    """What a grasp depends on besides the block.

    Attributes:
        gripper: the hand.
        free_yaw: direction of the fingers in which the hand, which is long that way, keeps
            farthest from the nearest other stack, in (-pi/2, pi/2] [rad].
    """

    gripper: Gripper
    free_yaw: float = 0.0


#: The ways to take a block, the preferred one first; at least one.
GraspFunction = Callable[[Block, Circumstances], list[Grasp]]


def grasp_height(block: Block, gripper: Gripper) -> float:
    """Height of the tool centre point above the block's centre [m].

    As near to the centre as the palm and what the block stands on allow.
    """
    half = block.size[2] / 2
    palm_above_tcp = gripper.tcp_offset - gripper.palm
    tip_below_tcp = gripper.finger_tip - gripper.tcp_offset
    height = min(max(0.0, half + SPARE - palm_above_tcp), half)
    return max(height, tip_below_tcp + SPARE - half)
