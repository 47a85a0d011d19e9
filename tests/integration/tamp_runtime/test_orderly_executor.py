# SPDX-License-Identifier: Apache-2.0
"""A stopped executor leaves nothing behind: no callback that runs, no word on stderr."""

from __future__ import annotations

import signal
import sys
import threading

import pytest
import rclpy
from rclpy.context import Context
from rclpy.node import Node
from ros2_run import Spawn, finish
from tamp_runtime.node_thread import NodeThread
from tamp_runtime.orderly_executor import OrderlyExecutor

BUSY = """
import sys
from rclpy.callback_groups import ReentrantCallbackGroup
from rclpy.node import Node
from std_msgs.msg import String
from tamp_runtime.node_process import run_node

class Busy(Node):
    def __init__(self):
        super().__init__("busy")
        self.publisher = self.create_publisher(String, "words", 10)
        self.create_subscription(String, "words", self.hear, 10)
        self.groups = [ReentrantCallbackGroup() for _ in range(8)]
        for group in self.groups:
            self.create_timer(0.001, self.say, callback_group=group)

    def say(self):
        for _ in range(20):
            self.publisher.publish(String(data="word"))

    def hear(self, message):
        print("here", flush=True)

sys.exit(run_node(Busy))
"""


@pytest.mark.parametrize("number", [signal.SIGINT, signal.SIGTERM])
def test_fault_15_a_busy_node_stops_without_a_word(spawn: Spawn, number: signal.Signals) -> None:
    process = spawn(sys.executable, "-c", BUSY)
    assert process.stdout is not None
    assert process.stdout.readline() == "here\n"
    process.send_signal(number)
    ended = finish(process)
    assert (ended.code, ended.stderr) == (0, "")


@pytest.fixture
def node(domain_id: int) -> Node:
    context = Context()
    rclpy.init(context=context, domain_id=domain_id)
    return Node("node", context=context)


def test_fault_15_a_stop_waits_for_the_callback_that_runs(node: Node) -> None:
    started, may_end, ended, stopped = (threading.Event() for _ in range(4))

    def work() -> None:
        started.set()
        may_end.wait()
        assert not stopped.is_set()
        ended.set()

    node.create_timer(0.001, work)
    spinning = NodeThread(node, threads=2)
    started.wait()

    def stop() -> None:
        spinning.stop()
        stopped.set()

    stopping = threading.Thread(target=stop)
    stopping.start()
    may_end.set()
    stopping.join()
    assert ended.is_set()
    node.destroy_node()
    node.context.try_shutdown()


def test_no_more_callbacks_run_at_once_than_there_are_threads(node: Node) -> None:
    executor = OrderlyExecutor(2, context=node.context)
    executor.add_node(node)
    lock, running, most, runs = threading.Lock(), 0, 0, 0
    both = threading.Barrier(2, timeout=60.0)

    def work() -> None:
        nonlocal running, most, runs
        with lock:
            running += 1
            most = max(most, running)
        both.wait()  # passes only where two run at once
        with lock:
            running -= 1
            runs += 1

    for _ in range(4):
        executor.create_task(work)
    while runs < 4:
        executor.spin_once(timeout_sec=0.1)
    executor.shutdown()
    assert most == 2
    node.destroy_node()
    node.context.try_shutdown()


def test_what_a_callback_raises_reaches_whoever_spins(node: Node) -> None:
    executor = OrderlyExecutor(2, context=node.context)

    def fail() -> None:
        raise KeyError("lost")

    failed = executor.create_task(fail)
    with pytest.raises(KeyError, match="lost"):
        while True:
            executor.spin_once(timeout_sec=0.1)
            if failed.done():
                executor.create_task(lambda: None)
    executor.shutdown()
    node.destroy_node()
    node.context.try_shutdown()
