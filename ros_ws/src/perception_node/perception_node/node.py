# SPDX-License-Identifier: Apache-2.0
"""Perception as a ROS node; see :class:`PerceptionNode`."""

from __future__ import annotations

import time
import traceback
from collections.abc import Mapping
from dataclasses import replace
from pathlib import Path
from typing import Any, Final

import cv2
import torch
from rclpy.callback_groups import MutuallyExclusiveCallbackGroup
from rclpy.node import Node
from sensor_msgs.msg import Image
from std_msgs.msg import Header
from std_srvs.srv import Trigger
from tamp_interfaces.msg import SceneGraph as SceneGraphMsg
from tamp_interfaces.srv import ImageToSceneGraph
from tamp_runtime.large_messages import make_room_for_pictures
from tamp_runtime.machine_code import written_below
from tamp_runtime.memory import keep_freed_memory
from tamp_runtime.messages.images import (
    ImageError,
    color_from_image,
    image_from_array,
    labels_from_image,
)
from tamp_runtime.node_process import run_node
from tamp_runtime.parameters import declare_parameters
from tamp_runtime.presence import Presence
from tamp_runtime.qos import NEWEST, RELIABLE, SENSOR_DATA, STATUS
from tamp_runtime.stream_thread import StreamThread
from visualization_msgs.msg import MarkerArray

try:
    from tf2_msgs.msg import TFMessage
except ImportError:  # not among the PyPI packages
    TFMessage = None

from scene_graph import GraphStatus

