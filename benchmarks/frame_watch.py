# SPDX-License-Identifier: Apache-2.0
"""When the pictures of a camera and the scene graphs made of them were published."""

from __future__ import annotations

import itertools
import struct
import threading
from dataclasses import dataclass, field
from typing import Any, Final

import rclpy
from sensor_msgs.msg import Image
from tamp_interfaces.msg import MotionStatus, SceneGraph
from tamp_runtime.messages.stamps import nanoseconds
from tamp_runtime.node_thread import NodeThread
from tamp_runtime.qos import RELIABLE, STATUS

#: Where the stamp is in a message whose first field is a header, as it is on the wire: behind four
#: bytes that say how the rest is written (XCDR1, little endian).
_STAMP: Final = struct.Struct("<4xiI")


@dataclass
class Frames:
    """What was published since when; times are those at which messages were written [ns].

    Attributes:
        pictures: by their stamps.
        graphs: time, status and the time that perception took [s], by the stamps of their pictures.
        moves: since when the arm carries out a plan, or does not, in order; from the beginning on.
    """

    pictures: dict[int, int] = field(default_factory=dict)
    graphs: dict[int, tuple[int, int, float]] = field(default_factory=dict)
    moves: list[tuple[int, bool]] = field(default_factory=lambda: [(0, False)])

    def to_json(self) -> dict[str, Any]:
        """Pictures in the order of their publication, each with its graph, if it has one.

        The last one is left out: its graph may be on its way. ``moving`` of a picture says whether
        the arm carried out a plan; ``seconds`` is wall time from its publication to that of the
        graph, ``node_seconds`` what the graph itself says; ``moving_seconds`` is for how long
        pictures came while the arm carried out plans.
        """
        frames, moving_seconds = [], 0.0
        pictures = sorted((written, stamp) for stamp, written in self.pictures.items())
        for (written, stamp), (following, _) in itertools.pairwise(pictures):
            moving = [executes for since, executes in self.moves if since <= written][-1]
            answered, status, own = self.graphs.get(stamp, (None, None, None))
            seconds = None if answered is None else (answered - written) / 1e9
            frames.append(
                {"moving": moving, "status": status, "seconds": seconds, "node_seconds": own}
            )
            moving_seconds += moving * (following - written) / 1e9
        return {"frames": frames, "moving_seconds": moving_seconds}


class FrameWatch:
    """Hears pictures without unpacking them, the graphs, and whether the arm moves.

    What counts is the time at which the publisher wrote a message, which comes with it: how busy
    this process is does not matter.
    """

    def __init__(self) -> None:
        self._node = rclpy.create_node("frame_watch")
        self._lock, self._frames = threading.Lock(), Frames()
        listen: Any = self._node.create_subscription
        listen(Image, "camera/image_raw", self._on_picture, RELIABLE, raw=True)
        listen(SceneGraph, "scene_graph", self._on_graph, RELIABLE)
        listen(MotionStatus, "motion_status", self._on_motion, STATUS)
        self._thread = NodeThread(self._node)

    def __enter__(self) -> FrameWatch:
        return self

    def __exit__(self, *_error: object) -> None:
        self._thread.stop()
        self._node.destroy_node()

    def clear(self) -> None:
        """Forgets what was published until now."""
        with self._lock:
            self._frames = Frames(moves=[(0, self._frames.moves[-1][1])])

    def to_json(self) -> dict[str, Any]:
        """What was published since it was cleared, see :meth:`Frames.to_json`."""
        with self._lock:
            return self._frames.to_json()

    def _on_picture(self, message: bytes, info: dict[str, Any]) -> None:
        seconds, rest = _STAMP.unpack_from(message)
        with self._lock:
            self._frames.pictures[1_000_000_000 * seconds + rest] = info["source_timestamp"]

    def _on_graph(self, message: SceneGraph, info: dict[str, Any]) -> None:
        graph = (info["source_timestamp"], message.status, message.processing_seconds)
        with self._lock:
            self._frames.graphs[nanoseconds(message.header.stamp)] = graph

    def _on_motion(self, message: MotionStatus, info: dict[str, Any]) -> None:
        executes = message.state == MotionStatus.EXECUTING
        with self._lock:
            self._frames.moves.append((info["source_timestamp"], executes))
