# SPDX-License-Identifier: Apache-2.0
"""The simulator as a ROS node; see :class:`SimNode`."""

from __future__ import annotations

import queue
import threading
import time
import traceback
from collections.abc import Callable
from typing import Any

from geometry_msgs.msg import TransformStamped
from rclpy.callback_groups import ReentrantCallbackGroup
from rclpy.node import Node
from rosgraph_msgs.msg import Clock
from sensor_msgs.msg import CameraInfo, Image, JointState
from std_msgs.msg import Header, String
from tamp_interfaces.msg import SceneGraph
from tamp_interfaces.srv import ResetScene
from tamp_runtime.messages.scene_graph import graph_to_message
from tamp_runtime.messages.stamps import stamp_from_nanoseconds
from tamp_runtime.node_process import run_node
from tamp_runtime.parameters import declare_parameters
from tamp_runtime.qos import LATCHED, NEWEST, RELIABLE, SENSOR_DATA
from trajectory_msgs.msg import JointTrajectory

from scene_graph import format_stacks

from .controller import ArmController
from .conversions import (
    WORLD_FRAME,
    camera_messages,
    extrinsics_message,
    joint_state_message,
    trajectory_arrays,
)
from .ground_truth import true_scene_graph
from .layouts import LayoutError, format_layout, parse_layout, random_layout
from .parameters import PARAMETERS, first_layout
from .scene import SceneConfig
from .simulated_arms import SIMULATED_ARMS
from .trajectory import TrajectoryError
from .urdf import robot_description
from .world import World

#: Physics steps between two joint states (60 Hz) and joint states between two pictures (10 Hz).
STEPS_PER_STATE = 4
STATES_PER_FRAME = 6

_COMMAND_TIMEOUT = 30.0


