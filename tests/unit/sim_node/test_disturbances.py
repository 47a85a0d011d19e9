# SPDX-License-Identifier: Apache-2.0
"""What goes wrong obeys physics, ends when it should, and the ground truth tells of it."""

from __future__ import annotations

from collections.abc import Iterator

import numpy as np
import pybullet
import pytest
from disturbed_world import CARRIED, DisturbedWorld, carrying

from scene_graph import Relation, Stacks
from sim_node import World, true_scene_graph
from sim_node.disturbance.request import DisturbanceError

TOWERS: Stacks = (("red_box", "green_box", "blue_box"), ("yellow_box",), ("pink_box", "cyan_box"))


@pytest.fixture(scope="module")
def world() -> Iterator[World]:
    with World() as world:
        yield world


@pytest.fixture
def scene(world: World) -> DisturbedWorld:
    return DisturbedWorld(world)


def stands_on(world: World, name: str) -> set[str]:
    return {item.object for item in true_scene_graph(world).relations if item.subject == name}


def finger_contacts(world: World, name: str) -> int:
    """How many contacts a block has with the arm, asked from the block's side."""
    points = pybullet.getContactPoints(
        bodyA=world.body(name), bodyB=world.robot, physicsClientId=world.client
    )
    return sum(point[9] > 0.0 for point in points)


def test_without_disturbances_the_block_is_carried_to_the_middle(scene: DisturbedWorld) -> None:
    scene.carry_to_the_end()
    assert stands_on(scene.world, CARRIED) == {"stack1"}
    assert scene.told == []


def test_a_pushed_block_slides_as_far_as_friction_lets_it(scene: DisturbedWorld) -> None:
    """v = (F - mu·m·g)·t/m, and then v²/(2·mu·g) farther; the table's edge is far."""
    before = scene.position("red_box")
    scene.disturb("push", "red_box", force=1.1, seconds=0.1)
    scene.run(2.0)
    moved = scene.position("red_box") - before
    friction = 0.9 * 0.9 * 9.81
    speed = (1.1 / 0.08 - friction) * 0.1
    assert moved[0] == pytest.approx(0.05 * speed + speed**2 / (2 * friction), rel=0.15)
    assert np.abs(moved[1:]).max() < 1e-3
    assert np.abs(scene.position("green_box") - [0.5, 0.15, 0.0225]).max() < 0.004
    assert scene.told[-1] == "disturbance 1 is over"


def test_a_push_goes_where_it_is_told(scene: DisturbedWorld) -> None:
    before = scene.position("red_box")
    scene.disturb("push", "red_box", direction=(0.0, -3.0, 0.0))
    scene.run(1.5)
    moved = scene.position("red_box") - before
    assert moved[1] < -0.03 and abs(moved[0]) < 0.005


def test_a_hard_pull_takes_the_block_out_of_the_hand(scene: DisturbedWorld) -> None:
    scene.disturb("push", force=60.0, direction=(0.0, 0.0, -1.0), when="in_air")
    scene.carry_to_the_end()
    assert "red_box is pushed with 60 N" in scene.told[1]
    assert "stack1" not in stands_on(scene.world, CARRIED)


def test_a_slipping_block_falls_freely_and_is_not_put_anywhere(scene: DisturbedWorld) -> None:
    heights: list[float] = []
    begun: list[int] = []

    def watch() -> None:
        heights.append(scene.position(CARRIED)[2])
        if len(scene.told) == 2 and not begun:
            begun.append(len(heights))

    scene.disturb("slip", when="in_air", height=0.04)
    scene.carry_to_the_end(watch)
    fall = np.array(heights[begun[0] :])
    assert fall[0] > 0.06
    acceleration = np.diff(fall[:12], 2) / scene.world.timestep**2
    assert np.median(acceleration) == pytest.approx(-9.81, rel=0.1)
    # Nothing teleports: no step is longer than a fall from there allows.
    assert np.abs(np.diff(heights)).max() < np.sqrt(2 * 9.81 * 0.3) * scene.world.timestep
    assert fall[-1] == pytest.approx(0.0225, abs=0.001)
    assert "stack1" not in stands_on(scene.world, CARRIED)


