# SPDX-License-Identifier: Apache-2.0
"""The motion node between two controllers' topics, and plans in frames that are not its arm's."""

from __future__ import annotations

from typing import Any

import pytest
from motion_neighbours import Bench, plan_message
from tamp_interfaces.msg import MotionStatus


@pytest.fixture
def bench(ros_context: Any) -> Bench:
    return Bench(ros_context)


def test_without_a_gripper_controller_nothing_sets_out(bench: Bench) -> None:
    bench.start(gripper_apart=True, start_timeout=0.5)
    bench.planner.ask(plan_message("a", (0, 2)))
    end = bench.end("a")
    assert (end.state, end.reason) == (MotionStatus.FAILED, MotionStatus.TRACKING_LOST)
    assert "nobody listens to /gripper_trajectory; is the gripper's controller" in end.message
    assert (end.arm, end.held) == (MotionStatus.ARM_HOME, "")
    assert not bench.arm.trajectories


def test_a_plan_in_a_foreign_frame_is_refused_with_both_names(bench: Bench) -> None:
    bench.start()
    plan = plan_message("a", (0, 2))
    plan.initial.header.frame_id = "map"
    bench.planner.ask(plan)
    end = bench.end("a")
    assert (end.state, end.reason) == (MotionStatus.FAILED, MotionStatus.INVALID_PLAN)
    assert "'map'" in end.message and "'panda_link0'" in end.message
    assert not bench.arm.trajectories


@pytest.mark.parametrize("frame", ["panda_link0", "cell"])
def test_a_plan_in_the_arms_frame_is_carried_out(bench: Bench, frame: str) -> None:
    bench.start(world_frame="cell")
    plan = plan_message("a", (0, 2))
    plan.initial.header.frame_id = frame
    bench.planner.ask(plan)
    assert bench.end("a").state == MotionStatus.SUCCEEDED
