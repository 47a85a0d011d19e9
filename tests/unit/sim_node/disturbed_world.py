# SPDX-License-Identifier: Apache-2.0
"""A world in which the arm carries one block from stack to stack while something goes wrong."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass, field
from functools import lru_cache

import numpy as np

from motion_node import PANDA, MotionPlanner, PathSettings, Settings
from motion_node.timing.trajectory import Trajectory
from scene_graph import Move, Stacks
from sim_node import ArmController, World, robot_description, true_scene_graph
from sim_node.disturbance.disturber import Disturber
from sim_node.disturbance.request import Request

#: The arm takes red_box to the place in the middle.
LAYOUT: Stacks = (("red_box",), (), ("green_box", "blue_box"))
SEED = 4
CARRIED = "red_box"


@lru_cache(maxsize=1)
def carrying() -> Trajectory:
    """From home, red_box to the middle, and home again; high enough to fall."""
    with World() as world:
        world.reset(LAYOUT, SEED)
        graph = true_scene_graph(world)
    settings = Settings(path=PathSettings(steps=14, vertical=4, lift=0.08))
    planner = MotionPlanner(robot_description(), settings=settings)
    return planner.solve(
        graph, [Move(0, 1)], np.array(PANDA.home), np.array([0.04, 0.04])
    ).trajectory


@dataclass
class DisturbedWorld:
    """The world with its arm and what goes wrong in it; one step is one of the physics."""

    world: World
    layout: Stacks = LAYOUT
    told: list[str] = field(default_factory=list)

    def __post_init__(self) -> None:
        self.world.reset(self.layout, SEED)
        self.arm = ArmController(self.world)
        self.disturber = Disturber(self.world, self.arm, self.told.append)

    def promise(self, kind: str, *blocks: str, **amounts: object) -> str:
        """Asks for a disturbance; returns the sentence of the answer."""
        request = Request(kind, blocks, **amounts)  # type: ignore[arg-type]
        return self.disturber.request(request).sentence

    def disturb(self, kind: str, *blocks: str, **amounts: object) -> None:
        """Asks for a disturbance."""
        self.promise(kind, *blocks, **amounts)

    def carry(self) -> None:
        """Has the arm set out with red_box."""
        trajectory = carrying()
        self.arm.follow(
            PANDA.joint_names,
            trajectory.times,
            trajectory.positions.joined(),
            trajectory.velocities.joined(),
        )

    def run(self, seconds: float, watch: Callable[[], None] = lambda: None) -> None:
        """Goes on; ``watch`` is called after each step."""
        for _ in range(round(seconds / self.world.timestep)):
            self.arm.update()
            self.disturber.update()
            self.world.step()
            watch()

    def carry_to_the_end(self, watch: Callable[[], None] = lambda: None) -> None:
        """Carries red_box and waits until all lies still."""
        self.carry()
        self.run(carrying().duration + 0.5, watch)

    def position(self, name: str) -> np.ndarray:
        """Of a block's centre, shape (3,) [m]."""
        return np.array(self.world.block_pose(name)[0])

    def state(self, names: Sequence[str] = ()) -> np.ndarray:
        """All that moves, to be compared bit by bit: joints, and poses of blocks, all of them."""
        poses = [np.concatenate(self.world.block_pose(name)) for name in names or self.world.names]
        return np.concatenate([*self.world.joint_state()[:2], *poses])
