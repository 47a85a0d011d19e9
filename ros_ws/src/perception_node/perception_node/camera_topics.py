# SPDX-License-Identifier: Apache-2.0
"""The topics of one camera, up to observations."""

from __future__ import annotations

import time
from collections.abc import Callable, Collection
from typing import Any, Final

import numpy as np
from geometry_msgs.msg import TransformStamped
from numpy.typing import NDArray
from sensor_msgs.msg import CameraInfo, Image
from tamp_runtime.messages.images import (
    ImageError,
    color_from_image,
    depth_from_image,
    labels_from_image,
)
from tamp_runtime.messages.stamps import nanoseconds
from tamp_runtime.qos import LATCHED, NEWEST
from tamp_runtime.stream_thread import StreamThread
from tamp_runtime.subscriptions import AdaptiveSubscription

from .calibration import Calibration, LensModel
from .continuity import FROZEN_COLORS, Continuity
from .conversions import frame_pose_from_message, lens_from_message
from .errors import BadImageError, with_topics_of
from .frame_pairing import FramePairing, StampedSet
from .observation import Observation
from .segment import RGB, RGBD, SEGMENTATION_TOPIC

#: What makes pixels of the images of a frame.
READERS: Final[dict[str, Callable[[Image], Any]]] = {
    "image": color_from_image,
    "depth": depth_from_image,
    "segmentation": labels_from_image,
}
#: The messages that make a frame; labels only where masks are given, depth where it is used.
TOPICS: Final = {
    "image": "image_raw",
    "depth": "depth/image_raw",
    "segmentation": "segmentation",
    "info": "camera_info",
}
#: Those of them that are not heard, by mask_source.
UNUSED: Final[dict[str, Collection[str]]] = {
    RGBD: ("segmentation",),
    SEGMENTATION_TOPIC: (),
    RGB: ("segmentation", "depth"),
}


class CameraTopics:
    """The subscriptions of one camera, and what is known of it.

    Attributes:
        name: its topics begin with it.
        calibration: where it is.
        lens: as of the newest frame; None before the first.
        continuity: of its pictures.
        last_image: when the newest message arrived [s].
        picture: the newest frame's colours, rectified if that could be done; None where they
            cannot be read.

    Args:
        thread: in which all of this runs, ``on_frame``, too; its node gets the subscriptions.
        name: see above.
        values: the node's parameters.
        on_frame: is called with each complete frame, the newest only.
    """

    def __init__(
        self,
        thread: StreamThread,
        name: str,
        values: dict[str, Any],
        on_frame: Callable[[CameraTopics, StampedSet], None],
    ) -> None:
        self.name = name
        self.calibration = Calibration(values["rectified"], values["world_frame"])
        self.continuity = Continuity()
        self.lens: LensModel | None = None
        self.last_image = 0.0
        self.picture: NDArray[np.uint8] | None = None
        self._incomplete_since: float | None = None
        unused = UNUSED[values["mask_source"]]
        self._topics = {
            stream: f"{name}/{topic}" for stream, topic in TOPICS.items() if stream not in unused
        }
        self._pairing = FramePairing(tuple(self._topics), round(1e9 * values["pairing_tolerance"]))
        self._on_frame = on_frame
        for stream, topic in self._topics.items():
            kind = Image if stream in READERS else CameraInfo
            AdaptiveSubscription(thread, kind, topic, self._receiver(stream), NEWEST)
        AdaptiveSubscription(
            thread, TransformStamped, f"{name}/extrinsics", self._on_extrinsics, LATCHED
        )

    def _on_extrinsics(self, message: TransformStamped) -> None:
        self.calibration.place(frame_pose_from_message(message))

    def _receiver(self, stream: str) -> Callable[[Any], None]:
        def receive(message: Any) -> None:
            self.last_image = time.perf_counter()
            frame = self._pairing.add(
                stream, nanoseconds(message.header.stamp), message, self.last_image
            )
            if frame is None:
                self._incomplete_since = self._incomplete_since or self.last_image
                return
            self._incomplete_since = None
            self._on_frame(self, frame)

        return receive

    def problem(self, now: float, silence: float) -> str:
        """A sentence where images arrive that never make a frame, once in a while.

        Args:
            now: on the clock of ``last_image`` [s].
            silence: for how long none came that does [s].
        """
        since = self._incomplete_since
        if since is None or now - since < silence or now - self.last_image > silence:
            return ""
        self._incomplete_since = now
        return self._pairing.problem(self._topics)

    def observation(self, frame: StampedSet) -> tuple[Observation, float]:
        """What a frame shows, and for how long its pictures have been the same to the last bit [s].

        Raises:
            BadImageError: if it cannot be used.
        """
        self.lens = lens_from_message(frame.messages["info"])
        self.picture = None
        rgb, depth, labels = (
            self._pixels(stream, frame.messages.get(stream))
            for stream in ("image", "depth", "segmentation")
        )
        self.picture = rgb
        try:
            view = self.calibration.view(self.lens, rgb.shape[1], rgb.shape[0])
            observation = view.observation(rgb, labels, depth)
        except BadImageError as error:
            raise BadImageError(with_topics_of(self.name, str(error))) from error
        self.picture = observation.rgb
        if seconds := self.continuity.frozen_colors(frame.stamp, rgb, depth):
            raise BadImageError(f"{self._topics['image']} {FROZEN_COLORS} ({seconds:.1f} s)")
        return observation, self.continuity.seconds_unchanged(frame.stamp, rgb, depth)

    def _pixels(self, stream: str, message: Image | None) -> Any:
        if message is None:
            return None
        try:
            return READERS[stream](message)
        except ImageError as error:
            raise BadImageError(f"{self._topics[stream]}: {error}") from error
