# SPDX-License-Identifier: Apache-2.0
"""Relays between nodes: each passes one topic on, or does something else to it for a while.

Messages stay serialised unless a mode looks into them, so that a relay of images costs little.
"""

from __future__ import annotations

import heapq
import itertools
import threading
import time
from collections.abc import Callable, Collection
from typing import Any, Protocol

from rclpy.node import Node
from rclpy.serialization import deserialize_message, serialize_message
from tamp_runtime.node_thread import NodeThread

from faults.topics import Topic

#: What is done with each message that arrives, serialised.
Handler = Callable[[bytes], None]


class Outlet(Protocol):
    """The far end of a relay, as a mode sees it."""

    @property
    def kind(self) -> Any:
        """The type of the messages."""

    @property
    def last(self) -> bytes | None:
        """The last message that arrived, whatever became of it."""

    def emit(self, message: bytes) -> None:
        """Sends a message on."""

    def emit_later(self, message: bytes, seconds: float) -> None:
        """Sends a message on after a while, unless the relay is cleared before."""


class Mode(Protocol):
    """What a relay does to its topic."""

    def begin(self, outlet: Outlet) -> Handler:
        """What is done from now on with each message."""


class Relay:
    """One topic, from its publisher to those who hear it under another name."""

    def __init__(self, node: Node, topic: Topic, later: Later) -> None:
        self.topic, self.kind = topic, topic.kind
        self.last: bytes | None = None
        self._node, self._later = node, later
        self._lock = threading.RLock()
        self._publisher = self._make_publisher()
        self._emitted = False
        self._handler: Handler = self.emit
        absolute = f"/{topic.name}" if topic.name == "clock" else topic.name
        node.create_subscription(topic.kind, absolute, self._receive, topic.qos, raw=True)

    def set(self, mode: Mode) -> None:
        """Changes what happens to messages from now on, and to a lasting one as well."""
        with self._lock:
            self._handler = mode.begin(self)
            if self.topic.lasting and self.last is not None:
                self._emitted = False
                self._handler(self.last)
                if not self._emitted:
                    self._forget()

    def clear(self) -> None:
        """Passes on from now on; a lasting message is sent once more."""
        with self._lock:
            if self._handler == self.emit:
                return
            self._later.forget(self)
            self._handler = self.emit
            if self.topic.lasting and self.last is not None:
                self.emit(self.last)

    def emit(self, message: bytes) -> None:
        """See :class:`Outlet`."""
        with self._lock:
            self._emitted = True
            self._publisher.publish(message)

    def emit_later(self, message: bytes, seconds: float) -> None:
        """See :class:`Outlet`."""
        self._later.add(self, message, seconds)

    def _receive(self, message: bytes) -> None:
        with self._lock:
            self.last = message
            self._handler(message)

    def _forget(self) -> None:
        """Late listeners shall not get what was sent before the fault."""
        self._node.destroy_publisher(self._publisher)
        self._publisher = self._make_publisher()

    def _make_publisher(self) -> Any:
        topic = self.topic
        absolute = "/" if topic.name == "clock" else ""
        return self._node.create_publisher(topic.kind, absolute + topic.relayed, topic.qos)


class Later:
    """Messages that are sent on after a while, in a thread of its own."""

    def __init__(self) -> None:
        self._changed = threading.Condition()
        self._waiting: list[tuple[float, int, Relay, bytes]] = []
        self._count = itertools.count()
        self._stopped = False
        self._thread = threading.Thread(target=self._run, name="later", daemon=True)
        self._thread.start()

    def add(self, relay: Relay, message: bytes, seconds: float) -> None:
        """Has a message sent on after ``seconds``."""
        with self._changed:
            due = time.monotonic() + seconds
            heapq.heappush(self._waiting, (due, next(self._count), relay, message))
            self._changed.notify()

    def forget(self, relay: Relay) -> None:
        """Drops what waits for a relay."""
        with self._changed:
            self._waiting = [item for item in self._waiting if item[2] is not relay]
            heapq.heapify(self._waiting)

    def stop(self) -> None:
        """Ends the thread."""
        with self._changed:
            self._stopped = True
            self._changed.notify()
        self._thread.join()

    def _run(self) -> None:
        while True:
            with self._changed:
                if self._stopped:
                    return
                now = time.monotonic()
                if not self._waiting or self._waiting[0][0] > now:
                    self._changed.wait(self._waiting[0][0] - now if self._waiting else None)
                    continue
                _, _, relay, message = heapq.heappop(self._waiting)
            relay.emit(message)


class Relays:
    """The relays of a graph, in a node of their own, as a context manager."""

    def __init__(self, topics: Collection[Topic], **node_arguments: Any) -> None:
        """``node_arguments`` go to the node, for example ``context``."""
        self._node = Node("fault_relays", **node_arguments)
        self._later = Later()
        self._relays = {topic.name: Relay(self._node, topic, self._later) for topic in topics}
        self._thread = NodeThread(self._node)

    def __enter__(self) -> Relays:
        return self

    def __exit__(self, *_error: object) -> None:
        self._later.stop()
        self._thread.stop()
        self._node.destroy_node()

    def __getitem__(self, topic: str) -> Relay:
        return self._relays[topic]

    def set(self, topic: str, mode: Mode) -> None:
        """Changes what happens to a topic, between two messages."""
        self._thread.call(lambda: self._relays[topic].set(mode))

    def clear(self) -> None:
        """Every relay passes on."""

        def clear() -> None:
            for relay in self._relays.values():
                relay.clear()

        self._thread.call(clear)


def read(outlet: Outlet, message: bytes) -> Any:
    """A serialised message as an object."""
    return deserialize_message(message, outlet.kind)


def write(message: Any) -> bytes:
    """The inverse of :func:`read`."""
    data: bytes = serialize_message(message)
    return data
