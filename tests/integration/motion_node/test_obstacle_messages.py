# SPDX-License-Identifier: Apache-2.0
"""Obstacles as messages: plans know them, and a motion that they are in the way of stops."""

from __future__ import annotations

from typing import Any

import pytest
from motion_neighbours import Bench, plan_message
from rclpy.node import Node
from tamp_interfaces.msg import MotionStatus
from tamp_runtime.qos import LATCHED
from visualization_msgs.msg import Marker, MarkerArray

#: A wall of which the arm gets neither over nor round, between the places.
WALL = (0.8, 0.02, 1.0), (0.55, 0.075, 0.5)


class Somebody(Node):
    """Publishes obstacles."""

    def __init__(self, **kwargs: Any) -> None:
        super().__init__("somebody", **kwargs)
        self._topic = self.create_publisher(MarkerArray, "obstacles", LATCHED)

    def put(
        self,
        size: tuple[float, float, float],
        at: tuple[float, float, float],
        frame: str = "world",
    ) -> None:
        """A box named wall, and nothing else."""
        wall = Marker(ns="wall", type=Marker.CUBE)
        wall.header.frame_id = frame
        wall.scale.x, wall.scale.y, wall.scale.z = size
        wall.pose.position.x, wall.pose.position.y, wall.pose.position.z = at
        wall.pose.orientation.w = 1.0
        self._topic.publish(MarkerArray(markers=[Marker(action=Marker.DELETEALL), wall]))

    def clear(self) -> None:
        """Nothing stands around any more."""
        self._topic.publish(MarkerArray(markers=[Marker(action=Marker.DELETEALL)]))


@pytest.fixture
def bench(ros_context: Any) -> Bench:
    return Bench(ros_context)


def knows(bench: Bench, obstacles: int, heard: int = MotionStatus.OBSTACLES_TAKEN) -> MotionStatus:
    """The newest status, once it says so."""

    def newest() -> MotionStatus:
        return bench.planner.statuses[-1]

    bench.wait(
        lambda: (
            bench.planner.statuses
            and (newest().obstacles, newest().obstacles_heard) == (obstacles, heard)
        ),
        f"{obstacles} obstacles",
    )
    return newest()


def test_plans_know_the_obstacles_of_messages_and_bad_ones_change_nothing(
    ros_context: Any, bench: Bench
) -> None:
    somebody = ros_context.add(Somebody(context=ros_context.context))
    bench.start(description_timeout=600.0)
    somebody.put(*WALL)
    knows(bench, 1)
    bench.planner.ask(plan_message("a", (0, 2)))
    end = bench.end("a")
    assert end.reason == MotionStatus.INFEASIBLE, end.message
    assert "wall" in end.constraint
    somebody.put(*WALL, frame="camera_optical")
    told = knows(bench, 1, MotionStatus.OBSTACLES_UNKNOWN_FRAME)
    assert "'camera_optical'" in told.obstacles_problem
    bench.planner.ask(plan_message("b", (0, 2)))
    assert bench.end("b").reason == MotionStatus.INFEASIBLE, "the wall is still there"
    somebody.clear()
    knows(bench, 0)
    bench.planner.ask(plan_message("c", (0, 2)))
    assert bench.end("c").state == MotionStatus.SUCCEEDED


def test_a_motion_that_an_obstacle_is_in_the_way_of_is_stopped_and_said(
    ros_context: Any, bench: Bench
) -> None:
    somebody = ros_context.add(Somebody(context=ros_context.context))
    bench.arm.hold_at = 0.3
    bench.start(description_timeout=600.0)
    bench.planner.ask(plan_message("a", (0, 2)))
    bench.wait(lambda: bench.arm.held, "an arm that is held")
    somebody.put((0.1, 0.1, 0.3), (0.5, 0.15, 0.15))  # where the block is to go
    bench.wait(lambda: len(bench.arm.trajectories) > 1, "the brake")
    bench.arm.hold_at = None
    end = bench.end("a")
    assert (end.state, end.reason) == (MotionStatus.FAILED, MotionStatus.OBSTRUCTED)
    assert end.message.startswith("obstacle wall is in the way of the ")
    assert bench.arm.at_home


def test_why_not_is_answered_with_what_would_help_and_nothing_moves(bench: Bench) -> None:
    bench.start(description_timeout=600.0)
    plan = plan_message("why", (0, 2))
    plan.initial.bases[2].position.x, plan.explain = 0.95, True
    bench.planner.ask(plan)
    end = bench.end("why")
    assert (end.state, end.reason) == (MotionStatus.FAILED, MotionStatus.INFEASIBLE)
    assert end.constraint.startswith("reach of the hand to")
    assert end.suggestion.startswith("move the place stack2 ")
    assert end.suggestion.endswith("mm nearer to the arm")
    assert not bench.arm.trajectories
