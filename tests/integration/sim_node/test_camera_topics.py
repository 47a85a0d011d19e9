# SPDX-License-Identifier: Apache-2.0
"""What a camera's topics publish, and when, by the simulated time at which they are asked to."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass, field
from typing import Any, cast

import numpy as np
import pytest
from builtin_interfaces.msg import Time
from rclpy.node import Node
from rclpy.qos import QoSProfile, ReliabilityPolicy
from tamp_runtime.messages.images import array_from_image
from tamp_runtime.messages.stamps import nanoseconds, stamp_from_nanoseconds

from sim_node import (
    CameraConfig,
    ColorConfig,
    DeliveryConfig,
    DepthConfig,
    Frame,
    SegmentationConfig,
    SensorConfig,
)
from sim_node.camera_topics import CameraTopics

CAMERA = CameraConfig(width=40, height=32)
NAMES = ("camera_info", "image_raw", "depth/image_raw", "segmentation", "depth/camera_info")
EXACT = SensorConfig()


def exact_frame() -> Frame:
    return Frame(
        np.full((32, 40, 3), 100, np.uint8),
        np.full((32, 40), 1.2344, np.float32),
        np.full((32, 40), 3, np.uint16),
    )


@dataclass
class Publications:
    """Stands for a node: keeps what its publishers are given, and when."""

    heard: bool = True
    now: float = 0.0
    rendered: int = 0
    profiles: dict[str, QoSProfile] = field(default_factory=dict)
    sent: list[tuple[float, str, Any]] = field(default_factory=list)

    def create_publisher(self, _kind: type, topic: str, profile: QoSProfile) -> Any:
        self.profiles[topic] = profile
        everything = self

        class Topic:
            def get_subscription_count(self) -> int:
                return int(everything.heard)

            def publish(self, message: Any) -> None:
                everything.sent.append((everything.now, topic, message))

        return Topic()

    def render(self) -> Frame:
        self.rendered += 1
        return exact_frame()

    def run(self, camera: CameraTopics, seconds: float) -> None:
        """Lets simulated time pass in turns of 1/60 s, with a picture every six of them."""
        for _ in range(round(60 * seconds)):
            camera.deliver(self.now)
            if round(60 * self.now) % 6 == 0:
                stamp = stamp_from_nanoseconds(round(1e9 * self.now))
                camera.take(self.render, stamp, self.now)
            self.now += 1 / 60

    def of(self, topic: str) -> list[tuple[float, Any]]:
        """Times of publication, and messages, of one of the camera's topics."""
        return [(time, message) for time, name, message in self.sent if name == f"camera/{topic}"]

    def pixels(self, topic: str, encoding: str) -> Iterator[np.ndarray]:
        return (array_from_image(message, encoding) for _, message in self.of(topic))


def camera_of(publications: Publications, sensor: SensorConfig) -> CameraTopics:
    return CameraTopics(cast(Node, publications), sensor, CAMERA)


def seconds(stamp: Time) -> float:
    return float(nanoseconds(stamp)) / 1e9


def test_by_default_pictures_are_exact_at_once_and_reliable() -> None:
    publications = Publications()
    publications.run(camera_of(publications, EXACT), 1.0)
    frame = exact_frame()
    expected = {
        "image_raw": frame.rgb,
        "depth/image_raw": frame.depth,
        "segmentation": frame.labels,
    }
    for (topic, pixels), encoding in zip(expected.items(), ("rgb8", "32FC1", "16UC1")):
        assert all((seen == pixels).all() for seen in publications.pixels(topic, encoding))
    for topic in NAMES:
        published = publications.of(topic)
        assert len(published) == 10
        assert all(time == pytest.approx(seconds(m.header.stamp)) for time, m in published)
        profile = publications.profiles[f"camera/{topic}"]
        assert profile.reliability == ReliabilityPolicy.RELIABLE


