# SPDX-License-Identifier: Apache-2.0
"""Nodes that are spun by a thread of their own, for programs that have other things to do."""

from __future__ import annotations

import threading
from collections.abc import Callable
from concurrent.futures import Future
from typing import Final, TypeVar

from rclpy.executors import ExternalShutdownException, SingleThreadedExecutor
from rclpy.node import Node

from .orderly_executor import OrderlyExecutor

#: A callback that takes longer than this blocks the thread [s].
CALL_TIMEOUT: Final = 10.0

Result = TypeVar("Result")


class NodeThread:
    """Spins nodes of one context from now until :meth:`stop`."""

    def __init__(self, *nodes: Node, threads: int = 1) -> None:
        """``threads``: how many callbacks may run at once; the graph's nodes together want 8."""
        context = nodes[0].context
        self._executor = (
            SingleThreadedExecutor(context=context)
            if threads == 1
            else OrderlyExecutor(threads, context=context)
        )
        for node in nodes:
            self._executor.add_node(node)
        self._stopping = threading.Event()
        self._thread = threading.Thread(target=self._spin, name=nodes[0].get_name(), daemon=True)
        self._thread.start()

    def call(self, function: Callable[[], Result]) -> Result:
        """Runs a function in the node's thread, between callbacks, and returns what it returns.

        rclpy's action client needs that: an answer that another thread receives before
        ``send_goal_async`` has returned is thrown away.

        Raises:
            TimeoutError: the thread does not get to it; is the context shut down?
        """
        result: Future[Result] = Future()

        def run() -> None:
            try:
                result.set_result(function())
            except Exception as error:
                result.set_exception(error)

        self._executor.create_task(run)
        return result.result(CALL_TIMEOUT)

    def stop(self) -> None:
        """Stops spinning; no callback runs afterwards, and the nodes can be destroyed."""
        self._stopping.set()
        self._thread.join()
        self._executor.shutdown()

    def _spin(self) -> None:
        try:
            while not self._stopping.is_set():
                self._executor.spin_once(timeout_sec=0.05)
        except ExternalShutdownException:
            pass  # whoever waits gets its own time-out