def test_after_a_slip_the_fingers_hold_as_before(scene: DisturbedWorld) -> None:
    links = scene.world.joint_indices[-2:]

    def friction() -> list[float]:
        return [
            pybullet.getDynamicsInfo(scene.world.robot, link, physicsClientId=scene.world.client)[1]
            for link in links
        ]

    before = friction()
    scene.disturb("slip", when="grasp", seconds=0.02)
    scene.carry()
    scene.run(carrying().duration + 0.5)
    assert friction() == before == pytest.approx([1.2, 1.2])
    assert stands_on(scene.world, CARRIED) == {"stack1"}


def test_a_jammed_gripper_stays_open_and_follows_again_afterwards(scene: DisturbedWorld) -> None:
    scene.disturb("jam", seconds=30.0)
    scene.carry_to_the_end()
    assert scene.world.joint_state()[0][-2:] == pytest.approx(0.04, abs=1e-4)
    assert stands_on(scene.world, CARRIED) == {"stack0"}
    again = DisturbedWorld(scene.world)
    again.disturb("jam", seconds=1.0)
    again.carry_to_the_end()
    assert stands_on(scene.world, CARRIED) == {"stack1"}


def test_a_gripper_that_jams_in_the_air_does_not_let_go(scene: DisturbedWorld) -> None:
    scene.disturb("jam", when="in_air", seconds=30.0)
    scene.carry_to_the_end()
    assert finger_contacts(scene.world, CARRIED) > 0
    assert scene.position(CARRIED)[2] > 0.3
    assert stands_on(scene.world, CARRIED) == set()


def test_a_shoved_table_topples_towers_and_leaves_single_blocks(world: World) -> None:
    scene = DisturbedWorld(world, TOWERS)
    scene.disturb("shove")
    scene.run(3.0)
    assert scene.position("blue_box")[2] < 0.05 and scene.position("cyan_box")[2] < 0.05
    assert stands_on(world, "yellow_box") == {"stack1"}
    assert Relation("blue_box", "up", "green_box") not in true_scene_graph(world).relations


def test_a_gentle_shove_moves_nothing_for_friction_holds(world: World) -> None:
    """Below mu·g, and below g·width/height of the highest tower, nothing slides or topples."""
    scene = DisturbedWorld(world, TOWERS)
    before = [scene.position(name) for name in world.names]
    scene.disturb("shove", acceleration=2.5, seconds=0.5)
    scene.run(2.0)
    after = [scene.position(name) for name in world.names]
    assert np.abs(np.subtract(after, before)).max() < 1e-3


def test_blocks_slide_backwards_first_when_the_table_is_shoved_hard(scene: DisturbedWorld) -> None:
    """Seen from the table; it begins to slide by less than a·t²/2 of a table without friction."""
    before = scene.position("red_box")
    scene.disturb("shove", acceleration=20.0, seconds=0.1, direction=(1.0, 0.0, 0.0))
    scene.run(0.05)
    moved = (scene.position("red_box") - before)[0]
    assert -0.5 * 20.0 * 0.05**2 < moved < -0.3 * (20.0 - 0.81 * 9.81) * 0.05**2


def test_a_nudged_arm_gives_way_and_comes_back(scene: DisturbedWorld) -> None:
    home = scene.world.arm.home_positions
    away: list[float] = []
    scene.disturb("nudge")
    scene.run(1.5, lambda: away.append(np.abs(scene.world.joint_state()[0] - home).max()))
    assert 0.05 < max(away) < 0.5
    assert away[-1] < 1e-3


