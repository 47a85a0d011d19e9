# SPDX-License-Identifier: Apache-2.0
"""What others notice of a simulator whose physics dies or hangs, and of two in one domain."""

from __future__ import annotations

import sys
import threading
from typing import Any

import pytest
from diagnostic_msgs.msg import DiagnosticArray, DiagnosticStatus
from rclpy.node import Node
from rclpy.parameter import Parameter
from ros2_run import PROCESS_TIMEOUT, Spawn
from rosgraph_msgs.msg import Clock
from tamp_interfaces.srv import ResetScene
from tamp_runtime.qos import RELIABLE, SENSOR_DATA

from sim_node import physics_thread
from sim_node.node import EXIT_PHYSICS_FAILED, SimNode
from sim_node.world import World

LAYOUT = ["red_box,blue_box", "", "green_box"]


def simulator(ros_context: Any, **fields: Any) -> SimNode:
    parameters = [Parameter("layout", value=LAYOUT), Parameter("real_time_factor", value=0.0)]
    node: SimNode = ros_context.add(
        SimNode(context=ros_context.context, parameter_overrides=parameters, **fields)
    )
    return node


class Client(Node):
    """Asks for resets, and keeps what each simulator says of itself."""

    def __init__(self, **fields: Any) -> None:
        super().__init__("client", **fields)
        self.reset = self.create_client(ResetScene, "sim/reset")
        self.said: dict[str, DiagnosticStatus] = {}
        self.create_subscription(DiagnosticArray, "diagnostics", self._keep, RELIABLE)

    def _keep(self, message: DiagnosticArray) -> None:
        self.said.update({status.hardware_id: status for status in message.status})

    def ask(self, ros_context: Any) -> ResetScene.Response:
        assert self.reset.wait_for_service(timeout_sec=60.0)
        future = self.reset.call_async(ResetScene.Request(layout=["", "pink_box", ""]))
        ros_context.wait_until(future.done, what="sim/reset")
        return future.result()


class Switch:
    """Replaces the world's step: it goes on as it is until told otherwise."""

    def __init__(self, monkeypatch: pytest.MonkeyPatch) -> None:
        self._step = World.step
        self.broken = False
        self.open = threading.Event()
        self.open.set()
        monkeypatch.setattr(World, "step", lambda world: self(world))

    def __call__(self, world: World) -> None:
        assert self.open.wait(120.0)
        if self.broken:
            raise ArithmeticError("the blocks explode")
        self._step(world)


@pytest.fixture
def switch(monkeypatch: pytest.MonkeyPatch) -> Switch:
    return Switch(monkeypatch)


def test_fault_11_who_waits_for_a_reset_when_the_physics_dies_is_told(
    ros_context: Any, switch: Switch
) -> None:
    ended = threading.Event()
    node = simulator(ros_context, on_failure=ended.set)
    client = ros_context.add(Client(context=ros_context.context))
    assert client.reset.wait_for_service(timeout_sec=60.0)
    switch.open.clear()
    future = client.reset.call_async(ResetScene.Request(layout=["", "pink_box", ""]))
    switch.broken = True
    switch.open.set()
    ros_context.wait_until(future.done, what="the answer")
    assert not future.result().success
    # In the middle of the reset, or before it came to it.
    assert "(ArithmeticError: the blocks explode)" in future.result().message
    assert "start sim_node anew" in future.result().message
    assert future.result().layout == LAYOUT
    assert ended.wait(60.0)
    assert node.failure == "ArithmeticError: the blocks explode"
    later = client.ask(ros_context)
    assert not later.success
    assert "the physics has stopped (ArithmeticError: the blocks explode)" in later.message


def test_fault_11_a_reset_is_answered_while_the_physics_hangs(
    ros_context: Any, switch: Switch, monkeypatch: pytest.MonkeyPatch
) -> None:
    simulator(ros_context)
    client = ros_context.add(Client(context=ros_context.context))
    monkeypatch.setattr(physics_thread, "POLL_SECONDS", 0.01)
    switch.open.clear()
    try:
        refused = client.ask(ros_context)
    finally:
        switch.open.set()
    assert not refused.success
    assert "the physics has not moved" in refused.message
    assert refused.layout == LAYOUT
    monkeypatch.setattr(physics_thread, "POLL_SECONDS", 60.0)
    assert client.ask(ros_context).success


DYING = """
import sys
from sim_node import node, world

step, steps = world.World.step, 0
def dying(self):
    global steps
    steps += 1
    if steps > 200:
        raise ArithmeticError("the blocks explode")
    step(self)
world.World.step = dying
sys.exit(node.run())
"""


def test_fault_11_a_process_whose_physics_died_ends_and_says_so(spawn: Spawn) -> None:
    process = spawn(sys.executable, "-c", DYING)
    _, stderr = process.communicate(timeout=PROCESS_TIMEOUT)
    assert process.returncode == EXIT_PHYSICS_FAILED
    assert "the physics stopped" in stderr
    assert "in dying" in stderr


def test_fault_6_two_simulators_in_one_domain_say_so_and_warn_who_resets(ros_context: Any) -> None:
    simulator(ros_context)
    client = ros_context.add(Client(context=ros_context.context))
    ros_context.wait_until(lambda: len(client.said) == 1)
    assert client.ask(ros_context).message == "the scene is [- | pink_box | -]"
    simulator(ros_context)
    ros_context.wait_until(
        lambda: (
            [(item.level, "two of sim_node" in item.message) for item in list(client.said.values())]
            == [(DiagnosticStatus.ERROR, True)] * 2
        ),
        what="both notice the other",
    )
    wanted = "the scene is [- | pink_box | -]; but there are two of sim_node in this domain"
    ros_context.wait_until(lambda: client.ask(ros_context).message.startswith(wanted))


def test_fault_6_simulators_in_namespaces_have_a_clock_each(ros_context: Any) -> None:
    heard: dict[str, int] = {}

    def listen(topic: str) -> None:
        def hear(_message: Clock) -> None:
            heard[topic] = heard.get(topic, 0) + 1

        client.create_subscription(Clock, topic, hear, SENSOR_DATA)

    client = ros_context.add(Client(context=ros_context.context, namespace="left"))
    for topic in ("/left/clock", "/right/clock", "/clock"):
        listen(topic)
    for namespace in ("left", "right"):
        simulator(ros_context, namespace=namespace)
    ros_context.wait_until(lambda: set(heard) == {"/left/clock", "/right/clock"})
    ros_context.wait_until(lambda: min(heard.values()) > 200)
    assert set(heard) == {"/left/clock", "/right/clock"}
    ros_context.wait_until(lambda: client.said, what="a sign of life")
    assert [status.level for status in client.said.values()] == [DiagnosticStatus.OK]
