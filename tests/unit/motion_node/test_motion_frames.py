# SPDX-License-Identifier: Apache-2.0
"""Plans in a frame that is not the arm's are refused."""

from __future__ import annotations

from dataclasses import replace

import pytest
from executive_bench import Bench
from simulated_arm import PLAN
from tamp_runtime.motion_report import MotionReason, MotionState

from motion_node.errors import InvalidPlanError
from motion_node.execution.executive import Executive
from motion_node.frames import check_frame
from motion_node.robots.kinematics import Kinematics


@pytest.mark.parametrize("frame", ["", "world", "base_link", "/base_link"])
def test_the_arms_frame_is_known_by_both_its_names(frame: str) -> None:
    check_frame(frame, "base_link", "world")


def test_a_foreign_frame_is_refused_with_both_names() -> None:
    with pytest.raises(InvalidPlanError, match=r"'map'.*'base_link'"):
        check_frame("map", "base_link", "world")


def test_a_link_that_is_not_the_root_is_foreign() -> None:
    with pytest.raises(InvalidPlanError, match=r"'base_link'.*'cell'"):
        check_frame("base_link", "cell", "cell")


def test_the_root_is_the_link_that_nothing_carries(urdf: str) -> None:
    assert Kinematics(urdf, ["panda_joint1"]).root == "panda_link0"
    carried = urdf.replace(
        "</robot>",
        '<link name="cell"/><joint name="mount" type="fixed"><parent link="cell"/>'
        '<child link="panda_link0"/></joint></robot>',
    )
    assert Kinematics(carried, ["panda_joint1"]).root == "cell"


def test_nothing_moves_for_a_plan_in_a_foreign_frame() -> None:
    bench = Bench()
    bench.executive = Executive(
        lambda: bench.planner,
        bench.arm,
        bench.follower,
        bench.condition,
        lambda: bench.settings,
        check=lambda plan: check_frame(plan.frame, "base_link", "world"),
    )
    end = bench.carry_out(replace(PLAN, frame="map"))
    assert (end.state, end.reason) == (MotionState.FAILED, MotionReason.INVALID_PLAN)
    assert not bench.arm.sent
    assert not bench.planner.asked
