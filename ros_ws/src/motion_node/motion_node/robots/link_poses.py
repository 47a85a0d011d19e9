# SPDX-License-Identifier: Apache-2.0
"""Forward kinematics in numbers, for many configurations at once."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from .model import ArmModel

Array = NDArray[np.float64]


def link_poses(model: ArmModel, q: Array) -> dict[str, Array]:
    """Transforms (k, 4, 4) in the world of all links from the root to the hand."""
    kinematics = model.kinematics
    chain, link = [], model.arm.gripper.hand_link
    while (joint := kinematics.by_child.get(link)) is not None:
        chain.append(joint)
        link = joint.parent
    poses = {link: np.tile(np.eye(4), (len(q), 1, 1))}
    for joint in reversed(chain):
        pose = poses[joint.parent] @ joint.parent_from_joint
        if joint.name in kinematics.position_in_q:
            value = q[:, kinematics.position_in_q[joint.name]]
            moved = np.tile(np.eye(4), (len(q), 1, 1))
            if joint.kind == "prismatic":
                moved[:, :3, 3] = joint.axis * value[:, None]
            else:
                a, b, c = joint.axis
                cross = np.array([[0, -c, b], [c, 0, -a], [-b, a, 0]])
                moved[:, :3, :3] += np.sin(value)[:, None, None] * cross
                moved[:, :3, :3] += (1 - np.cos(value))[:, None, None] * (cross @ cross)
            pose = pose @ moved
        poses[joint.child] = pose
    return poses


def joint_axes(model: ArmModel, poses: dict[str, Array]) -> tuple[Array, Array]:
    """Directions and points (k, n, 3) of the joints' axes in the world."""
    directions, points = [], []
    for joint in model.kinematics.joints:
        pose = poses[joint.child]
        directions.append(pose[:, :3, :3] @ joint.axis)
        points.append(pose[:, :3, 3])
    return np.stack(directions, axis=1), np.stack(points, axis=1)
