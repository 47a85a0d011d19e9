# SPDX-License-Identifier: Apache-2.0
"""Pictures of a state that differ in what is not its own: camera, light, grain, offsets."""

from __future__ import annotations

from dataclasses import dataclass, replace
from typing import Final

import cv2
import numpy as np
from numpy.typing import NDArray

from scene_graph import Stacks
from sim_node import CameraConfig, ColorConfig, Frame, SensorConfig, World, sense
from sim_node.camera import CameraRenderer
from sim_node.scene import Light

#: Edge of a picture that the state encoder reads [px] (4.2.1).
SIZE: Final = 128


@dataclass(frozen=True)
class Jitter:
    """How much two pictures of one state differ; uniform draws between minus this and this.

    Attributes:
        camera: of each coordinate of where the camera is, and of what it looks at [m].
        light: share of ambient and diffuse light.
        direction: of each coordinate of where light comes from (its length is 2.2).
        exposure: share of all values.
        grain: standard deviation of the noise of a value [0..255].
        offset: of a block from the middle of its place, each way [m].
        yaw: of a block [rad].
    """

    camera: float = 0.003
    light: float = 0.06
    direction: float = 0.15
    exposure: float = 0.04
    grain: float = 1.5
    offset: float = 0.002
    yaw: float = 0.05


STILL: Final = Jitter(0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0)


def place_blocks(world: World, layout: Stacks, jitter: Jitter, rng: np.random.Generator) -> None:
    """Moves the world's blocks to where they rest in a state; no physics is needed for that."""
    for stack, base in zip(layout, world.config.stack_positions):
        height = 0.0
        for name in stack:
            edge = world.block(name).size[2]
            x, y = np.add(base[:2], rng.uniform(-jitter.offset, jitter.offset, 2))
            yaw = rng.uniform(-jitter.yaw, jitter.yaw)
            turned = (0.0, 0.0, float(np.sin(0.5 * yaw)), float(np.cos(0.5 * yaw)))
            world.move_block(name, (float(x), float(y), height + 0.5 * edge), turned)
            height += edge


def take_picture(
    world: World, jitter: Jitter, rng: np.random.Generator, camera: CameraConfig | None = None
) -> NDArray[np.uint8]:
    """What a camera sees of the world as it is, shape (SIZE, SIZE, 3).

    It is seen at the size of the simulator's camera and averaged, as a picture of a real one is.
    """
    config = camera or world.config.camera
    eye = np.add(config.position_world, rng.uniform(-jitter.camera, jitter.camera, 3))
    target = np.add(config.target_world, rng.uniform(-jitter.camera, jitter.camera, 3))
    moved = replace(config, position_world=tuple(eye), target_world=tuple(target))
    light = world.config.light
    direction = np.add(light.direction_world, rng.uniform(-jitter.direction, jitter.direction, 3))
    ambient, diffuse = 1.0 + rng.uniform(-jitter.light, jitter.light, 2)
    shone = Light(
        tuple(direction), light.ambient * ambient, light.diffuse * diffuse, light.specular
    )
    exposure = 1.0 + float(rng.uniform(-jitter.exposure, jitter.exposure))
    seed = int(rng.integers(2**31))
    frame = CameraRenderer(world.client, moved, shone).render({})
    small = cv2.resize(frame.rgb, (SIZE, SIZE), interpolation=cv2.INTER_AREA)
    color = ColorConfig(noise=jitter.grain, exposure=exposure)
    reduced = Frame(
        np.asarray(small, np.uint8),
        np.zeros((SIZE, SIZE), np.float32),
        np.zeros((SIZE, SIZE), np.uint16),
    )
    return sense(reduced, SensorConfig(seed=seed, color=color)).rgb
