# SPDX-License-Identifier: Apache-2.0
"""Perception as a ROS node; see :class:`PerceptionNode`."""

from __future__ import annotations

import time
import traceback
from collections.abc import Callable
from dataclasses import replace
from pathlib import Path
from typing import Any, Final

import cv2
import torch
from geometry_msgs.msg import TransformStamped
from rclpy.callback_groups import MutuallyExclusiveCallbackGroup
from rclpy.node import Node
from sensor_msgs.msg import CameraInfo, Image
from std_msgs.msg import Header
from std_srvs.srv import Trigger
from tamp_interfaces.msg import SceneGraph
from tamp_interfaces.srv import ImageToSceneGraph
from tamp_runtime.machine_code import written_below
from tamp_runtime.memory import keep_freed_memory
from tamp_runtime.messages.images import (
    ImageError,
    color_from_image,
    depth_from_image,
    image_from_array,
    labels_from_image,
)
from tamp_runtime.messages.stamps import nanoseconds
from tamp_runtime.node_process import run_node
from tamp_runtime.parameters import declare_parameters
from tamp_runtime.presence import Presence
from tamp_runtime.qos import LATCHED, NEWEST, RELIABLE, SENSOR_DATA, STATUS
from tamp_runtime.subscriptions import AdaptiveSubscription
from visualization_msgs.msg import MarkerArray

try:
    from tf2_msgs.msg import TFMessage
except ImportError:  # not among the PyPI packages
    TFMessage = None

from scene_graph import GraphStatus

from .alike import Alike
from .calibration import Calibration, LensModel
from .continuity import Continuity
from .conversions import (
    frame_pose_from_message,
    lens_from_message,
    markers_from_graph,
    perceived_to_message,
)
from .drawing import draw_scene_graph
from .errors import BadImageError, DatasetError
from .frame_pairing import FramePairing, StampedSet
from .observation import Observation
from .parameters import FOUND, PARAMETERS, config_from_parameters
from .pipeline import Perceived, Perception
from .places_kept import PlacesKept
from .segment import RGB, RGBD, SEGMENTATION_TOPIC
from .segment.rgb import network
from .training.recording import Recorder
from .visual_module.weights import DEFAULT_WEIGHTS, load_weights

#: What makes pixels of the images of a frame.
READERS: Final[dict[str, Callable[[Image], Any]]] = {
    "image": color_from_image,
    "depth": depth_from_image,
    "segmentation": labels_from_image,
}
#: The messages that make a frame; labels only where masks are given, depth where it is used.
TOPICS: Final = {
    "image": "camera/image_raw",
    "depth": "camera/depth/image_raw",
    "segmentation": "camera/segmentation",
    "info": "camera/camera_info",
}
#: Those of them that are not heard, by mask_source.
UNUSED: Final = {
    RGBD: ("segmentation",),
    SEGMENTATION_TOPIC: (),
    RGB: ("segmentation", "depth"),
}
#: After this long without a complete frame, though images arrive, the reason is published [s].
SILENCE: Final = 2.0
#: Pictures that have been the same for so long may be an old one, sent again and again [s].
FROZEN: Final = 2.0