from .alike import Alike
from .arm.topics import ArmTopics
from .camera_topics import CameraTopics
from .conversions import (
    frame_pose_from_message,
    markers_from_graph,
    perceived_to_message,
)
from .drawing import draw_scene_graph
from .errors import BadImageError, DatasetError
from .frame_pairing import StampedSet
from .joined_views import JoinedViews
from .moments import Moments
from .observation import Observation
from .parameters import FOUND, PARAMETERS, config_from_parameters
from .pipeline import Perceived, Perception
from .places_kept import PlacesKept
from .segment import RGB
from .segment.rgb import network
from .training.recording import Recorder
from .view_requests import ViewRequests
from .visual_module.weights import DEFAULT_WEIGHTS, load_weights

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
            newest complete frame is interpreted. Of more cameras, those of the parameter cameras,
            the same by their names; of each moment all are joined
        camera/extrinsics (geometry_msgs/TransformStamped), latched or sent again and again; these
            and the images are heard reliable or best effort, as they are published
        /tf_static (tf2_msgs/TFMessage), where there are such messages: leads to the camera's frame
            as long as there are no extrinsics
        robot_description (std_msgs/String, latched), joint_states (sensor_msgs/JointState): where a
            resting arm is to be seen in depth; a picture that surely contradicts it is refused. As
            long as one of them is missing, nothing is said
        diagnostics (diagnostic_msgs/DiagnosticArray): of the other nodes
    Publishes:
        scene_graph (tamp_interfaces/SceneGraph): one for each frame, its status says whether it can
            be planned on
        scene_graph/image (sensor_msgs/Image): the camera image with the graph drawn in, in the
            frame of the camera image
        scene_graph/markers (visualization_msgs/MarkerArray)
        NAME/view_request (geometry_msgs/PoseStamped), of the last of several cameras: where its
            optical frame would have to be for it to see what is hidden from all of them, if anybody
            listens, as one who moves that camera does
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
        self._alike = Alike()
        self._recorder = _recorder(self._values["record"])
        self._status: GraphStatus | None = None
        self._told = ""
        names = self._values["cameras"]
        self._joined = JoinedViews(self._kept.perception, names[0]) if names[1:] else None
        self._create_interfaces()
        self.get_logger().info(
            f"masks from {self._values['mask_source']}, weights {weights} "
            f"(backbone {module.backbone}), {self._kept}"
        )

    def _create_interfaces(self) -> None:
        self._graphs = self.create_publisher(SceneGraphMsg, "scene_graph", NEWEST)
        self._drawings = self.create_publisher(Image, "scene_graph/image", SENSOR_DATA)
        self._markers = self.create_publisher(MarkerArray, "scene_graph/markers", RELIABLE)
        # Pictures are interpreted as they come; what belongs to them is looked at in between.
        self._pictures = StreamThread(self, "pictures")
        others = MutuallyExclusiveCallbackGroup()
        tolerance = round(1e9 * self._values["pairing_tolerance"])
        self._moments = Moments(self._values["cameras"], tolerance, time.perf_counter())
        self._cameras = {
            name: CameraTopics(self._pictures, name, self._values, self._on_frame)
            for name in self._values["cameras"]
        }
        self._main = next(iter(self._cameras.values()))
        self._views = None
        if self._joined is not None:
            self._views = ViewRequests(self, self._values["cameras"][-1])
        by_depth = self._values["mask_source"] != RGB
        self._arm = ArmTopics(self, self._values["world_frame"]) if by_depth else None
        if TFMessage is not None:
            self.create_subscription(
                TFMessage, "/tf_static", self._on_frames, STATUS, callback_group=others
            )
        self.create_timer(0.5, self._on_timer, callback_group=others)
        self.create_service(Trigger, "find_places", self._on_find_places, callback_group=others)
        self.create_service(
            ImageToSceneGraph,
            "image_to_scene_graph",
            self._on_goal_image,
            callback_group=MutuallyExclusiveCallbackGroup(),
        )
        Presence(self, "perception_node")
        self._pictures.start()

    # Callbacks

    def _parameters_changed(self, values: dict[str, Any]) -> None:
        self._values = {**self._values, **values}
        self._kept.configure(config_from_parameters(self._values))
        if self._joined is not None:
            self._joined = self._joined.configured(self._kept.perception)

    def _on_frames(self, message: Any) -> None:
        poses = [frame_pose_from_message(transform) for transform in message.transforms]
        with self._pictures.between:
            for camera in self._cameras.values():
                camera.calibration.add_frames(poses)

    def _on_frame(self, camera: CameraTopics, frame: StampedSet) -> None:
        moment = self._moments.add(camera.name, frame, time.perf_counter())
        if moment is not None:
            self._interpret(moment)

    def _on_find_places(
        self, _request: Trigger.Request, response: Trigger.Response
    ) -> Trigger.Response:
        if self._kept.finds and time.perf_counter() - self._main.last_image > SILENCE:
            response.message = f"no picture came within {SILENCE:g} s; check the camera"
        else:
            with self._pictures.between:
                response.success, response.message = self._kept.find_anew()
        return response

    def _on_timer(self) -> None:
        """Says so when images arrive that never make a frame."""
        with self._pictures.between:
            self._say_what_is_missing(time.perf_counter())

    def _say_what_is_missing(self, now: float) -> None:
        told = [camera.problem(now, SILENCE) for camera in self._cameras.values()]
        sentence = "; ".join(filter(None, told)) or self._moments.problem(now)
        if not sentence:
            return
        header = Header(stamp=self.get_clock().now().to_msg(), frame_id=self._frame_id())
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
        lens, calibration = self._main.lens, self._main.calibration
        if lens is None or not calibration.placed:
            return Observation(rgb, labels)
        height, width = rgb.shape[:2]
        return calibration.view(lens, width, height).observation(rgb, labels, None)

    # Frames

    def _interpret(self, moment: Mapping[str, StampedSet]) -> None:
        main, frame = next((self._cameras[name], frame) for name, frame in moment.items())
        images = frame.messages["image"].header
        header = Header(stamp=images.stamp, frame_id=self._frame_id())
        try:
            perceived = self._perceive(moment)
        except BadImageError as error:
            perceived = self._kept.perception.rejected(GraphStatus.BAD_IMAGE, str(error))
        except Exception as error:  # a defect must neither stop the node nor go unseen
            self.get_logger().error(f"interpreting a frame failed:\n{traceback.format_exc()}")
            perceived = self._kept.perception.rejected(
                GraphStatus.BAD_IMAGE,
                f"internal error: {error!r}; please report the log of this node",
            )
        if note := self._moments.note():
            perceived = replace(
                perceived, message="; ".join(filter(None, (perceived.message, note)))
            )
        config = self._kept.perception.config
        asked = self._views is not None and self._views.ask(perceived.graph, config, header)
        self._publish(perceived, header, frame.arrival, asked)
        rgb = main.picture
        if rgb is not None and self.context.ok() and self._drawings.get_subscription_count():
            drawing = draw_scene_graph(rgb, perceived)
            # A picture is in the frame of the camera that took it, not in that of the poses.
            self._drawings.publish(image_from_array(drawing, "rgb8", images))

    def _perceive(self, moment: Mapping[str, StampedSet]) -> Perceived:
        """Interprets a moment in the light of those before it; see :class:`Continuity`.

        Raises:
            BadImageError: if no camera's frame can be used.
        """
        stamp = next(iter(moment.values())).stamp
        observations, unchanged, bad = {}, 0.0, []
        for name, frame in moment.items():
            try:
                camera = self._cameras[name]
                observation, seconds = camera.observation(frame)
                unchanged = max(unchanged, seconds)
                if self._arm is not None:
                    self._arm.check(camera, frame, observation)
                observations[name] = observation
            except BadImageError as error:
                bad.append(str(error))
        if not observations:
            raise BadImageError("; ".join(bad))
        main = next(iter(observations.values()))
        if self._views is not None:
            last = observations.get(self._views.camera)
            self._views.seen = None if last is None else last.camera
        if self._joined is None:
            perceived = self._kept.perceive(main)
        else:
            perceived = self._joined.perceive(observations)
        self._record(main, perceived)
        graph = perceived.graph
        for name, observation in observations.items():
            continuity = self._cameras[name].continuity
            if problem := continuity.calibration_problem(observation, graph, stamp):
                return self._kept.perception.rejected(GraphStatus.BAD_IMAGE, problem)
        perceived = self._alike.named(perceived, stamp)
        if perceived.status.sees_all:
            for name, observation in observations.items():
                self._cameras[name].continuity.understand(observation, graph, stamp)
        elif perceived.status is GraphStatus.OCCLUDED and unchanged >= FROZEN:
            hint = (
                f"; or look at the camera: its pictures of the last {unchanged:.0f} s are the same "
                "to the last bit"
            )
            perceived = replace(perceived, message=perceived.message + hint)
        return replace(perceived, message="; ".join(filter(None, (perceived.message, *bad))))

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
        self._pictures.stop()
        if self._arm is not None:
            self._arm.stop()
        if self._recorder is not None:
            try:
                self._recorder.flush()
            except DatasetError as error:
                self.get_logger().error(str(error))
        super().destroy_node()

    def _frame_id(self) -> str:
        return self._main.calibration.pose_frame

    def _publish(
        self, perceived: Perceived, header: Header, arrival: float, view_requested: bool = False
    ) -> None:
        if not self.context.ok():
            return  # the node is being stopped
        seconds = time.perf_counter() - arrival
        message = perceived_to_message(perceived, header, seconds)
        message.view_requested = view_requested
        self._graphs.publish(message)
        if perceived.status is not self._status or self._moments.note() != self._told:
            self._status, self._told = perceived.status, self._moments.note()
            # One call a severity: rclpy's logger refuses two from the same line.
            if perceived.status is GraphStatus.CONFIDENT and not self._told:
                self.get_logger().info("CONFIDENT: the scene is clear")
            else:
                self.get_logger().warning(f"{perceived.status.name}: {perceived.message}")
        if self._markers.get_subscription_count():
            self._markers.publish(markers_from_graph(perceived.graph, header))


def _recorder(folder: str) -> Recorder | None:
    return Recorder(Path(folder)) if folder else None


def run() -> int:
    """Runs the node until it is stopped; returns the process's exit code."""
    make_room_for_pictures()  # scene_graph/image, where somebody looks at it
    return run_node(PerceptionNode)
