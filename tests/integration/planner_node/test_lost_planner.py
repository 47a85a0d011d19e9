# SPDX-License-Identifier: Apache-2.0
"""A planner that is killed, and perhaps replaced, leaves no client waiting."""

from __future__ import annotations

import signal
import sys
from typing import Any

import pytest
from ros2_run import PROCESS_TIMEOUT, Process, Spawn, Start, finish

from planner_node.cli.client import PlannerClient
from planner_node.cli.unavailable import PlannerUnavailableError

#: Accepts every goal and works on it for ever, as a planner whose arm moves on and on.
PLANNER = """
import sys, threading
from rclpy.action import ActionServer, CancelResponse
from rclpy.callback_groups import ReentrantCallbackGroup
from rclpy.node import Node
from tamp_interfaces.action import AchieveGoal
from tamp_interfaces.srv import PlanToGoal
from tamp_runtime.node_process import run_node
from tamp_runtime.presence import Presence

class Planner(Node):
    def __init__(self):
        super().__init__("planner_node")
        if "mute" not in sys.argv:
            self.presence = Presence(self, "planner_node")
        self.create_service(PlanToGoal, "plan_to_goal", lambda _request, response: response)
        self.actions = ActionServer(
            self, AchieveGoal, "achieve_goal", self.work,
            callback_group=ReentrantCallbackGroup(),
            cancel_callback=lambda _goal: CancelResponse.ACCEPT,
        )
        print("ready", flush=True)

    def work(self, goal):
        stopped = threading.Event()
        print("at work", flush=True)
        if "late" in sys.argv:
            self.presence = Presence(self, "planner_node")
        while not goal.is_cancel_requested and self.context.ok():
            stopped.wait(0.05)
        if self.context.ok():
            print("cancelled", flush=True)
            goal.canceled()
        return AchieveGoal.Result(status=AchieveGoal.Result.CANCELLED, message="arm at rest")

sys.exit(run_node(Planner))
"""


@pytest.fixture
def start_planner(spawn: Spawn) -> Any:
    def start(*manners: str) -> Process:
        process = spawn(sys.executable, "-c", PLANNER, *manners)
        assert process.stdout is not None
        assert process.stdout.readline() == "ready\n"
        return process

    return start


@pytest.fixture
def client(ros_context: Any) -> Any:
    with PlannerClient(ros_context.context) as client:
        yield client


def lost(client: PlannerClient) -> str:
    """The sentence with which a client gives up."""
    with pytest.raises(PlannerUnavailableError) as caught:
        client.result(PROCESS_TIMEOUT)
    return str(caught.value)


def test_fault_1_a_killed_planner_is_missed_though_dds_counts_it_as_there(
    start_planner: Any, client: PlannerClient
) -> None:
    planner = start_planner()
    client.start("red on blue", timeout=PROCESS_TIMEOUT)
    planner.kill()
    sentence = lost(client)
    # DDS's own lease takes 20 s; it speaks first only where the machine stood still meanwhile.
    assert "no sign of life" in sentence or not client._goal_client.server_is_ready()
    assert "ros2 run planner_node stop" in sentence


def test_fault_1_a_restarted_planner_does_not_stand_in_for_the_one_that_had_the_goal(
    start_planner: Any, client: PlannerClient, ros_context: Any
) -> None:
    planner = start_planner()
    client.start("red on blue", timeout=PROCESS_TIMEOUT)
    ros_context.wait_until(client._planner.living, what="a sign of life")
    planner.kill()
    start_planner()
    # By its signs of life; by DDS, where it forgets the old one before it has found the new one.
    assert "planner_node went away" in lost(client)
    with pytest.raises(PlannerUnavailableError, match="does not know the goal"):
        client.cancel(PROCESS_TIMEOUT)
    # The next goal reaches the new one, not the dead one that DDS still counts.
    client.start("red on blue", timeout=PROCESS_TIMEOUT)
    client.cancel(PROCESS_TIMEOUT)
    assert client.result(PROCESS_TIMEOUT).message == "arm at rest"


def test_fault_1_one_killed_before_its_first_sign_of_life_is_not_taken_for_its_successor(
    start_planner: Any, client: PlannerClient
) -> None:
    planner = start_planner("mute")
    client.start("red on blue", timeout=PROCESS_TIMEOUT)
    planner.kill()
    start_planner()
    sentence = lost(client)
    assert "does not know the goal" in sentence or "planner_node went away" in sentence


def test_a_first_sign_of_life_after_the_goal_was_accepted_changes_nothing(
    start_planner: Any, client: PlannerClient, ros_context: Any
) -> None:
    start_planner("mute", "late")
    client.start("red on blue", timeout=PROCESS_TIMEOUT)
    ros_context.wait_until(
        lambda: not client.is_done() and client._followed_by, what="its being followed"
    )
    client.cancel(PROCESS_TIMEOUT)
    assert client.result(PROCESS_TIMEOUT).message == "arm at rest"


def test_fault_1_a_new_client_reaches_the_living_planner_beside_a_dead_one(
    start_planner: Any, ros_context: Any
) -> None:
    start_planner().kill()
    start_planner()
    with PlannerClient(ros_context.context) as client:
        assert client.plan("red on blue", timeout=PROCESS_TIMEOUT).status == 0


def test_fault_1_a_cancel_to_a_dead_planner_ends(start_planner: Any, client: PlannerClient) -> None:
    planner = start_planner()
    client.start("red on blue", timeout=PROCESS_TIMEOUT)
    planner.kill()
    with pytest.raises(PlannerUnavailableError, match="does not answer"):
        client.cancel(timeout=2.0)


@pytest.mark.usefixtures("without_shared_memory")
def test_a_planner_that_stands_still_for_a_while_is_waited_for(
    start_planner: Any, client: PlannerClient, ros_context: Any
) -> None:
    planner = start_planner()
    client.start("red on blue", timeout=PROCESS_TIMEOUT)
    sightings = client._planner
    ros_context.wait_until(sightings.living, what="a sign of life")
    planner.send_signal(signal.SIGSTOP)
    ros_context.wait_until(lambda: not sightings.living(), what="silence")
    planner.send_signal(signal.SIGCONT)
    ros_context.wait_until(sightings.living, what="a sign of life")
    assert not client.is_done()
    client.cancel(PROCESS_TIMEOUT)
    assert client.result(PROCESS_TIMEOUT).message == "arm at rest"


ENDS = {signal.SIGINT: 130, signal.SIGTERM: 143, signal.SIGHUP: 129}


@pytest.mark.parametrize("number", ENDS)
def test_fault_1_however_the_command_line_client_is_ended_it_cancels_its_goal(
    start_planner: Any, start: Start, number: signal.Signals
) -> None:
    planner = start_planner()
    process = start("planner_node", "achieve_goal", "red on blue")
    assert planner.stdout is not None
    assert planner.stdout.readline() == "at work\n"
    process.send_signal(number)
    ended = finish(process)
    assert ended.code == ENDS[number], ended
    assert planner.stdout.readline() == "cancelled\n"


def test_fault_1_ctrl_c_ends_the_command_line_client_of_a_dead_planner(
    start_planner: Any, start: Start
) -> None:
    planner = start_planner()
    process = start("planner_node", "achieve_goal", "red on blue")
    assert planner.stdout is not None
    assert planner.stdout.readline() == "at work\n"
    planner.kill()
    process.send_signal(signal.SIGINT)
    ended = finish(process)
    assert ended.code in (1, 130), ended
    assert "planner_node" in ended.stderr
