# SPDX-License-Identifier: Apache-2.0
"""The topics of one camera, and the errors of its sensor."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any, Final

from builtin_interfaces.msg import Time
from geometry_msgs.msg import TransformStamped
from rclpy.node import Node
from rclpy.publisher import Publisher
from sensor_msgs.msg import CameraInfo, Image
from tamp_runtime.qos import LATCHED, NEWEST, SENSOR_DATA

from .conversions import camera_messages, extrinsics_message
from .frame import Frame
from .scene import CameraConfig
from .sensor import Delivery, SensorConfig, is_lost, sense
from .sensor.config import OFF
from .sensor.sensor import DELIVERY, stage_random

#: In the order of :func:`~sim_node.conversions.camera_messages`: what is waited for comes first.
_TOPICS: Final = (
    ("camera_info", CameraInfo),
    ("image_raw", Image),
    ("depth/image_raw", Image),
    ("segmentation", Image),
    ("depth/camera_info", CameraInfo),
)
_SEGMENTATION: Final = "segmentation"


class CameraTopics:
    """The publishers of one camera, and what becomes of its pictures on the way to them.

    Args:
        node: it gets the publishers.
        sensor: what is wrong with the camera.
        camera: its topics begin with its name.
        number: of the camera in the scene; each has errors of its own.
    """

    def __init__(
        self, node: Node, sensor: SensorConfig, camera: CameraConfig, number: int = 0
    ) -> None:
        profile = NEWEST if sensor.delivery.reliable else SENSOR_DATA
        self._publishers = {
            topic: node.create_publisher(kind, f"{camera.name}/{topic}", profile)
            for topic, kind in _TOPICS
        }
        self._extrinsics = node.create_publisher(
            TransformStamped, f"{camera.name}/extrinsics", LATCHED
        )
        self._sensor, self._camera, self._number = sensor, camera, number
        self._delivery: Delivery[list[tuple[Publisher, Any]]] = Delivery()
        self.restart(0)

    def configure(self, sensor: SensorConfig) -> None:
        """Other errors from now on; the publishers stay as reliable as they are."""
        self._sensor = sensor

    def restart(self, seed: int) -> None:
        """Begins the errors anew for a scene of this seed; what is on its way gets lost."""
        self._seed, self._count = seed, 0
        self._delivery.clear()

    def move(self, camera: CameraConfig, stamp: Time) -> None:
        """Says that the camera is elsewhere from now on."""
        self._camera = camera
        self.publish_extrinsics(stamp)

    def publish_extrinsics(self, stamp: Time) -> TransformStamped:
        """Publishes where the camera is, and returns it."""
        transform = extrinsics_message(self._camera, stamp)
        self._extrinsics.publish(transform)
        return transform

    def take(self, render: Callable[[], Frame], stamp: Time, now: float) -> None:
        """Takes a picture, if anybody wants it, and sends it on its way.

        Args:
            render: what the camera sees, exactly.
            now: simulated time [s]; ``stamp`` is the same for subscribers.
        """
        # Pictures that nobody wants count, so that errors do not depend on who listens when.
        picture = (self._seed, self._number, self._count)
        self._count += 1
        if not any(topic.get_subscription_count() for topic in self._publishers.values()):
            return
        config, random = self._sensor.delivery, stage_random(self._sensor, picture, DELIVERY)
        if is_lost(config.lost_pictures, random):
            return
        frame = sense(render(), self._sensor, picture)
        messages = camera_messages(frame, self._camera, stamp, self._sensor.depth.encoding)
        sent = [
            (self._publishers[topic], message)
            for (topic, _), message in zip(_TOPICS, messages)
            if not is_lost(config.lost_messages, random)
            and not (topic == _SEGMENTATION and self._sensor.segmentation.kind == OFF)
        ]
        self._delivery.send(sent, now, config, random)
        self.deliver(now)

    def deliver(self, now: float) -> None:
        """Publishes what has come through by now, in simulated time [s]."""
        for messages in self._delivery.arrived(now):
            for publisher, message in messages:
                publisher.publish(message)
