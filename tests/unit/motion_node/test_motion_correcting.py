# SPDX-License-Identifier: Apache-2.0
"""A motion under way is corrected for a block that moved, without a jump, within the limits."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from motion_scenes import scene
from scipy.interpolate import CubicHermiteSpline

from motion_node.blocks import read_scene
from motion_node.correcting import corrected
from motion_node.dense_check import check
from motion_node.errors import InfeasibleError
from motion_node.motion import Motion
from motion_node.planner import MotionPlanner
from scene_graph import Move, SceneGraph

OPEN = np.full(2, 0.04)
MOVES = [Move(0, 2), Move(1, 2)]
GRAPH = scene((1, 1, 0))


@pytest.fixture(scope="module")
def motion(planner: MotionPlanner) -> Motion:
    return planner.solve(GRAPH, MOVES, planner.model.home, OPEN)


def shifted(graph: SceneGraph, name: str, dx: float, dy: float) -> SceneGraph:
    """A block a little elsewhere."""

    def there(x: float, y: float, z: float) -> tuple[float, float, float]:
        return x + dx, y + dy, z

    objects = tuple(
        replace(item, position_world=there(*item.position_world)) if item.name == name else item
        for item in graph.objects
    )
    return replace(graph, objects=objects)


@pytest.mark.parametrize("share", [0.0, 0.2, 0.5])
@pytest.mark.parametrize("step", [(0.035, 0.0), (-0.03, 0.04), (0.0, -0.05)])
def test_a_block_that_moved_is_taken_where_it_is_without_a_jump(
    planner: MotionPlanner, motion: Motion, share: float, step: tuple[float, float]
) -> None:
    first = motion.trajectory.intervals[0]
    at = first.start + share * (first.end - first.start)
    moved = shifted(GRAPH, "red_box", *step)
    after = corrected(planner, motion, at, moved, MOVES)
    before, rates = motion.trajectory.sample(at)
    begin, setting_out = after.trajectory.sample(0.0)
    np.testing.assert_allclose(begin.arm, before.arm, atol=1e-9)
    np.testing.assert_allclose(setting_out.arm, rates.arm, atol=1e-9)
    x, y, _ = moved.object("red_box").position_world
    taken = after.trajectory.sample(after.trajectory.intervals[0].end)[0].arm
    np.testing.assert_allclose(planner.model.tool_at(taken)[:2], (x, y), atol=1e-3)
    assert not check(planner.model, after.trajectory, read_scene(moved), ()).contacts
    np.testing.assert_allclose(after.trajectory.positions.arm[-1], planner.model.home, atol=1e-9)


def test_limits_are_kept(planner: MotionPlanner, motion: Motion) -> None:
    """As scipy samples what a controller interpolates, every millisecond."""
    first = motion.trajectory.intervals[0]
    moved = shifted(GRAPH, "red_box", 0.03, 0.04)
    for share in (0.1, 0.3, 0.5):
        after = corrected(planner, motion, share * first.end, moved, MOVES).trajectory
        cubic = CubicHermiteSpline(after.times, after.positions.arm, after.velocities.arm)
        times = np.arange(0.0, after.duration, 0.001)
        settings, limits = planner.timing, planner.limits
        most = settings.velocity_scale * limits.velocity
        assert (np.abs(cubic(times, 1)) <= most * 1.002).all()
        most = settings.acceleration_scale * limits.acceleration
        assert (np.abs(cubic(times, 2)) <= most * 1.002).all()


def test_a_place_that_moved_is_reached_with_the_block_in_hand(
    planner: MotionPlanner, motion: Motion
) -> None:
    way = motion.trajectory.intervals[2]
    at = way.start + 0.15 * (way.end - way.start)
    x, y, z = GRAPH.places[2].position_world
    places = (*GRAPH.places[:2], replace(GRAPH.places[2], position_world=(x - 0.02, y + 0.02, z)))
    after = corrected(planner, motion, at, replace(GRAPH, places=places), MOVES)
    put = after.trajectory.sample(after.trajectory.intervals[0].end)[0].arm
    np.testing.assert_allclose(planner.model.tool_at(put)[:2], (x - 0.02, y + 0.02), atol=1e-3)
    _, rates = motion.trajectory.sample(at)
    np.testing.assert_allclose(after.trajectory.sample(0.0)[1].arm, rates.arm, atol=1e-9)


def test_only_the_way_to_the_next_switch(planner: MotionPlanner, motion: Motion) -> None:
    moved = shifted(GRAPH, "red_box", 0.02, 0.02)
    at = 0.3 * motion.trajectory.intervals[0].end
    whole = corrected(planner, motion, at, moved, MOVES)
    part = corrected(planner, motion, at, moved, MOVES, to_next_switch=True)
    assert [phase.kind for phase in part.phases] == ["pick"]
    ends = [m.trajectory.sample(m.trajectory.intervals[0].end)[0].arm for m in (whole, part)]
    tools = [planner.model.tool_at(q) for q in ends]
    np.testing.assert_allclose(tools[0], tools[1], atol=1e-3)


def test_fingers_that_close_are_not_corrected(planner: MotionPlanner, motion: Motion) -> None:
    gripping = motion.trajectory.intervals[1]
    at = (gripping.start + gripping.end) / 2
    with pytest.raises(InfeasibleError, match="before the fingers move"):
        corrected(planner, motion, at, shifted(GRAPH, "red_box", 0.02, 0.0), MOVES)
