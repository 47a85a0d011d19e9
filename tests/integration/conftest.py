# SPDX-License-Identifier: Apache-2.0
"""Nodes spun in process, each test in a context and a DDS domain of its own."""

from __future__ import annotations

import functools
import os
import signal
import threading
import time
from collections.abc import Callable, Collection, Iterator
from typing import TypeVar

import pytest
import rclpy
from rclpy.context import Context
from rclpy.exceptions import InvalidHandle
from rclpy.executors import ExternalShutdownException
from rclpy.node import Node
from ros2_run import Process, Spawn, Start, start_process
from tamp_runtime.node_process import prepare_process
from tamp_runtime.orderly_executor import OrderlyExecutor

prepare_process()
os.environ.setdefault("ROS_PYTHON_CHECK_FIELDS", "1")

#: How long to wait for what comes at once on an idle machine [s]. A test that passes waits for
#: nothing, and machines that stand still for half a minute exist.
PATIENCE = 120.0

AnyNode = TypeVar("AnyNode", bound=Node)


class RosContext:
    """A context, and an executor in a thread that spins what is added.

    Attributes:
        context: give it to nodes: ``ros_context.add(MyNode(context=ros_context.context))``.
    """

    def __init__(self, domain_id: int) -> None:
        self.context = Context()
        rclpy.init(context=self.context, domain_id=domain_id)
        self._executor = OrderlyExecutor(8, context=self.context)
        self._nodes: list[Node] = []
        self._errors: list[Exception] = []
        self._removed = False
        self._stopping = threading.Event()
        self._thread = threading.Thread(target=self._spin)
        self._thread.start()

    def add(self, node: AnyNode) -> AnyNode:
        """Spins a node until the test ends."""
        self._nodes.append(node)
        self._executor.add_node(node)
        return node

    def remove(self, node: Node) -> None:
        """Destroys a node before the test ends; none of its callbacks may be running.

        What has arrived for it, and the executor holds already, is nobody's concern any more.
        """
        self._removed = True
        self._executor.remove_node(node)
        self._nodes.remove(node)
        node.destroy_node()

    @staticmethod
    def wait_until(
        condition: Callable[[], object], timeout: float = PATIENCE, what: str = ""
    ) -> None:
        """Returns as soon as a condition is true, fails the test if that takes longer [s]."""
        deadline = time.monotonic() + timeout
        while not condition():
            assert time.monotonic() < deadline, f"not within {timeout:g} s: {what or condition}"
            time.sleep(0.01)

    def close(self) -> None:
        self._stopping.set()
        self._thread.join()
        # Callbacks that still wait for something see that the context is gone.
        self.context.try_shutdown()
        self._executor.shutdown()
        for node in reversed(self._nodes):
            node.destroy_node()
        assert not self._errors, f"a callback raised: {self._errors}"

    def _spin(self) -> None:
        while not self._stopping.is_set():
            try:
                self._executor.spin_once(timeout_sec=0.05)
            except ExternalShutdownException:
                return
            except InvalidHandle as error:
                if not self._removed:
                    self._errors.append(error)
            except Exception as error:
                self._errors.append(error)


@pytest.fixture
def ros_context(domain_id: int) -> Iterator[RosContext]:
    """See :class:`RosContext`; the test fails if a callback of a node raises."""
    ros = RosContext(domain_id)
    try:
        yield ros
    finally:
        ros.close()


@pytest.fixture
def without_shared_memory(monkeypatch: pytest.MonkeyPatch) -> None:
    """DDS by UDP only: for processes that are stopped with SIGSTOP, at whatever they are doing.

    One stayed deaf when it went on, once in some fifty runs of the suite, and never in 200 stops
    that were made on purpose. A lock in shared memory that it held is suspected; what such a test
    is about is not the transport.
    """
    monkeypatch.setenv("FASTDDS_BUILTIN_TRANSPORTS", "UDPv4")


@pytest.fixture
def spawn(domain_id: int) -> Iterator[Spawn]:
    """Starts commands in the test's domain; what still runs when the test ends is killed."""
    del domain_id  # it is in the environment
    processes: list[Process] = []

    def run(*command: str, ignored: Collection[signal.Signals] = ()) -> Process:
        processes.append(start_process(*command, ignored=ignored))
        return processes[-1]

    yield run
    for process in processes:
        if process.poll() is None:
            process.kill()
            process.communicate(timeout=PATIENCE)


@pytest.fixture
def start(spawn: Spawn) -> Start:
    """Starts executables by ``ros2 run``, as :func:`spawn` starts commands."""
    return functools.partial(spawn, "ros2", "run")
