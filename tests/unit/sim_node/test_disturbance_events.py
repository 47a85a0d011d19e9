# SPDX-License-Identifier: Apache-2.0
"""Events of the hand come when the physics has them, and the same disturbance does the same."""

from __future__ import annotations

from collections.abc import Iterator
from typing import Any

import numpy as np
import pytest
from disturbed_world import CARRIED, DisturbedWorld, carrying
from hypothesis import given
from hypothesis import strategies as st

from sim_node import World
from sim_node.disturbance.events import STEADY_STEPS, EventWatch, HoldWatch
from sim_node.disturbance.hand import touched_block
from sim_node.disturbance.request import DisturbanceError


@pytest.fixture(scope="module")
def world() -> Iterator[World]:
    with World() as world:
        yield world


def moments(world: World, *watches: EventWatch) -> list[list[int]]:
    """At which steps each watch saw its event while red_box is carried."""
    scene = DisturbedWorld(world)
    seen: list[list[int]] = [[] for _ in watches]
    scene.carry()
    for number in range(round((carrying().duration + 0.5) / world.timestep)):
        scene.run(world.timestep)
        touched = touched_block(world)
        for watch, steps in zip(watches, seen):
            if watch.observe(touched) == CARRIED:
                steps.append(number)
    return seen


def recorded(world: World) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Height of red_box, and how wide the fingers are open and commanded to be, each step [m]."""
    scene, rows = DisturbedWorld(world), []

    def watch() -> None:
        width = scene.world.joint_state()[0][-2:].sum()
        rows.append((scene.position(CARRIED)[2], width, scene.arm.target()[0][-2:].sum()))

    scene.carry_to_the_end(watch)
    heights, widths, commanded = np.array(rows).T
    return heights, widths, commanded


def test_events_come_when_joints_and_heights_say_so(world: World) -> None:
    """The oracle: fingers at the block's width, told to close farther, and the block's height."""
    world.reset((("red_box",), (), ()))
    (grasp,), (release,), (lift,) = moments(
        world,
        *(EventWatch(world, kind, 1, "", 0.015) for kind in ("grasp", "release", "in_air")),
    )
    heights, widths, commanded = recorded(world)
    squeezed = (np.abs(widths - 0.045) < 0.002) & (commanded < widths - 0.004)
    assert abs(grasp - int(np.argmax(squeezed))) <= 12
    last = len(squeezed) - 1 - int(np.argmax(squeezed[::-1]))
    assert abs(release - last) <= 24
    assert lift == pytest.approx(np.argmax(heights > 0.0225 + 0.015), abs=2)
    assert grasp < lift < release


def test_the_second_event_and_that_of_another_block_are_waited_for(world: World) -> None:
    world.reset((("red_box",), (), ()))
    seen = moments(
        world,
        EventWatch(world, "grasp", 2, "", 0.015),
        EventWatch(world, "grasp", 1, "blue_box", 0.015),
        EventWatch(world, "in_air", 1, "red_box", 0.45),
    )
    assert seen == [[], [], []]
    again = DisturbedWorld(world)
    again.disturb("jam", when="release", count=2)
    again.carry_to_the_end()
    assert (again.disturber.pending, again.disturber.active) == (1, 0)


@given(st.lists(st.sampled_from(["", "a", "b"]), max_size=60))
def test_who_comes_into_the_hand_leaves_it_before_the_next_one(touches: list[str]) -> None:
    watch, held = HoldWatch(""), ""
    for index, touched in enumerate(touches):
        released, grasped = watch.observe(touched)
        steady = len(set(touches[max(0, index - STEADY_STEPS + 1) : index + 1])) == 1
        if released or grasped:
            assert released == held and grasped == touched and steady
            held = grasped
        assert watch.held == held


def test_a_delay_counts_from_the_event(world: World) -> None:
    steps = []
    for delay in (0.0, 0.25):
        scene = DisturbedWorld(world)
        before = world.steps
        scene.disturb("jam", when="in_air", delay=delay)
        scene.carry()
        while not scene.disturber.active:
            scene.run(world.timestep)
        steps.append(world.steps - before)
    assert steps[1] - steps[0] == 60


def test_a_disturbance_at_a_step_begins_there(world: World) -> None:
    scene = DisturbedWorld(world)
    scene.disturb("push", "red_box", when="at", step=world.steps + 24)
    scene.run(24 * world.timestep)
    assert scene.disturber.pending == 1
    before = scene.position("red_box")
    scene.run(10 * world.timestep)
    assert scene.position("red_box")[0] > before[0] + 1e-4


def test_a_reset_drops_what_is_pending_and_under_way(world: World) -> None:
    scene = DisturbedWorld(world)
    scene.disturb("cover")
    scene.disturb("slip", when="grasp")
    assert scene.disturber.reset() == 2
    scene.run(0.1)
    assert (scene.disturber.pending, scene.disturber.active) == (0, 0)


def test_calm_ends_what_is_under_way_as_its_time_would(world: World) -> None:
    scene = DisturbedWorld(world)
    before = world.render()
    scene.disturb("cover", what="sheet")
    scene.disturb("slip", when="grasp")
    scene.disturb("calm")
    np.testing.assert_array_equal(world.render().labels, before.labels)
    assert (scene.disturber.pending, scene.disturber.active) == (0, 0)


def test_one_slip_or_jam_at_a_time(world: World) -> None:
    scene = DisturbedWorld(world)
    scene.disturb("jam", seconds=0.1)
    with pytest.raises(DisturbanceError, match="disturbance 1 of the same kind"):
        scene.disturb("jam")
    scene.run(0.2)
    scene.disturb("jam")


#: All of them at once or one after the other, as somebody who tries things out would.
PLANS: dict[str, list[tuple[tuple[str, ...], dict[str, Any]]]] = {
    "slip": [(("slip",), {"when": "in_air"})],
    "push": [(("push", "blue_box"), {"when": "grasp"}), (("push",), {"when": "release"})],
    "jam and nudge": [(("jam",), {"when": "grasp"}), (("nudge",), {"when": "in_air"})],
    "shove": [(("shove",), {"delay": 1.0}), (("shove",), {"when": "in_air", "seconds": 0.5})],
    "blocks": [
        (("take_away", "blue_box"), {"when": "grasp"}),
        (("add", "pink_box"), {"on": "green_box", "when": "in_air"}),
    ],
}


def states(world: World, plan: list[tuple[tuple[str, ...], dict[str, Any]]]) -> list[np.ndarray]:
    scene, seen = DisturbedWorld(world), []
    for names, amounts in plan:
        scene.disturb(*names, **amounts)
    scene.carry_to_the_end(lambda: seen.append(scene.state()))
    assert len(scene.told) >= 2 * len(plan) or not plan
    return seen


@pytest.mark.parametrize("plan", PLANS.values(), ids=list(PLANS))
def test_the_same_disturbance_gives_the_same_physics_bit_by_bit(
    world: World, plan: list[tuple[tuple[str, ...], dict[str, Any]]]
) -> None:
    """In a world that has seen others before, and in a fresh one."""
    with World() as fresh:
        expected = states(fresh, plan)
    for seen, wanted in zip(states(world, plan), expected, strict=True):
        np.testing.assert_array_equal(seen, wanted)


def test_what_only_waits_or_is_only_seen_changes_nothing(world: World) -> None:
    expected = states(world, [])
    scene, seen = DisturbedWorld(world), []
    for kind in ("grasp", "release", "in_air"):
        scene.disturb("jam", when=kind, count=9)
    scene.disturb("cover", when="grasp", seconds=1.0)
    scene.disturb("cover", what="sheet", seconds=0.5)
    scene.carry_to_the_end(lambda: seen.append(scene.state()))
    assert scene.disturber.pending == 3
    for now, wanted in zip(seen, expected, strict=True):
        np.testing.assert_array_equal(now, wanted)
