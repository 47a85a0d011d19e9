# SPDX-License-Identifier: Apache-2.0
"""MuJoCo's world as the replay drives it; left out where MuJoCo was never installed."""

from __future__ import annotations

import sys
from collections.abc import Iterator
from dataclasses import replace

import numpy as np
import pytest
from replay.arm_links import Link, arm_links, bodies_in
from replay.carry_out import carry_out
from replay.compare import relations_of
from replay.environment import FOLDER
from replay.recording import Command, Recording
from replay_scenes import recording

from scene_graph import up_relations
from sim_node.world import World

pytestmark = pytest.mark.skipif(
    not (FOLDER / ".stamp").is_file(),
    reason="MuJoCo is not installed; `make eval-replay QUICK=1` installs it",
)

LAYOUT = (("red_box", "green_box", "blue_box"), ("cyan_box",), ())


@pytest.fixture
def _mujoco(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(sys, "path", [*sys.path, str(FOLDER)])


@pytest.fixture(scope="module")
def world() -> Iterator[World]:
    with World() as made:
        made.reset(LAYOUT, 1)
        yield made


@pytest.fixture(scope="module")
def links(world: World) -> tuple[Link, ...]:
    return arm_links(world)


def scene(world: World, *commands: Command, seconds: float = 1.0) -> Recording:
    return recording(
        bodies=bodies_in(world),
        places=world.config.stack_positions,
        start=world.joint_state()[0],
        commands=commands,
        trace=replace(recording().trace, times=np.array([seconds])),
    )


@pytest.mark.usefixtures("_mujoco")
def test_towers_stand_where_pybullet_has_them(world: World, links: tuple[Link, ...]) -> None:
    from replay.mujoco_world import MujocoWorld

    still = scene(world)
    trace = carry_out(still, MujocoWorld(still, links, world.max_velocity))
    assert np.abs(trace.poses[:, :, :3] - trace.poses[0, :, :3]).max() < 1e-3
    wanted = sorted((item.subject, item.predicate, item.object) for item in up_relations(LAYOUT))
    assert list(relations_of(still, trace.poses[-1])) == wanted


@pytest.mark.usefixtures("_mujoco")
def test_the_arm_goes_where_it_is_sent_with_the_torques_it_has(
    world: World, links: tuple[Link, ...]
) -> None:
    from replay.mujoco_world import MujocoWorld

    home = world.arm.home_positions
    turned = home.copy()
    turned[[0, 1, 6, 7, 8]] += [0.8, -0.2, 0.5, -0.02, -0.02]
    sent = Command(0.1, np.array([0.0, 1.0]), np.array([home, turned]), None)
    moved = scene(world, sent)
    engine = MujocoWorld(moved, links, world.max_velocity)
    trace = carry_out(moved, engine)
    assert trace.joints[-1] == pytest.approx(turned, abs=1e-3)
    assert (np.abs(engine.joint_state()[2]) <= world.max_effort).all()
    assert not trace.notes


@pytest.mark.usefixtures("_mujoco")
def test_a_hand_that_sweeps_over_the_table_throws_towers_over(
    world: World, links: tuple[Link, ...]
) -> None:
    from replay.mujoco_world import MujocoWorld

    down = np.array([-0.7, 0.4, 0.0, -2.4, 0.0, 2.8, 0.785, 0.04, 0.04])
    swept = down.copy()
    swept[0] = 0.7
    positions = np.array([world.arm.home_positions, down, swept])
    sweep = scene(world, Command(0.1, np.array([0.0, 1.0, 3.0]), positions, None))
    trace = carry_out(sweep, MujocoWorld(sweep, links, world.max_velocity))
    assert np.abs(trace.poses[-1, :, :2] - trace.poses[0, :, :2]).max() > 0.05
    assert relations_of(sweep, trace.poses[-1]) != relations_of(sweep, trace.poses[0])
