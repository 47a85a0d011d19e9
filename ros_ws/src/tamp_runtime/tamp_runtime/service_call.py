# SPDX-License-Identifier: Apache-2.0
"""Requests to services and actions of nodes that may be stopped and started at any time."""

from __future__ import annotations

import threading
import time
from collections.abc import Callable
from typing import Any, Final

from rclpy.task import Future

from .neighbour import Sightings

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
    sightings: Sightings | None = None,
    servers: Callable[[], int] = lambda: 1,
) -> Any:
    """The answer to a request, which is sent again if the node goes away before it answers.

    A node that stops may still be seen for a moment, and one that was killed for 20 s; a request it
    gets then is lost.

    Args:
        send: sends the request.
        is_ready, wait_for: of the client, such as ``service_is_ready`` and ``wait_for_service``.
        sightings: who of those that serve gives signs of life.
        servers: how many there are as far as DDS knows; for ``sightings``.

    Raises:
        TimeoutError: no answer within ``timeout`` [s].
    """
    deadline = time.monotonic() + timeout
    while (left := deadline - time.monotonic()) > 0.0 and wait_for(timeout_sec=left):
        if sightings and not sightings.are_found(servers()):
            time.sleep(min(left, POLL_SECONDS))
            continue
        asked = sightings.living() if sightings else frozenset()
        future = send()
        arrived = arrival(future)
        while not arrived.wait(POLL_SECONDS) and is_ready() and time.monotonic() < deadline:
            if sightings and sightings.are_gone(asked):
                break
        if arrived.is_set():
            return future.result()
        future.cancel()
    raise TimeoutError(f"no answer within {timeout:g} s")
