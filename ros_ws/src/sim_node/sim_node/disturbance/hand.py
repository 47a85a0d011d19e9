# SPDX-License-Identifier: Apache-2.0
"""What the physics says of the hand: its links, and which block the fingers hold."""

from __future__ import annotations

import pybullet

from ..world import World


def finger_links(world: World) -> tuple[int, ...]:
    """pybullet's numbers of the fingers' links, which are those of their joints."""
    joints = dict(zip(world.arm.joints, world.joint_indices))
    return tuple(joints[name] for name in world.arm.finger_joints)


def hand_link(world: World) -> int:
    """pybullet's number of the link that carries the fingers."""
    info = pybullet.getJointInfo(world.robot, finger_links(world)[0], physicsClientId=world.client)
    return int(info[16])


def touched_block(world: World) -> str:
    """The block that both fingers press on since the last step, or an empty string.

    Of several, which no gripper holds, the one that was put down first.
    """
    both: set[int] | None = None
    for link in finger_links(world):
        points = pybullet.getContactPoints(
            bodyA=world.robot, linkIndexA=link, physicsClientId=world.client
        )
        # Numbers 1 and 2 are the bodies, 9 is the normal force.
        pressed = {body for point in points if point[9] > 0.0 for body in point[1:3]}
        both = pressed if both is None else both & pressed
    return next((name for name in world.names if world.body(name) in (both or ())), "")


def gap_beneath(world: World, name: str) -> float:
    """From the bottom of a block straight down to what is there, from its centre [m]."""
    body = world.body(name)
    (x, y, _), _ = world.block_pose(name)
    bottom = pybullet.getAABB(body, physicsClientId=world.client)[0][2] - 1e-4
    hit = pybullet.rayTest((x, y, bottom), (x, y, -1.0), physicsClientId=world.client)[0]
    return float(bottom - hit[3][2]) if hit[0] >= 0 else bottom + 1.0
