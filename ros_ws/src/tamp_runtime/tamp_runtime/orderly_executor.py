# SPDX-License-Identifier: Apache-2.0
"""An executor that leaves no callback behind, so that nodes can be destroyed after it."""

from __future__ import annotations

import threading
from concurrent.futures import ThreadPoolExecutor
from typing import Any, Final

from rclpy.context import Context
from rclpy.executors import (
    ConditionReachedException,
    Executor,
    ExternalShutdownException,
    ShutdownException,
    TimeoutException,
)

#: A callback has this long to end before the next one is looked for [s]. Most have ended by then,
#: and all that the node has is looked at once for each of them, instead of two or three times.
_HEAD_START: Final = 0.001


class OrderlyExecutor(Executor):
    """Runs callbacks in several threads, and its shutdown waits for those that run.

    Executor.shutdown of rclpy 7.1.6 promises that and does not do it, and the pool of its
    MultiThreadedExecutor is private. Here a callback is asked for only when a thread is free: none
    waits in a queue, to be thrown away unawaited when the executor stops.
    """

    def __init__(self, threads: int, *, context: Context | None = None) -> None:
        super().__init__(context=context)
        self._threads = ThreadPoolExecutor(threads, thread_name_prefix="callback")
        self._free = threading.Semaphore(threads)
        self._started: list[Any] = []  # rclpy's Task, a future of its own kind

    def spin_once(self, timeout_sec: float | None = None) -> None:
        """Starts the next callback that is ready, once a thread is free.

        Raises:
            Exception: what an earlier callback raised.
        """
        if not self._free.acquire(timeout=timeout_sec):
            return
        try:
            task, _, _ = self.wait_for_ready_callbacks(timeout_sec)
        except BaseException as reason:
            self._free.release()
            stopped = (ExternalShutdownException, ShutdownException)
            if isinstance(reason, (TimeoutException, ConditionReachedException, *stopped)):
                return
            raise
        self._started.append(task)
        ended = threading.Event()
        self._threads.submit(self._run, task, ended)
        ended.wait(_HEAD_START)
        for task in [task for task in self._started if task.done()]:
            self._started.remove(task)
            task.result()

    def shutdown(self, timeout_sec: float | None = None) -> bool:
        """Stops, and waits for the callbacks that run, however long; none runs afterwards.

        Must not be called while another thread is in :meth:`spin_once`. What a callback raises
        because ROS is gone under it, such as from a publisher, is nobody's concern any more.
        """
        self._threads.shutdown(wait=True)
        for task in self._started:
            task.exception()  # one that nobody has asked for is printed by rclpy
        self._started.clear()
        return super().shutdown(timeout_sec)

    def _run(self, task: Any, ended: threading.Event) -> None:
        try:
            task()
        finally:
            self._free.release()
            ended.set()
