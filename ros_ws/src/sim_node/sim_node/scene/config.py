# SPDX-License-Identifier: Apache-2.0
"""What stands where. The frame ``world`` is the robot's base, the table's surface at z = 0."""

from __future__ import annotations

from dataclasses import dataclass, field
from typing import Annotated

import numpy as np

from scene_graph import ROW_OF_THREE
from scene_graph.places import Point

from .blocks import Blocks, check_blocks
from .cameras import CameraConfig, check_cameras
from .errors import SceneError
from .obstacles import Obstacle, check_obstacles
from .reading import Count, Key, ReadBy, Within
from .table import check_places, read_places

Vector = tuple[float, float, float]


@dataclass(frozen=True)
class Light:
    """Light from far away.

    Attributes:
        direction_world: where it comes from; its length does not matter.
        ambient, diffuse, specular: how much of it falls on everything, on what faces it, and is
            mirrored straight up.
    """

    direction_world: Annotated[Vector, Key("direction"), Within(-100.0, 100.0)] = (1.2, -0.6, 1.8)
    ambient: Annotated[float, Within(0.0, 2.0)] = 0.55
    diffuse: Annotated[float, Within(0.0, 2.0)] = 0.45
    specular: Annotated[float, Within(0.0, 2.0)] = 0.05


@dataclass(frozen=True)
class ArmConfig:
    """The arm.

    Attributes:
        robot: a name of ``SIMULATED_ARMS``; empty: what the parameter ``robot`` says.
        home: positions of the arm's joints after a reset [rad]; empty: the arm's own.
    """

    robot: str = ""
    home: Annotated[tuple[float, ...], Within(-7.0, 7.0, "rad")] = ()


@dataclass(frozen=True)
class SceneConfig:
    """The table of 5.3.1, m = 3 stacks in a row of blocks of one size, or one of your own.

    Attributes:
        stack_positions: centres of the places on the table, from the left of the image [m]; of
            two rows the one nearer to the camera comes first.
        blocks: what the blocks are like.
        obstacles: things that are not blocks.
        arm: which one it is, and where it rests.
        cameras: the first is the one that perception looks through.
        light: what falls on all of it.
        position_jitter, yaw_jitter: blocks are put down up to this far from the ideal [m, rad].
    """

    stack_positions: Annotated[tuple[Point, ...], Key("places"), ReadBy(read_places)] = ROW_OF_THREE
    blocks: Blocks = field(default_factory=Blocks)
    obstacles: Annotated[tuple[Obstacle, ...], Count(0, 30)] = ()
    arm: ArmConfig = field(default_factory=ArmConfig)
    cameras: Annotated[tuple[CameraConfig, ...], Count(1, 8)] = (CameraConfig(),)
    light: Light = field(default_factory=Light)
    position_jitter: Annotated[float, Within(0.0, 0.005, "m")] = 0.002
    yaw_jitter: Annotated[float, Within(0.0, 3.2, "rad")] = 0.05

    @property
    def stack_count(self) -> int:
        """m."""
        return len(self.stack_positions)

    @property
    def camera(self) -> CameraConfig:
        """The one that perception looks through."""
        return self.cameras[0]


def check_scene(scene: SceneConfig) -> None:
    """Raises SceneError for a scene that cannot be built, though every single value could be."""
    places = np.array(scene.stack_positions, dtype=float).reshape(-1, 3)
    check_blocks(scene.blocks, "blocks")
    check_cameras(scene.cameras, places, "cameras")
    check_places(scene.stack_positions, scene.blocks.widest, scene.camera, "places")
    check_obstacles(scene.obstacles, places, scene.blocks.widest, "obstacles")
    if np.linalg.norm(scene.light.direction_world) < 1e-9:
        raise SceneError("light.direction", "= [0, 0, 0] is no direction")
