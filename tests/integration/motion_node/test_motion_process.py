# SPDX-License-Identifier: Apache-2.0
"""The node as a process, started by `ros2 run`."""

from __future__ import annotations

import signal
from typing import Any

import numpy as np
import pytest
from motion_neighbours import HOME, Bench, plan_message
from ros2_run import Start, finish
from tamp_interfaces.msg import MotionStatus

NODE = ("motion_node", "motion_node")


@pytest.mark.parametrize("number", [signal.SIGINT, signal.SIGTERM])
def test_a_signal_ends_it_with_exit_code_0(
    ros_context: Any, start: Start, number: signal.Signals
) -> None:
    bench = Bench(ros_context)
    process = start(*NODE)
    bench.wait_for_idle()
    process.send_signal(number)
    assert finish(process).code == 0


def test_a_signal_ends_it_in_the_middle_of_a_plan(ros_context: Any, start: Start) -> None:
    """The trajectory that was sent goes on: it ends at home with an empty hand."""
    bench = Bench(ros_context)
    process = start(*NODE)
    bench.wait_for_idle()
    bench.planner.ask(plan_message("a", (0, 2)))
    bench.wait_for_phase("a", "place", 0)
    process.send_signal(signal.SIGINT)
    assert finish(process).code == 0
    bench.wait(lambda: np.abs(bench.arm.positions - HOME).max() < 0.02, "the arm at home")


def test_started_by_hand_with_parameters_and_remappings_it_does_its_job_again_and_again(
    ros_context: Any, start: Start
) -> None:
    bench = Bench(ros_context)
    for plan_id in ("a", "b"):  # stopped and started again, with plan a still latched
        bench.planner.statuses.clear()
        process = start(
            *NODE, "--ros-args", "-r", "__node:=motion", "-p", "velocity_scale:=0.5", "-r", "x:=y"
        )
        bench.wait_for_idle()
        assert "motion" in bench.planner.get_node_names()
        bench.planner.ask(plan_message(plan_id, (0, 2)))
        assert bench.end(plan_id).state == MotionStatus.SUCCEEDED
        process.send_signal(signal.SIGINT)
        assert finish(process).code == 0
    assert not bench.planner.of("a")


def test_a_parameter_out_of_range_is_one_sentence(start: Start) -> None:
    code, _, stderr = finish(start(*NODE, "--ros-args", "-p", "acceleration_scale:=7.0"))
    assert code == 2
    assert "acceleration_scale" in stderr
