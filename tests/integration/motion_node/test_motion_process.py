# SPDX-License-Identifier: Apache-2.0
"""The node as a process, started by `ros2 run`."""

from __future__ import annotations

import signal
from typing import Any

import pytest
from motion_neighbours import PATIENT, Bench, plan_message
from ros2_run import Start, finish
from tamp_interfaces.msg import MotionStatus

NODE = ("motion_node", "motion_node")


def test_stopped_in_the_middle_of_a_plan_the_arm_goes_home_and_the_next_one_does_its_job(
    ros_context: Any, start: Start
) -> None:
    """The trajectory that was sent goes on: it ends at home with an empty hand."""
    bench = Bench(ros_context)
    bench.arm.hold_at = 0.5
    parameters = [word for name, value in PATIENT.items() for word in ("-p", f"{name}:={value}")]
    arguments = ("--ros-args", "-r", "__node:=motion", *parameters)
    process = start(*NODE, *arguments)
    bench.wait_for_idle()
    assert "motion" in bench.planner.get_node_names()
    bench.planner.ask(plan_message("a", (0, 2)))
    bench.wait_for_phase("a", "pick", 0)
    process.send_signal(signal.SIGINT)
    assert finish(process).code == 0
    # Started again, it ignores plan a, which is latched, and waits until the arm rests.
    bench.planner.statuses.clear()
    process = start(*NODE, *arguments)
    bench.wait_for_idle()
    bench.planner.ask(plan_message("b", (0, 2)))
    bench.arm.hold_at = None
    assert bench.end("b").state == MotionStatus.SUCCEEDED
    assert not bench.planner.of("a")
    assert len(bench.arm.trajectories) == 2
    process.send_signal(signal.SIGTERM)
    assert finish(process).code == 0
    assert bench.arm.at_home


@pytest.mark.usefixtures("without_shared_memory")
def test_fault_3_a_process_that_was_stopped_follows_the_arm_on(
    ros_context: Any, start: Start
) -> None:
    bench = Bench(ros_context)
    bench.arm.hold_at = 1.0
    parameters = [word for name, value in PATIENT.items() for word in ("-p", f"{name}:={value}")]
    process = start(*NODE, "--ros-args", *parameters)
    bench.wait_for_idle()
    bench.planner.ask(plan_message("a", (0, 2)))
    bench.wait(lambda: any(s.progress > 0.1 for s in bench.planner.of("a")), "seen to move")
    process.send_signal(signal.SIGSTOP)
    begun, bench.arm.hold_at = bench.arm.time, None
    bench.wait(lambda: bench.arm.time > begun + 60.0, "an arm that goes on")
    process.send_signal(signal.SIGCONT)
    end = bench.end("a")
    assert end.state == MotionStatus.SUCCEEDED, end.message
    assert len(bench.arm.trajectories) == 1
    process.send_signal(signal.SIGTERM)
    assert finish(process).code == 0


def test_a_parameter_that_cannot_be_is_one_sentence(start: Start) -> None:
    code, _, stderr = finish(start(*NODE, "--ros-args", "-p", "robot:=nobody"))
    assert code == 2
    assert stderr.strip().splitlines()[-1] == (
        "cannot start: parameter robot = 'nobody' is not a known arm; known: kuka_iiwa, panda"
    )
