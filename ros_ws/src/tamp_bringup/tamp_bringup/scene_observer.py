# SPDX-License-Identifier: Apache-2.0
"""What evaluation may see and the nodes may not: ground truth; and it resets the scene."""

from __future__ import annotations

import threading
import time
from collections import deque
from collections.abc import Callable, Collection
from typing import Any, Final, NamedTuple

import rclpy
from sensor_msgs.msg import Image
from tamp_interfaces.msg import SceneGraph as SceneGraphMsg
from tamp_interfaces.srv import ResetScene
from tamp_runtime.messages.images import array_from_image
from tamp_runtime.messages.scene_graph import graph_from_message
from tamp_runtime.messages.stamps import seconds
from tamp_runtime.neighbour import Neighbour
from tamp_runtime.node_thread import NodeThread
from tamp_runtime.qos import LATCHED, NEWEST
from tamp_runtime.service_call import ask

from scene_graph import InconsistentRelationsError, SceneGraph, Stacks
from sim_node.layouts import format_layout

from .recording import Recording

#: How many of perception's times are kept: those of an hour at three graphs a second.
GRAPH_TIMES_KEPT: Final = 10_000


class SimulationError(RuntimeError):
    """The simulator does not answer, or refuses; the sentence says what to do."""


class GraphTime(NamedTuple):
    """How long one image took to become a scene graph, confident or not.

    Attributes:
        status: of the graph, as in its message.
        seconds: wall time from the image's arrival to the graph [s].
    """

    status: int
    seconds: float


class SceneObserver:
    """Watches the simulator's ground truth, the camera and perception from a thread of its own.

    Attributes:
        recording: receives the camera's images while it is set, with ``pictures``.
        graph_times: image → graph times of perception's newest graphs, whatever their status.
    """

    def __init__(self, pictures: bool = False, **node_arguments: Any) -> None:
        """Subscribes at once.

        Args:
            pictures: whether the camera's images are wanted.
            node_arguments: go to the node, for example ``namespace``.
        """
        self._node = rclpy.create_node("scene_observer", **node_arguments)
        self._truth: SceneGraphMsg | None = None
        self._truth_count = 0
        self._graph: SceneGraphMsg | None = None
        self._image: Image | None = None
        self.recording: Recording | None = None
        self.graph_times: deque[GraphTime] = deque(maxlen=GRAPH_TIMES_KEPT)
        self._news = threading.Condition()
        node = self._node
        node.create_subscription(SceneGraphMsg, "sim/ground_truth", self._on_truth, LATCHED)
        node.create_subscription(SceneGraphMsg, "scene_graph", self._on_graph, NEWEST)
        if pictures:
            node.create_subscription(Image, "camera/image_raw", self._on_image, NEWEST)
        self._simulator = Neighbour(node, "sim_node")
        self._reset = node.create_client(ResetScene, "sim/reset")
        self._thread = NodeThread(node)

    def __enter__(self) -> SceneObserver:
        return self

    def __exit__(self, *_error: object) -> None:
        self._thread.stop()
        self._node.destroy_node()

    def reset(
        self, seed: int = 0, blocks: int = 5, layout: Stacks | None = None, timeout: float = 30.0
    ) -> SceneGraph:
        """Puts the scene into a random or a given state and returns the ground truth then.

        Raises:
            SimulationError: if the simulator is not there or refuses.
        """
        request = ResetScene.Request(
            seed=seed, blocks=blocks, layout=format_layout(layout) if layout else []
        )
        client = self._reset
        try:
            response = ask(
                lambda: client.call_async(request),
                client.service_is_ready,
                client.wait_for_service,
                timeout,
                self._simulator,
                lambda: self._node.count_services(client.service_name),
            )
        except TimeoutError:
            raise SimulationError(
                f"sim_node did not reset the scene within {timeout:g} s; if it is not running, "
                "start it with: ros2 run sim_node sim_node"
            ) from None
        if not response.success:
            raise SimulationError(response.message)
        return self.fresh_truth(timeout)

    def fresh_truth(self, timeout: float = 10.0) -> SceneGraph:
        """The ground truth of now: the second one to arrive from here on.

        The first may have been on its way already.
        """
        with self._news:
            wanted = self._truth_count + 2
            self._wait(lambda: self._truth_count >= wanted, "sim_node", timeout)
            assert self._truth is not None
            return graph_from_message(self._truth)

    def confident_graph(self, timeout: float = 20.0) -> SceneGraphMsg:
        """A confident scene graph that perception publishes from now on."""

        def ready() -> bool:
            graph = self._graph
            return graph is not before and graph is not None and graph.status == graph.CONFIDENT

        with self._news:
            before = self._graph
            try:
                self._wait(ready, "perception_node", timeout)
            except SimulationError as error:
                seen = f"; it says: {self._graph.message}" if self._graph else ""
                raise SimulationError(f"{error}{seen}") from None
            assert self._graph is not None
            return self._graph

    def any_graph(self, timeout: float = 20.0) -> SceneGraphMsg:
        """A scene graph that perception publishes from now on, confident or not."""
        with self._news:
            before = self._graph
            self._wait(lambda: self._graph is not before, "perception_node", timeout)
            assert self._graph is not None
            return self._graph

    def wait_for_nodes(self, names: Collection[str], timeout: float = 20.0) -> None:
        """Returns when all of these nodes have been discovered; raises SimulationError."""
        deadline = time.monotonic() + timeout
        while missing := sorted(set(names) - set(self.node_names)):
            if time.monotonic() > deadline:
                raise SimulationError(f"{', '.join(missing)} did not start within {timeout:g} s")
            time.sleep(0.05)

    @property
    def node_names(self) -> list[str]:
        """The names of all nodes that have been discovered; one that is there twice is twice."""
        return list(self._node.get_node_names())

    @property
    def truth(self) -> SceneGraph | None:
        """The newest ground truth, or None before any has arrived."""
        message = self._truth
        return None if message is None else graph_from_message(message)

    @property
    def simulated_seconds(self) -> float:
        """Time of the newest ground truth since the simulator started [s]; 0 before any."""
        message = self._truth
        return 0.0 if message is None else seconds(message.header.stamp)

    def image(self) -> Any:
        """The newest camera image, (height, width, 3) uint8, or None; None without ``pictures``."""
        return None if self._image is None else array_from_image(self._image, "rgb8")

    def _wait(self, ready: Callable[[], bool], who: str, timeout: float) -> None:
        deadline = time.monotonic() + timeout
        while not ready():
            if not self._news.wait(max(0.0, deadline - time.monotonic())) and not ready():
                raise SimulationError(f"nothing usable arrived from {who} within {timeout:g} s")

    def _on_truth(self, message: SceneGraphMsg) -> None:
        with self._news:
            self._truth = message
            self._truth_count += 1
            self._news.notify_all()

    def _on_graph(self, message: SceneGraphMsg) -> None:
        with self._news:
            self._graph = message
            self.graph_times.append(GraphTime(message.status, message.processing_seconds))
            self._news.notify_all()

    def _on_image(self, message: Image) -> None:
        self._image = message
        if self.recording is not None:
            self.recording.add(array_from_image(message, "rgb8"), seconds(message.header.stamp))


def true_stacks(truth: SceneGraph) -> Stacks | None:
    """The true state, or None while some block stands on nothing."""
    try:
        stacks = truth.stacks()
    except InconsistentRelationsError:
        return None
    return stacks if sum(map(len, stacks)) == len(truth.objects) else None