@pytest.mark.parametrize(("what", "hidden"), [("hand", 0.3), ("sheet", 1.0)])
def test_a_cover_is_seen_without_a_label_and_then_gone(
    scene: DisturbedWorld, what: str, hidden: float
) -> None:
    before = scene.world.render()
    scene.disturb("cover", what=what, seconds=0.1)
    scene.run(0.05)
    during = scene.world.render()
    nearer = during.depth[before.labels > 0] < 0.6
    assert nearer.mean() >= hidden
    assert not during.labels[(during.depth > 0.0) & (during.depth < 0.6)].any()
    scene.run(0.1)
    after, undisturbed = scene.world.render(), DisturbedWorld(scene.world)
    undisturbed.run(0.15)
    expected = undisturbed.world.render()
    for name in ("rgb", "depth", "labels"):
        np.testing.assert_array_equal(getattr(after, name), getattr(expected, name))


def test_a_block_that_is_taken_away_is_gone_and_what_stood_on_it_falls(
    scene: DisturbedWorld,
) -> None:
    blue = scene.world.label("blue_box")
    scene.disturb("take_away", "green_box")
    scene.run(0.5)
    truth = true_scene_graph(scene.world)
    assert truth.stacks() == (("red_box",), (), ("blue_box",))
    labels = scene.world.render().labels
    assert set(np.unique(labels)) == {0, blue, scene.world.label("red_box")}


def test_a_block_is_taken_out_of_the_hand(scene: DisturbedWorld) -> None:
    scene.disturb("take_away", when="in_air", delay=0.1)
    scene.carry_to_the_end()
    assert true_scene_graph(scene.world).stacks() == ((), (), ("green_box", "blue_box"))


@pytest.mark.parametrize(
    ("where", "expected"),
    [({"on": "stack1"}, "stack1"), ({"on": "blue_box"}, "blue_box"),
     ({"position": (0.5, 0.0, 0.0)}, "stack1"), ({"position": (0.3, 0.0, 0.0)}, None)],
)  # fmt: skip
def test_an_added_block_stands_and_is_seen(
    scene: DisturbedWorld, where: dict[str, object], expected: str | None
) -> None:
    scene.disturb("add", "pink_box", **where)
    scene.run(0.5)
    assert stands_on(scene.world, "pink_box") == ({expected} if expected else set())
    label = scene.world.label("pink_box")
    assert label not in {scene.world.label(name) for name in ("red_box", "green_box", "blue_box")}
    frame = scene.world.render()
    red, green, blue = frame.rgb[frame.labels == label].mean(axis=0)
    assert red > blue > green


def test_a_block_that_gets_the_number_of_another_one_has_its_own_looks(
    scene: DisturbedWorld,
) -> None:
    scene.world.render()
    number = scene.world.body("blue_box")
    scene.disturb("take_away", "blue_box")
    scene.disturb("add", "yellow_cylinder", on="green_box")
    assert scene.world.body("yellow_cylinder") == number
    frame = scene.world.render()
    red, green, blue = frame.rgb[frame.labels == scene.world.label("yellow_cylinder")].mean(axis=0)
    assert red > 2 * blue and green > 2 * blue


def test_swapped_blocks_stand_in_one_another_s_place(scene: DisturbedWorld) -> None:
    before = {name: scene.position(name) for name in ("red_box", "green_box")}
    scene.disturb("swap", "red_box", "green_box")
    assert np.abs(scene.position("green_box") - before["red_box"]).max() < 1e-3
    assert np.abs(scene.position("red_box") - before["green_box"]).max() < 1e-3
    scene.run(1.0)
    assert true_scene_graph(scene.world).stacks() == (("green_box",), (), ("red_box", "blue_box"))


def test_what_is_in_the_hand_is_not_swapped(scene: DisturbedWorld) -> None:
    scene.carry()
    while finger_contacts(scene.world, CARRIED) == 0 or scene.position(CARRIED)[2] < 0.06:
        scene.run(0.02)
    with pytest.raises(DisturbanceError, match="red_box is in the hand"):
        scene.disturb("swap", CARRIED, "green_box")


def test_a_push_whose_block_is_taken_away_just_ends(scene: DisturbedWorld) -> None:
    scene.disturb("push", "red_box", seconds=1.0)
    scene.disturb("take_away", "red_box", delay=0.1)
    scene.run(1.5)
    assert scene.told[-1] == "disturbance 1 is over"
