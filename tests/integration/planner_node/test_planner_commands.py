# SPDX-License-Identifier: Apache-2.0
"""The node and the clients as processes, started by `ros2 run`."""

from __future__ import annotations

import signal
import time
from collections.abc import Callable
from concurrent.futures import ThreadPoolExecutor
from typing import Any

import pytest
from planner_neighbours import run_until_stopped
from rclpy.action import ActionServer
from rclpy.node import Node
from ros2_run import PROCESS_TIMEOUT, Start, finish
from tamp_interfaces.action import AchieveGoal
from tamp_interfaces.srv import PlanToGoal

from planner_node.cli.client import PlannerClient
from planner_node.cli.unavailable import PlannerUnavailableError
from planner_node.node import PlannerNode

PACKAGE = "planner_node"
GOAL = "red on green, blue on red"


def test_a_plan_is_printed_move_by_move(make_bench: Any, start: Start) -> None:
    bench = make_bench()
    bench.wait_for_scene()
    code, stdout, _ = finish(start(PACKAGE, "plan_to_goal", GOAL))
    assert code == 0
    lines = stdout.splitlines()
    assert lines[0].startswith("3 moves to 'red_box on green_box")
    assert lines[1].split()[0] == "start"
    assert lines[1].split("  ")[-1].strip() == "[red_box blue_box | green_box | -]"
    assert lines[2] == "(0, 2) blue_box  [red_box | green_box | blue_box]"
    assert lines[4] == "(2, 1) blue_box  [- | green_box red_box blue_box | -]"
    assert "states expanded" in lines[5]
    assert bench.motion.plans == []


@pytest.mark.parametrize("executable", ["plan_to_goal", "achieve_goal"])
def test_without_a_planner_the_clients_say_how_to_start_it(start: Start, executable: str) -> None:
    code, _, stderr = finish(start(PACKAGE, executable, GOAL, "--timeout", "1"))
    assert code == 1
    assert "ros2 run planner_node planner_node" in stderr


def test_an_achieved_goal_shows_its_stages(make_bench: Any, start: Start) -> None:
    bench = make_bench()
    code, stdout, _ = finish(start(PACKAGE, "achieve_goal", GOAL))
    assert code == 0
    first_words = [line.split()[0] for line in stdout.splitlines()]
    stages = [word for word in dict.fromkeys(first_words) if word.isalpha()]
    assert stages[:5] == ["perceive", "plan", "optimise", "start", "execute"]
    # rclpy's action client drops feedback that arrives after the result, so it may end earlier.
    assert stages[5] in ("confirm", "the")
    assert "the camera confirms" in stdout
    assert bench.world.stacks[1] == ("green_box", "red_box", "blue_box")


def test_ctrl_c_cancels_the_goal_and_waits_for_the_arm(make_bench: Any, start: Start) -> None:
    bench = make_bench(run_until_stopped)
    process = start(PACKAGE, "achieve_goal", GOAL)
    assert process.stdout is not None
    process.stdout.readline()  # from now on it knows that the planner has the goal
    bench.ros.wait_until(lambda: bench.motion.plans, PROCESS_TIMEOUT)
    process.send_signal(signal.SIGINT)
    code, _, stderr = finish(process)
    assert code == 130
    assert "put red_box down first" in stderr
    assert len(bench.motion.stops) == 1


def test_names_can_be_remapped_on_the_command_line(start: Start) -> None:
    node = start(PACKAGE, "planner_node", "--ros-args", "-r", "__ns:=/lab", "-p", "max_replans:=1")
    code, _, stderr = finish(start(PACKAGE, "plan_to_goal", GOAL, "--ros-args", "-r", "__ns:=/lab"))
    assert code == 1
    assert "nothing has arrived from perception yet" in stderr
    node.send_signal(signal.SIGINT)
    assert finish(node)[0] == 0


def test_a_parameter_out_of_range_stops_the_node_with_a_sentence(start: Start) -> None:
    code, _, stderr = finish(start(PACKAGE, "planner_node", "--ros-args", "-p", "max_replans:=-1"))
    assert code == 2
    assert "max_replans" in stderr


@pytest.mark.parametrize("number", [signal.SIGINT, signal.SIGTERM])
def test_the_node_stops_on_signals(ros_context: Any, start: Start, number: int) -> None:
    node = start(PACKAGE, "planner_node")
    with PlannerClient(ros_context.context) as client:
        assert client.plan(GOAL, timeout=PROCESS_TIMEOUT).message
        node.send_signal(number)
        assert finish(node)[0] == 0
        with pytest.raises(PlannerUnavailableError):
            client.plan(GOAL, timeout=0.5)


@pytest.mark.parametrize("ask", [PlannerClient.plan, PlannerClient.start])
def test_a_request_to_a_planner_that_goes_away_is_sent_to_the_next(
    ros_context: Any, ask: Callable[..., Any]
) -> None:
    """As a node that stops is still seen for a moment, this one is seen and never answers."""
    old = Node("old_planner", context=ros_context.context)
    old.create_service(PlanToGoal, "plan_to_goal", lambda _request, response: response)
    actions = ActionServer(old, AchieveGoal, "achieve_goal", lambda _goal: AchieveGoal.Result())
    with (
        PlannerClient(ros_context.context) as client,
        ThreadPoolExecutor(1) as pool,
    ):
        answer = pool.submit(ask, client, GOAL, timeout=PROCESS_TIMEOUT)
        requests = (
            client._plan_client._pending_requests,
            client._goal_client._pending_goal_requests,
        )
        ros_context.wait_until(lambda: any(requests), what="the request is sent")
        actions.destroy()
        old.destroy_node()
        ros_context.wait_until(lambda: not any(requests), what="the request is given up")
        ros_context.add(PlannerNode(context=ros_context.context))
        answer.result(PROCESS_TIMEOUT)


def test_the_node_stops_while_the_arm_moves_and_can_be_started_again(
    make_bench: Any, start: Start
) -> None:
    bench = make_bench(run_until_stopped)
    bench.ros.remove(bench.planner)
    node = start(PACKAGE, "planner_node")
    bench.client.start(GOAL, timeout=PROCESS_TIMEOUT)
    bench.feedback_until(lambda item: item.stage == AchieveGoal.Feedback.EXECUTING)
    node.send_signal(signal.SIGINT)
    assert finish(node)[0] == 0
    with pytest.raises(PlannerUnavailableError, match="went away"):
        bench.client.result(PROCESS_TIMEOUT)

    start(PACKAGE, "planner_node")
    # The motion goes on, and the new planner sees that the plan is not its own.
    answer = bench.client.plan("red on blue", timeout=PROCESS_TIMEOUT)
    deadline = time.monotonic() + PROCESS_TIMEOUT
    while answer.status != answer.BUSY and time.monotonic() < deadline:
        answer = bench.client.plan("red on blue")
    assert answer.status == answer.BUSY
    bench.motion.stop_requested.set()
    bench.ros.wait_until(lambda: bench.client.plan(GOAL).status == 0)
    bench.client.start(GOAL)
    assert bench.client.result(20.0).status == AchieveGoal.Result.SUCCESS