class PerceptionNode(Node):
    """From camera images to scene graphs.

    Subscribes:
        camera/image_raw, camera/depth/image_raw (sensor_msgs/Image), camera/camera_info
            (sensor_msgs/CameraInfo) and, where the parameter mask_source says so,
            camera/segmentation (sensor_msgs/Image), or no depth: paired by their stamps; only the
            newest complete frame is interpreted
        camera/extrinsics (geometry_msgs/TransformStamped), latched or sent again and again; these
            and the images are heard reliable or best effort, as they are published
        /tf_static (tf2_msgs/TFMessage), where there are such messages: leads to the camera's frame
            as long as there are no extrinsics
        diagnostics (diagnostic_msgs/DiagnosticArray): of the other nodes
    Publishes:
        scene_graph (tamp_interfaces/SceneGraph): one for each frame, its status says whether it can
            be planned on
        scene_graph/image (sensor_msgs/Image): the camera image with the graph drawn in, in the
            frame of the camera image
        scene_graph/markers (visualization_msgs/MarkerArray)
        diagnostics (diagnostic_msgs/DiagnosticArray): that it lives; a second one is noticed
    Services:
        image_to_scene_graph (tamp_interfaces/ImageToSceneGraph): interprets a goal image
        find_places (std_srvs/Trigger): finds the places anew in the newest picture, where the
            parameter places is found; where that fails they stay as they are. Not while a task runs
    """

    def __init__(self, **kwargs: Any) -> None:
        """Raises ValueError (PerceptionError) if a parameter, the weights file or the folder to
        record to cannot be used."""
        super().__init__("perception_node", **kwargs)
        self._values = declare_parameters(self, PARAMETERS, self._parameters_changed)
        keep_freed_memory()
        torch.set_num_threads(self._values["threads"])
        cv2.setNumThreads(self._values["threads"])  # who waits for a thread waits for its core
        written_below(Path(__file__).parent)  # now, not at the first picture
        weights = Path(self._values["weights"] or DEFAULT_WEIGHTS)
        module = load_weights(weights)
        self._kept = PlacesKept(
            Perception(module, config_from_parameters(self._values)),
            self._values["places"] == FOUND,
            self.get_logger().info,
        )
        if self._values["mask_source"] == RGB:
            network()  # raises if its weights cannot be read: now, not at the first picture
        unused = UNUSED[self._values["mask_source"]]
        self._topics = {name: topic for name, topic in TOPICS.items() if name not in unused}
        tolerance = round(1e9 * self._values["pairing_tolerance"])
        self._pairing = FramePairing(tuple(self._topics), tolerance)
        self._lens: LensModel | None = None
        self._calibration = Calibration(self._values["rectified"], self._values["world_frame"])
        self._continuity = Continuity()
        self._alike = Alike()
        self._recorder = _recorder(self._values["record"])
        self._status: GraphStatus | None = None
        self._last_image = 0.0
        self._incomplete_since: float | None = None
        self._create_interfaces()
        self.get_logger().info(
            f"masks from {self._values['mask_source']}, weights {weights} "
            f"(backbone {module.backbone}), {self._kept}"
        )

    def _create_interfaces(self) -> None:
        self._graphs = self.create_publisher(SceneGraph, "scene_graph", NEWEST)
        self._drawings = self.create_publisher(Image, "scene_graph/image", SENSOR_DATA)
        self._markers = self.create_publisher(MarkerArray, "scene_graph/markers", RELIABLE)
        frames = MutuallyExclusiveCallbackGroup()
        for stream, topic in self._topics.items():
            kind = Image if stream in READERS else CameraInfo
            AdaptiveSubscription(self, kind, topic, self._receiver(stream), NEWEST, frames)
        AdaptiveSubscription(
            self,
            TransformStamped,
            "camera/extrinsics",
            self._on_extrinsics,
            LATCHED,
            frames,
        )
        if TFMessage is not None:
            self.create_subscription(
                TFMessage, "/tf_static", self._on_frames, STATUS, callback_group=frames
            )
        self.create_timer(0.5, self._on_timer, callback_group=frames)
        self.create_service(Trigger, "find_places", self._on_find_places, callback_group=frames)
        self.create_service(
            ImageToSceneGraph,
            "image_to_scene_graph",
            self._on_goal_image,
            callback_group=MutuallyExclusiveCallbackGroup(),
        )
        Presence(self, "perception_node")

    # Callbacks

    def _parameters_changed(self, values: dict[str, Any]) -> None:
        self._values = {**self._values, **values}
        self._kept.configure(config_from_parameters(self._values))

    def _on_extrinsics(self, message: TransformStamped) -> None:
        self._calibration.place(frame_pose_from_message(message))

    def _on_frames(self, message: Any) -> None:
        self._calibration.add_frames(map(frame_pose_from_message, message.transforms))

    def _receiver(self, stream: str) -> Callable[[Any], None]:
        def receive(message: Any) -> None:
            self._last_image = time.perf_counter()
            frame = self._pairing.add(
                stream, nanoseconds(message.header.stamp), message, self._last_image
            )
            if frame is None:
                self._incomplete_since = self._incomplete_since or self._last_image
                return
            self._incomplete_since = None
            self._interpret(frame)

        return receive

    def _on_find_places(
        self, _request: Trigger.Request, response: Trigger.Response
    ) -> Trigger.Response:
        if self._kept.finds and time.perf_counter() - self._last_image > SILENCE:
            response.message = f"no picture came within {SILENCE:g} s; check the camera"
        else:
            response.success, response.message = self._kept.find_anew()
        return response

    def _on_timer(self) -> None:
        """Says so when images arrive that never make a frame."""
        now = time.perf_counter()
        since = self._incomplete_since
        if since is None or now - since < SILENCE or now - self._last_image > SILENCE:
            return
        self._incomplete_since = now
        header = Header(stamp=self.get_clock().now().to_msg(), frame_id=self._frame_id())
        sentence = self._pairing.problem(self._topics)
        self._publish(self._kept.perception.rejected(GraphStatus.BAD_IMAGE, sentence), header, now)

    def _on_goal_image(
        self, request: ImageToSceneGraph.Request, response: ImageToSceneGraph.Response
    ) -> ImageToSceneGraph.Response:
        start = time.perf_counter()
        header = Header(stamp=request.image.header.stamp, frame_id=self._frame_id())
        try:
            rgb = color_from_image(request.image)
            labels = labels_from_image(request.segmentation)
            perceived = self._kept.perception.perceive(self._goal_observation(rgb, labels))
        except (ImageError, BadImageError) as error:
            perceived = self._kept.perception.rejected(GraphStatus.BAD_IMAGE, str(error))
        response.scene_graph = perceived_to_message(perceived, header, time.perf_counter() - start)
        return response

    def _goal_observation(self, rgb: Any, labels: Any) -> Observation:
        """As the camera would have taken it, if it is known yet."""
        if self._lens is None or not self._calibration.placed:
            return Observation(rgb, labels)
        height, width = rgb.shape[:2]
        return self._calibration.view(self._lens, width, height).observation(rgb, labels, None)

    # Frames

    def _interpret(self, frame: StampedSet) -> None:
        messages = frame.messages
        self._lens = lens_from_message(messages["info"])
        header = Header(stamp=messages["image"].header.stamp, frame_id=self._frame_id())
        rgb = None
        try:
            rgb, depth, labels = (
                self._pixels(stream, messages.get(stream))
                for stream in ("image", "depth", "segmentation")
            )
            view = self._calibration.view(self._lens, rgb.shape[1], rgb.shape[0])
            observation = view.observation(rgb, labels, depth)
            unchanged = self._continuity.seconds_unchanged(frame.stamp, rgb, depth)
            rgb = observation.rgb
            perceived = self._perceive(observation, frame.stamp, unchanged)
        except (ImageError, BadImageError) as error:
            perceived = self._kept.perception.rejected(GraphStatus.BAD_IMAGE, str(error))
        except Exception as error:  # a defect must neither stop the node nor go unseen
            self.get_logger().error(f"interpreting a frame failed:\n{traceback.format_exc()}")
            perceived = self._kept.perception.rejected(
                GraphStatus.BAD_IMAGE,
                f"internal error: {error!r}; please report the log of this node",
            )
        self._publish(perceived, header, frame.arrival)
        if rgb is not None and self.context.ok() and self._drawings.get_subscription_count():
            drawing = draw_scene_graph(rgb, perceived)
            # A picture is in the frame of the camera that took it, not in that of the poses.
            self._drawings.publish(image_from_array(drawing, "rgb8", messages["image"].header))

    def _perceive(self, observation: Observation, stamp: int, unchanged: float) -> Perceived:
        """Interprets an observation in the light of those before it; see :class:`Continuity`."""
        perceived = self._kept.perceive(observation)
        self._record(observation, perceived)
        graph = perceived.graph
        if problem := self._continuity.calibration_problem(observation, graph, stamp):
            return self._kept.perception.rejected(GraphStatus.BAD_IMAGE, problem)
        perceived = self._alike.named(perceived, stamp)
        if perceived.status.sees_all:
            self._continuity.understand(observation, graph, stamp)
        elif perceived.status is GraphStatus.OCCLUDED and unchanged >= FROZEN:
            hint = (
                f"; or look at the camera: its pictures of the last {unchanged:.0f} s are the same "
                "to the last bit"
            )
            perceived = replace(perceived, message=perceived.message + hint)
        return perceived

    def _record(self, observation: Observation, perceived: Perceived) -> None:
        if self._recorder is None:
            return
        try:
            if self._recorder.take(observation, perceived.segments):
                self.get_logger().info(f"{self._recorder.kept} pictures kept")
        except DatasetError as error:
            self.get_logger().error(f"{error}; no more pictures are kept")
            self._recorder = None

    def destroy_node(self) -> None:
        """Writes the pictures that are kept and not written yet."""
        if self._recorder is not None:
            try:
                self._recorder.flush()
            except DatasetError as error:
                self.get_logger().error(str(error))
        super().destroy_node()

    def _pixels(self, stream: str, message: Image | None) -> Any:
        if message is None:
            return None
        try:
            return READERS[stream](message)
        except ImageError as error:
            raise BadImageError(f"{TOPICS[stream]}: {error}") from error

    def _frame_id(self) -> str:
        return self._calibration.pose_frame

    def _publish(self, perceived: Perceived, header: Header, arrival: float) -> None:
        if not self.context.ok():
            return  # the node is being stopped
        seconds = time.perf_counter() - arrival
        self._graphs.publish(perceived_to_message(perceived, header, seconds))
        if perceived.status is not self._status:
            self._status = perceived.status
            # One call a severity: rclpy's logger refuses two from the same line.
            if perceived.status is GraphStatus.CONFIDENT:
                self.get_logger().info("CONFIDENT: the scene is clear")
            else:
                self.get_logger().warning(f"{perceived.status.name}: {perceived.message}")
        if self._markers.get_subscription_count():
            self._markers.publish(markers_from_graph(perceived.graph, header))


def _recorder(folder: str) -> Recorder | None:
    return Recorder(Path(folder)) if folder else None


def run() -> int:
    """Runs the node until it is stopped; returns the process's exit code."""
    return run_node(PerceptionNode)
