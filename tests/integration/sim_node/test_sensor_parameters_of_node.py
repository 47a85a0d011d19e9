# SPDX-License-Identifier: Apache-2.0
"""A simulator whose camera is best effort, late and in millimetres delivers what it says."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

import numpy as np
import pytest
from rclpy.node import Node
from rclpy.parameter import Parameter
from rclpy.qos import ReliabilityPolicy
from sensor_msgs.msg import Image
from tamp_interfaces.srv import ResetScene
from tamp_runtime.messages.images import array_from_image
from tamp_runtime.messages.stamps import nanoseconds
from tamp_runtime.qos import SENSOR_DATA

from sim_node import World
from sim_node.node import SimNode

LAYOUT = ["red_box,blue_box", "", "green_box"]
DELAY = 0.25
TOPICS = ("camera/image_raw", "camera/depth/image_raw", "camera/segmentation")
PARAMETERS: Mapping[str, Any] = {
    "layout": LAYOUT,
    "real_time_factor": 1.0,
    "sensor.delivery.reliability": "best_effort",
    "sensor.delivery.delay": DELAY,
    "sensor.depth.encoding": "16UC1",
    "sensor.depth.noise": 0.002,
    "sensor.segmentation.kind": "missing",
}


class Listener(Node):
    """Keeps pictures by topic and stamp, and how late they were in simulated time [ns]."""

    def __init__(self, sim: SimNode, **kwargs: Any) -> None:
        super().__init__("listener", **kwargs)
        self.pictures: dict[str, dict[int, Image]] = {topic: {} for topic in TOPICS}
        self.late: list[int] = []
        self._sim = sim
        for topic in TOPICS:
            self.create_subscription(Image, topic, self._keeper(topic), SENSOR_DATA)
        self.reset = self.create_client(ResetScene, "sim/reset")

    def _keeper(self, topic: str) -> Any:
        def keep(message: Image) -> None:
            stamp = nanoseconds(message.header.stamp)
            self.late.append(nanoseconds(self._sim._stamp()) - stamp)
            self.pictures[topic][stamp] = message

        return keep

    def common(self) -> list[int]:
        """Stamps of which every picture has come."""
        return sorted(set.intersection(*(set(self.pictures[topic]) for topic in TOPICS)))


@pytest.fixture
def sim(ros_context: Any) -> SimNode:
    overrides = [Parameter(name, value=value) for name, value in PARAMETERS.items()]
    return ros_context.add(SimNode(context=ros_context.context, parameter_overrides=overrides))


@pytest.fixture
def listener(ros_context: Any, sim: SimNode) -> Listener:
    return ros_context.add(Listener(sim, context=ros_context.context))


def test_it_delivers_what_it_says(ros_context: Any, listener: Listener) -> None:
    ros_context.wait_until(lambda: len(listener.common()) >= 3, what="three whole pictures")
    assert min(listener.late) >= (DELAY - 1e-6) * 1e9
    for topic in TOPICS:
        (info,) = listener.get_publishers_info_by_topic(topic)
        assert info.qos_profile.reliability == ReliabilityPolicy.BEST_EFFORT
    with World() as world:
        world.reset((("red_box", "blue_box"), (), ("green_box",)), 0)
        exact = world.render()
    blocks = exact.labels > 0
    for stamp in listener.common():
        _, depth, labels = (listener.pictures[topic][stamp] for topic in TOPICS)
        errors = array_from_image(depth, "16UC1")[blocks] / 1000.0 - exact.depth[blocks]
        sigma = 0.002 * float(np.mean(exact.depth[blocks] ** 2))
        assert errors.std() == pytest.approx(sigma, rel=0.2)
        assert np.abs(errors).max() < 7.0 * sigma
        seen = array_from_image(labels, "16UC1")
        assert len(np.unique(seen)) == 1 + 2, "one of three blocks is missing"
        assert (seen[seen > 0] == exact.labels[seen > 0]).all()


def test_the_same_reset_gives_the_same_pictures(ros_context: Any, listener: Listener) -> None:
    def after_reset() -> dict[int, tuple[bytes, ...]]:
        assert listener.reset.wait_for_service(timeout_sec=10.0)
        future = listener.reset.call_async(ResetScene.Request(seed=3, blocks=5))
        ros_context.wait_until(future.done, what="sim/reset")
        start = nanoseconds(future.result().stamp)
        ros_context.wait_until(
            lambda: sum(stamp > start for stamp in listener.common()) >= 8, what="8 pictures"
        )
        return {
            stamp - start: tuple(bytes(listener.pictures[topic][stamp].data) for topic in TOPICS)
            for stamp in listener.common()
            if stamp > start
        }

    first = after_reset()
    pairs: list[tuple[Any, Any]] = []
    # Best effort: on a busy machine some are lost, each time others.
    for _ in range(20):
        second = after_reset()
        pairs += [
            (first[time], second[other])
            for time in first
            for other in second
            if abs(time - other) < 1000  # times are rounded to nanoseconds
        ]
        if len(pairs) >= 3:
            break
    assert len(pairs) >= 3
    assert all(one == other for one, other in pairs)
    assert len({pictures[1] for pictures in first.values()}) == len(first), "noise that repeats"


def test_errors_change_while_it_runs_and_what_is_impossible_is_refused(
    ros_context: Any, sim: SimNode, listener: Listener
) -> None:
    ros_context.wait_until(lambda: len(listener.common()) >= 1, what="a whole picture")
    refused = {
        "sensor.depth.noise": (-1.0, "sensor.depth.noise out of range"),
        "sensor.segmentation.kind": ("blurred", "none of: exact, off, eroded"),
        "sensor.color.cast": ([1.0], "it needs those of red, green and blue"),
        "sensor.delivery.reliability": ("reliable", "read-only"),
    }
    for name, (value, sentence) in refused.items():
        (result,) = sim.set_parameters([Parameter(name, value=value)])
        assert not result.successful and sentence in result.reason
    changed = {"sensor.depth.encoding": "32FC1", "sensor.segmentation.kind": "exact"}
    for name, value in changed.items():
        assert sim.set_parameters([Parameter(name, value=value)])[0].successful

    def newest(topic: str) -> Image:
        return listener.pictures[topic][max(listener.pictures[topic])]

    ros_context.wait_until(lambda: newest("camera/depth/image_raw").encoding == "32FC1")
    ros_context.wait_until(
        lambda: len(np.unique(array_from_image(newest("camera/segmentation"), "16UC1"))) == 1 + 3,
        what="every block",
    )


def test_a_bad_value_at_start_is_a_sentence(ros_context: Any) -> None:
    bad = [Parameter("sensor.depth.encoding", value="mono16")]
    with pytest.raises(ValueError, match="'mono16' is none of: 32FC1, 16UC1"):
        SimNode(context=ros_context.context, parameter_overrides=bad)
