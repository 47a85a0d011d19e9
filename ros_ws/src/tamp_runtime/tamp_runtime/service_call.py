# SPDX-License-Identifier: Apache-2.0
"""Requests to services and actions of nodes that may be stopped and started at any time."""

from __future__ import annotations

import threading
import time
from collections.abc import Callable
from typing import Any, Final

from rclpy.task import Future

#: How often to look whether a node is still there while it has not answered [s].
POLL_SECONDS: Final = 0.1


def arrival(future: Future) -> threading.Event:
    """Set as soon as a future is done; for threads that do not spin."""
    arrived = threading.Event()
    future.add_done_callback(lambda _future: arrived.set())
    return arrived


def ask(
    send: Callable[[], Future],
    is_ready: Callable[[], bool],
    wait_for: Callable[..., bool],
    timeout: float,
) -> Any:
    """The answer to a request, which is sent again if the node goes away before it answers.

    A node that stops may still be seen for a moment; a request it gets then is lost.

    Args:
        send: sends the request.
        is_ready, wait_for: of the client, such as ``service_is_ready`` and ``wait_for_service``.

    Raises:
        TimeoutError: no answer within ``timeout`` [s].
    """
    deadline = time.monotonic() + timeout
    while (left := deadline - time.monotonic()) > 0.0 and wait_for(timeout_sec=left):
        future = send()
        arrived = arrival(future)
        while not arrived.wait(POLL_SECONDS) and is_ready() and time.monotonic() < deadline:
            pass
        if arrived.is_set():
            return future.result()
        future.cancel()
    raise TimeoutError(f"no answer within {timeout:g} s")