def test_a_delayed_picture_keeps_its_stamp_and_is_published_whole() -> None:
    publications = Publications()
    config = DeliveryConfig(delay=0.25, jitter=0.1, reliable=False)
    publications.run(camera_of(publications, SensorConfig(delivery=config)), 3.0)
    late = [time - seconds(message.header.stamp) for time, message in publications.of("image_raw")]
    assert len(late) >= 26
    assert min(late) > 0.25 - 1e-6 and max(late) < 0.35 + 1 / 60 + 1e-6
    assert np.ptp(late) > 0.05
    for topic in NAMES:
        assert [time for time, _ in publications.of(topic)] == [
            time for time, _ in publications.of("image_raw")
        ]
        profile = publications.profiles[f"camera/{topic}"]
        assert profile.reliability == ReliabilityPolicy.BEST_EFFORT


def test_lost_pictures_are_lost_whole_and_lost_messages_alone() -> None:
    whole, alone = Publications(), Publications()
    pictures = DeliveryConfig(lost_pictures=0.5)
    whole.run(camera_of(whole, SensorConfig(delivery=pictures)), 10.0)
    counts = [len(whole.of(topic)) for topic in NAMES]
    assert 30 < counts[0] < 70 and len(set(counts)) == 1
    assert whole.rendered == counts[0], "what is lost need not be drawn"
    messages = DeliveryConfig(lost_messages=0.5)
    alone.run(camera_of(alone, SensorConfig(delivery=messages)), 10.0)
    assert all(30 < len(alone.of(topic)) < 70 for topic in NAMES)
    stamps = {frozenset(seconds(m.header.stamp) for _, m in alone.of(topic)) for topic in NAMES}
    assert len(stamps) == len(NAMES)


def test_what_can_change_while_running_changes_with_the_next_picture() -> None:
    publications = Publications()
    camera = camera_of(publications, EXACT)
    publications.run(camera, 0.1)
    camera.configure(
        SensorConfig(
            depth=DepthConfig(encoding="16UC1"),
            color=ColorConfig(exposure=0.5),
            segmentation=SegmentationConfig("off"),
        )
    )
    publications.run(camera, 0.1)
    (_, metres), (_, millimetres) = publications.of("depth/image_raw")
    assert (metres.encoding, millimetres.encoding) == ("32FC1", "16UC1")
    assert (array_from_image(millimetres, "16UC1") == 1234).all()
    assert [pixels.mean() for pixels in publications.pixels("image_raw", "rgb8")] == [100.0, 50.0]
    assert len(publications.of("segmentation")) == 1
    assert len(publications.of("camera_info")) == 2


def noisy_pictures(
    publications: Publications, camera: CameraTopics, seed: int, unheard: float = 0.0
) -> list[bytes]:
    """What is published in a second after a reset, of which nobody listens for a while [s]."""
    camera.restart(seed)
    before = len(publications.of("image_raw"))
    publications.heard = False
    publications.run(camera, unheard)
    publications.heard = True
    publications.run(camera, 1.0 - unheard)
    return [bytes(message.data) for _, message in publications.of("image_raw")[before:]]


def test_a_reset_begins_the_errors_anew_whoever_listened() -> None:
    noise = SensorConfig(color=ColorConfig(noise=5.0), delivery=DeliveryConfig(lost_pictures=0.2))
    publications = Publications()
    camera = camera_of(publications, noise)
    first = noisy_pictures(publications, camera, seed=3)
    assert len(set(first)) == len(first) > 4
    assert noisy_pictures(publications, camera, seed=3) == first
    assert not set(noisy_pictures(publications, camera, seed=4)) & set(first)
    late = noisy_pictures(publications, camera, seed=3, unheard=0.5)
    assert 0 < len(late) < len(first) and late == first[-len(late) :]


def test_every_camera_has_errors_of_its_own() -> None:
    noise = SensorConfig(color=ColorConfig(noise=5.0))
    publications = Publications()
    left = noisy_pictures(publications, camera_of(publications, noise), seed=3)
    publications = Publications()
    second = CameraTopics(cast(Node, publications), noise, CAMERA, number=1)
    assert not set(noisy_pictures(publications, second, seed=3)) & set(left)


def test_what_is_on_its_way_gets_lost_in_a_reset() -> None:
    publications = Publications()
    camera = camera_of(publications, SensorConfig(delivery=DeliveryConfig(delay=0.5)))
    publications.run(camera, 0.4)
    camera.restart(0)
    reset = publications.now
    publications.run(camera, 1.0)
    stamps = [seconds(message.header.stamp) for _, message in publications.of("image_raw")]
    assert stamps and min(stamps) >= reset - 1e-6
