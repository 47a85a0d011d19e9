# SPDX-License-Identifier: Apache-2.0
"""What perception makes of simulated worlds, and worlds that are not as they should be."""

from __future__ import annotations

import numpy as np
import pybullet

from perception_node import (
    Observation,
    Perceived,
    Perception,
    PerceptionConfig,
    PinholeCamera,
    load_weights,
)
from perception_node.segment import SEGMENTATION_TOPIC
from scene_graph import Stacks
from sim_node.camera import Frame
from sim_node.world import World

#: With masks found in colour and depth, and with those that come with the picture.
PERCEPTION = Perception(load_weights())
LABELLED = PERCEPTION.configured(PerceptionConfig(mask_source=SEGMENTATION_TOPIC))
TOWERS: Stacks = (("red_box", "blue_box", "green_box"), (), ("yellow_box", "purple_box"))


def camera_of(world: World) -> PinholeCamera:
    config = world.config.camera
    return PinholeCamera(config.intrinsics, config.world_from_optical, config.width, config.height)


def observe(world: World, frame: Frame | None = None) -> Observation:
    frame = frame or world.render()
    return Observation(frame.rgb, frame.labels, frame.depth, camera_of(world))


def perceive(
    world: World, frame: Frame | None = None, perception: Perception = PERCEPTION
) -> Perceived:
    return perception.perceive(observe(world, frame))


def put(
    world: World,
    name: str,
    offset: tuple[float, float, float],
    turn: tuple[float, float, float] = (0.0, 0.0, 0.0),
) -> None:
    """Puts a block elsewhere: as if somebody held it there."""
    position, _ = world.block_pose(name)
    pybullet.resetBasePositionAndOrientation(
        world.body(name),
        np.add(position, offset).tolist(),
        pybullet.getQuaternionFromEuler(turn),
        physicsClientId=world.client,
    )


def move_hand(world: World, position: tuple[float, float, float]) -> None:
    """The arm with its hand pointing down at a position [m]."""
    joints = pybullet.calculateInverseKinematics(
        world.robot,
        11,
        position,
        pybullet.getQuaternionFromEuler((np.pi, 0.0, 0.0)),
        maxNumIterations=200,
        physicsClientId=world.client,
    )
    for index, angle in zip(world.joint_indices, joints):
        pybullet.resetJointState(world.robot, index, angle, 0.0, physicsClientId=world.client)
