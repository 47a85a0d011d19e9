# SPDX-License-Identifier: Apache-2.0
"""Faults as they come over the wire: earlier lives, arms left behind, crowds, dead neighbours."""

from __future__ import annotations

import threading
from typing import Any

from diagnostic_msgs.msg import DiagnosticArray, DiagnosticStatus
from planner_neighbours import PERIOD, FakeMotion
from tamp_interfaces.action import AchieveGoal
from tamp_interfaces.msg import MotionStatus, SymbolicPlan
from tamp_runtime.qos import RELIABLE

Status = AchieveGoal.Result

GOAL = "red on green, blue on red"


def test_fault_1_a_restarted_planner_stops_the_plan_of_its_earlier_life(make_bench: Any) -> None:
    """It was not there when the motion node reported the plan; the report is latched."""
    bench = make_bench(earlier="earlier")

    def goes_on() -> None:
        bench.motion.report("earlier", MotionStatus.EXECUTING)

    bench.ros.wait_until(lambda: bench.client.plan(GOAL).status == Status.BUSY)
    goes_on()
    answer = bench.client.plan(GOAL, execute=True)
    assert (answer.status, bench.motion.plans) == (Status.BUSY, [])
    assert "plan earlier" in answer.message
    assert "ros2 run planner_node stop" in answer.message
    goes_on()
    bench.client.start(GOAL)
    seen = bench.feedback_until(lambda item: "earlier" in item.message)
    assert "stopping it, waiting until the arm rests" in seen[-1].message
    bench.ros.wait_until(lambda: bench.motion.stops)
    bench.motion.report("earlier", MotionStatus.CANCELLED)
    bench.motion.busy.release()
    result = bench.client.result(60.0)
    assert result.status == Status.SUCCESS, result.message
    assert bench.motion.stops[0].plan_id == "earlier"


def test_fault_2_an_arm_that_was_left_with_a_block_is_brought_home_first(make_bench: Any) -> None:
    bench = make_bench()
    bench.motion.arm, bench.motion.held = MotionStatus.ARM_RESTING, "red_box"
    bench.ros.wait_until(lambda: bench.planner._motion.newest.held == "red_box")
    result = bench.achieve(GOAL)
    assert result.status == Status.SUCCESS, result.message
    assert [stop.plan_id[:5] for stop in bench.motion.stops] == ["home-"]
    assert (result.motion.arm, result.motion.held) == (MotionStatus.ARM_HOME, "")


def test_fault_5_a_plan_that_a_starting_motion_node_passed_over_is_published_again(
    make_bench: Any,
) -> None:
    bench = make_bench()
    passed_over: list[str] = []
    take_up = bench.motion.take_up

    def pass_over(plan: SymbolicPlan) -> None:
        passed_over.append(plan.plan_id)
        bench.motion.take_up = take_up

    bench.motion.take_up = pass_over
    result = bench.achieve(GOAL)
    assert result.status == Status.SUCCESS, result.message
    assert passed_over == [plan.plan_id for plan in bench.motion.plans]


def test_fault_6_two_of_a_kind_are_refused_until_one_is_gone(make_bench: Any) -> None:
    bench = make_bench()
    bench.wait_for_scene()
    life = bench.motion.create_publisher(DiagnosticArray, "diagnostics", RELIABLE)
    alive = ["one", "other"]

    def live() -> None:
        status = [DiagnosticStatus(name="motion_node", hardware_id=name) for name in alive]
        if bench.ros.context.ok():
            life.publish(DiagnosticArray(status=status))

    bench.motion.create_timer(PERIOD, live)
    bench.ros.wait_until(lambda: bench.client.plan(GOAL).status == Status.CONFLICT)
    result = bench.achieve(GOAL)
    assert (result.status, bench.motion.plans) == (Status.CONFLICT, [])
    assert "there are two of motion_node in this domain" in result.message
    alive.pop()
    bench.ros.wait_until(lambda: bench.client.plan(GOAL).status == Status.SUCCESS)


def test_fault_10_without_perception_no_plan_is_made_on_an_old_scene(make_bench: Any) -> None:
    bench = make_bench(graph_max_age=1.0)
    bench.wait_for_scene()
    bench.perception.silent = True
    bench.ros.wait_until(lambda: bench.client.plan(GOAL).status == Status.NO_SCENE_GRAPH)
    assert "nothing has arrived from perception for" in bench.client.plan(GOAL).message


def test_fault_13_while_it_is_being_cancelled_nobody_is_told_to_cancel(make_bench: Any) -> None:
    release = threading.Event()

    def stop_slowly(motion: FakeMotion, plan: SymbolicPlan) -> None:
        while not release.wait(PERIOD) and not motion.closing.is_set():
            motion.report(plan.plan_id, MotionStatus.EXECUTING)
        motion.report(plan.plan_id, MotionStatus.CANCELLED)

    bench = make_bench(stop_slowly)
    bench.client.start(GOAL)
    bench.feedback_until(lambda item: item.stage == AchieveGoal.Feedback.EXECUTING)
    bench.client.cancel()
    bench.ros.wait_until(lambda: "is being cancelled" in bench.client.plan(GOAL).message)
    answer = bench.client.plan(GOAL)
    assert answer.status == Status.BUSY
    assert answer.message.endswith("is being cancelled; wait until the arm rests")
    release.set()
    assert bench.client.result(60.0).status == Status.CANCELLED