class SimNode(Node):
    """A pybullet world with an arm, blocks and a camera.

    Publishes:
        camera/image_raw, camera/depth/image_raw, camera/segmentation (sensor_msgs/Image) and
            camera/camera_info (sensor_msgs/CameraInfo), at 10 Hz of simulated time
        camera/extrinsics (geometry_msgs/TransformStamped), latched
        joint_states (sensor_msgs/JointState) and clock (rosgraph_msgs/Clock), at 60 Hz
        robot_description (std_msgs/String), latched
        sim/ground_truth (tamp_interfaces/SceneGraph), latched: for evaluation and tests only
    Subscribes:
        joint_trajectory (trajectory_msgs/JointTrajectory): replaces the running one; a malformed
            one is refused with a logged reason; one without points stops the arm
    Services:
        sim/reset (tamp_interfaces/ResetScene)

    One thread of its own owns the physics; callbacks hand it their work through a queue.
    """

    def __init__(self, **kwargs: Any) -> None:
        super().__init__("sim_node", **kwargs)
        values = declare_parameters(self, PARAMETERS, self._parameters_changed)
        self._real_time_factor: float = values["real_time_factor"]
        self._config = SceneConfig()
        layout = first_layout(values, self._config.stack_count)
        self._create_interfaces()

        self._world = World(self._config, arm=SIMULATED_ARMS[values["robot"]])
        self._arm = ArmController(self._world)
        self._world.reset(layout, values["seed"])
        # The clock starts at the host's time, so that it goes on forward when the node restarts.
        self._start_nanoseconds = time.time_ns()
        self._publish_descriptions()
        self.get_logger().info(f"scene {format_stacks(layout)}")

        self._commands: queue.SimpleQueue[Callable[[], None]] = queue.SimpleQueue()
        self._stopping = threading.Event()
        self._thread = threading.Thread(target=self._run, name="physics", daemon=True)
        self._thread.start()

    def destroy_node(self) -> None:
        """Ends the physics thread, then the node."""
        self._stopping.set()
        self._thread.join(timeout=5.0)
        self._world.close()
        super().destroy_node()

    # Set-up

    def _create_interfaces(self) -> None:
        self._image = self.create_publisher(Image, "camera/image_raw", NEWEST)
        self._depth = self.create_publisher(Image, "camera/depth/image_raw", NEWEST)
        self._labels = self.create_publisher(Image, "camera/segmentation", NEWEST)
        self._info = self.create_publisher(CameraInfo, "camera/camera_info", NEWEST)
        self._extrinsics = self.create_publisher(TransformStamped, "camera/extrinsics", LATCHED)
        self._joint_states = self.create_publisher(JointState, "joint_states", SENSOR_DATA)
        self._clock_topic = self.create_publisher(Clock, "/clock", SENSOR_DATA)
        self._description = self.create_publisher(String, "robot_description", LATCHED)
        self._ground_truth = self.create_publisher(SceneGraph, "sim/ground_truth", LATCHED)
        group = ReentrantCallbackGroup()
        self.create_subscription(
            JointTrajectory, "joint_trajectory", self._on_trajectory, RELIABLE, callback_group=group
        )
        self.create_service(ResetScene, "sim/reset", self._on_reset, callback_group=group)

    def _publish_descriptions(self) -> None:
        extrinsics = extrinsics_message(self._config.camera, self._stamp())
        self._extrinsics.publish(extrinsics)
        self._description.publish(String(data=robot_description(self._world.arm)))
        try:
            from tf2_msgs.msg import TFMessage
        except ImportError:  # not among the PyPI packages
            return
        self._tf_static = self.create_publisher(TFMessage, "/tf_static", LATCHED)
        self._tf_static.publish(TFMessage(transforms=[extrinsics]))

    # Callbacks: they only hand work to the physics thread

    def _parameters_changed(self, values: dict[str, Any]) -> None:
        self._real_time_factor = values.get("real_time_factor", self._real_time_factor)

    def _on_trajectory(self, message: JointTrajectory) -> None:
        def command() -> None:
            try:
                if not message.points:
                    self._arm.stop()
                    return
                trajectory = self._arm.follow(message.joint_names, *trajectory_arrays(message))
                self.get_logger().info(
                    f"following a trajectory of {len(message.points)} points, "
                    f"{trajectory.duration:.1f} s"
                )
            except TrajectoryError as error:
                self.get_logger().error(f"joint_trajectory refused: {error}")

        self._commands.put(command)

    def _on_reset(
        self, request: ResetScene.Request, response: ResetScene.Response
    ) -> ResetScene.Response:
        done = threading.Event()

        def command() -> None:
            try:
                layout = (
                    parse_layout(request.layout, self._config.stack_count)
                    if request.layout
                    else random_layout(request.seed, request.blocks, self._config.stack_count)
                )
                self._world.reset(layout, request.seed)
                self._arm.reset()
                response.success = True
                response.message = f"the scene is {format_stacks(layout)}"
                response.layout = format_layout(layout)
            except LayoutError as error:
                response.message = f"{error}; the scene is unchanged"
            done.set()

        self._commands.put(command)
        if not done.wait(_COMMAND_TIMEOUT):
            response.message = "the simulator does not answer; its log may say why"
        return response

    # The physics thread

    def _run(self) -> None:
        try:
            count = 0
            wall, simulated = time.monotonic(), self._world.time
            while not self._stopping.is_set():
                while not self._commands.empty():
                    self._commands.get()()
                for _ in range(STEPS_PER_STATE):
                    self._arm.update()
                    self._world.step()
                self._publish_state()
                count += 1
                if count % STATES_PER_FRAME == 0:
                    self._publish_frame()
                if (factor := self._real_time_factor) == 0.0:
                    wall, simulated = time.monotonic(), self._world.time
                    continue
                ahead = (self._world.time - simulated) / factor - (time.monotonic() - wall)
                if ahead > 0.0:
                    self._stopping.wait(ahead)
                if abs(ahead) > 0.25:  # too slow a machine, or a changed factor: do not catch up
                    wall, simulated = time.monotonic(), self._world.time
        except Exception:
            if not self._stopping.is_set() and self.context.ok():
                self.get_logger().fatal(f"the physics stopped:\n{traceback.format_exc()}")

    def _stamp(self) -> Any:
        return stamp_from_nanoseconds(self._start_nanoseconds + round(self._world.time * 1e9))

    def _publish_state(self) -> None:
        stamp = self._stamp()
        self._clock_topic.publish(Clock(clock=stamp))
        self._joint_states.publish(
            joint_state_message(self._world.arm.joints, *self._world.joint_state(), stamp)
        )

    def _publish_frame(self) -> None:
        stamp = self._stamp()
        self._ground_truth.publish(
            graph_to_message(
                true_scene_graph(self._world), Header(stamp=stamp, frame_id=WORLD_FRAME)
            )
        )
        topics = (self._image, self._depth, self._labels, self._info)
        if not any(topic.get_subscription_count() for topic in topics):
            return
        messages = camera_messages(self._world.render(), self._config.camera, stamp)
        for topic, message in zip(topics, messages):
            topic.publish(message)


def run() -> int:
    """Runs the node until it is stopped; returns the process's exit code."""
    return run_node(SimNode)
