# SPDX-License-Identifier: Apache-2.0
"""The simulator as a ROS node; see :class:`SimNode`."""

from __future__ import annotations

import time
import traceback
from collections.abc import Callable
from functools import partial
from typing import Any, Final

import rclpy
from builtin_interfaces.msg import Time
from geometry_msgs.msg import PoseStamped
from rclpy.callback_groups import MutuallyExclusiveCallbackGroup
from rclpy.node import Node
from tamp_interfaces.srv import Disturb, ResetScene
from tamp_runtime.large_messages import make_room_for_pictures
from tamp_runtime.messages.stamps import nanoseconds, stamp_from_nanoseconds
from tamp_runtime.node_process import run_node
from tamp_runtime.parameters import declare_parameters
from tamp_runtime.presence import Presence
from tamp_runtime.qos import NEWEST

from scene_graph import Stacks, format_stacks

from .controller import ArmController, CommandsMotors
from .conversions import sight_from_message
from .disturbance.conversions import request_from_message
from .disturbance.disturber import Disturber
from .disturbance.request import DisturbanceError
from .generators import requested_layout
from .ground_truth import standing_blocks, true_scene_graph
from .layouts import LayoutError, format_layout
from .pacing import Pacer
from .parameters import PARAMETERS, first_layout
from .physics_thread import PhysicsError, PhysicsThread
from .scene import SceneError, load_scene
from .scene.cameras import Vector
from .sensor.parameters import sensor_from_parameters
from .simulated_arms import SIMULATED_ARMS
from .stock_controller import TwoControllers
from .topics import SimTopics
from .trajectory_topics import TrajectoryTopics
from .world import World

#: Physics steps between two joint states (60 Hz) and joint states between two pictures (10 Hz).
STEPS_PER_STATE = 4
STATES_PER_FRAME = 6

#: The exit code of a process whose physics failed; the log has the traceback.
EXIT_PHYSICS_FAILED: Final = 3

#: Between the end of the physics and that of the process: answers leave meanwhile [s].
_FAREWELL_SECONDS: Final = 0.5


class SimNode(Node):
    """A pybullet world with an arm, blocks and cameras, as the parameter ``scene`` says.

    Publishes:
        camera/image_raw, camera/depth/image_raw, camera/segmentation (sensor_msgs/Image),
            camera/camera_info and camera/depth/camera_info (sensor_msgs/CameraInfo), at 10 Hz of
            simulated time; the depth is registered, so both infos are the same; with the errors
            that the parameters sensor.* ask for, by default none
        camera/extrinsics (geometry_msgs/TransformStamped), latched; also on tf_static where
            tf2_msgs is installed
        NAME/… of the same six for each further camera of the scene
        joint_states (sensor_msgs/JointState) and clock (rosgraph_msgs/Clock), at 60 Hz; nodes in a
            namespace hear the clock by the remapping /clock:=clock
        robot_description (std_msgs/String), latched
        sim/ground_truth (tamp_interfaces/SceneGraph), latched: for evaluation and tests only
        diagnostics (diagnostic_msgs/DiagnosticArray): that it lives; a second simulator is noticed
    Subscribes:
        joint_trajectory (trajectory_msgs/JointTrajectory): replaces the running one, at once or at
            the time of its stamp, and joined in its midst where that has passed; one that is
            malformed, over, or far from the arm is refused with a logged reason; one without points
            stops the arm. With gripper_apart it commands the arm's joints alone, by
            the rules of ros2_control's joint_trajectory_controller
        gripper_trajectory (trajectory_msgs/JointTrajectory), with gripper_apart: the fingers, by
            the same rules
        NAME/view_request (geometry_msgs/PoseStamped) of each further camera: where its optical
            frame is to be; it goes there, upright, unless no place is seen from there, which the
            log says
        diagnostics (diagnostic_msgs/DiagnosticArray): of the other nodes
    Services:
        sim/reset (tamp_interfaces/ResetScene): drops every disturbance that is pending or under way
        sim/disturb (tamp_interfaces/Disturb): lets something go wrong, now or at an event; what
            becomes of it stands in the log

    One thread of its own owns the physics; callbacks hand it their work through a queue. Should the
    physics fail, the node says so and the process ends with exit code 3.

    Args:
        on_failure: called by the physics thread when there will be no further turn.
        kwargs: go to the node.
    """

    def __init__(self, on_failure: Callable[[], None] | None = None, **kwargs: Any) -> None:
        super().__init__("sim_node", **kwargs)
        self._on_failure, self._failed = on_failure, False
        values = declare_parameters(self, PARAMETERS, self._parameters_changed)
        self._scene = load_scene(values["scene"])
        layout = first_layout(values, self._scene)
        self._values = values
        self._topics = SimTopics(self, self._scene.cameras, sensor_from_parameters(values))

        self._world = World(self._scene, arm=SIMULATED_ARMS[values["robot"]])
        apart = values["gripper_apart"]
        self._arm: CommandsMotors = (TwoControllers if apart else ArmController)(self._world)
        self._disturber = Disturber(self._world, self._arm, self.get_logger().info)
        self._world.reset(layout, values["seed"])
        self._topics.restart_pictures(values["seed"])
        # The clock starts at the host's time, so that it goes on forward when the node restarts.
        self._start_nanoseconds = time.time_ns()
        self._topics.publish_descriptions(self._world, values["mesh_uris"], self._stamp())
        self.get_logger().info(f"scene {format_stacks(layout)}")

        self._truth, self._turns = true_scene_graph(self._world), 0
        self._real_time_factor: float = values["real_time_factor"]
        self._pacer = Pacer(self._world.time, self._real_time_factor)
        self._physics = PhysicsThread(
            self._turn,
            lambda: self._pacer.pause(self._world.time),
            lambda text: self.get_logger().error(f"a request to the physics failed:\n{text}"),
            self._on_death,
        )
        self._create_ears()
        self._physics.start()

    @property
    def failure(self) -> str:
        """Why the physics failed; empty as long as it has not."""
        return self._physics.failure if self._failed else ""

    def destroy_node(self) -> None:
        """Ends the physics thread, then the node."""
        self._physics.stop()
        self._world.close()
        super().destroy_node()

    # Set-up

    def _create_ears(self) -> None:
        self._commands = TrajectoryTopics(self, self._arm, self._physics.post, self._step_at)
        for number, camera in list(enumerate(self._scene.cameras))[1:]:
            self.create_subscription(
                PoseStamped, f"{camera.name}/view_request", partial(self._on_view, number), NEWEST
            )
        # One at a time: callers who wait must not take all of the executor's threads.
        self.create_service(
            ResetScene,
            "sim/reset",
            self._on_reset,
            callback_group=MutuallyExclusiveCallbackGroup(),
        )
        self.create_service(
            Disturb,
            "sim/disturb",
            self._on_disturb,
            callback_group=MutuallyExclusiveCallbackGroup(),
        )
        self._presence = Presence(self, "sim_node")

    # Callbacks: they only hand work to the physics thread

    def _parameters_changed(self, values: dict[str, Any]) -> None:
        if "real_time_factor" in values:
            self._real_time_factor = values["real_time_factor"]
            self._physics.post(self._start_pacing)
        self._values = {**self._values, **values}
        if any(name.startswith("sensor.") for name in values):
            sensor = sensor_from_parameters(self._values)
            self._physics.post(lambda: self._topics.configure(sensor))

    def _on_view(self, number: int, request: PoseStamped) -> None:
        self._physics.post(lambda: self._move_camera(number, *sight_from_message(request)))

    def _on_reset(
        self, request: ResetScene.Request, response: ResetScene.Response
    ) -> ResetScene.Response:
        try:
            layout = requested_layout(
                self._scene, request.layout, request.seed, request.blocks, request.generator
            )
            stamp, dropped = self._physics.call(lambda: self._reset(layout, request.seed))
            response.success = True
            response.message = f"the scene is {format_stacks(layout)}"
            if dropped:
                response.message += f"; dropped {dropped} disturbances, pending or under way"
            response.layout = format_layout(layout)
            response.stamp = stamp
        except LayoutError as error:
            self._refuse(response, f"{error}; the scene is unchanged")
        except PhysicsError as error:
            self._refuse(response, f"the scene was not reset: {error}")
        except Exception as error:  # a defect must neither leave the caller waiting nor go unseen
            self.get_logger().error(f"resetting the scene failed:\n{traceback.format_exc()}")
            sentence = f"resetting the scene failed half-way ({type(error).__name__}: {error})"
            self._refuse(response, f"{sentence}; reset it again, or start sim_node anew")
        if conflict := self._presence.conflict():
            response.message += f"; but {conflict}"
        return response

    def _on_disturb(self, request: Disturb.Request, response: Disturb.Response) -> Disturb.Response:
        try:
            wanted = request_from_message(request, self._step_at)
            promise = self._physics.call(lambda: self._disturber.request(wanted))
            response.success, response.id = True, promise.number
            response.message = promise.sentence
        except DisturbanceError as error:
            response.message = f"{error}; the world is as it was"
        except PhysicsError as error:
            response.message = f"nothing was disturbed: {error}"
        except Exception as error:  # as in resetting
            self.get_logger().error(f"a disturbance failed:\n{traceback.format_exc()}")
            response.message = f"it failed half-way ({type(error).__name__}: {error}); see the log"
        if conflict := self._presence.conflict():
            response.message += f"; but {conflict}"
        return response

    def _refuse(self, response: ResetScene.Response, reason: str) -> None:
        """Says why, and what is on the table as the camera's last picture has it."""
        stacks, fallen = standing_blocks(self._truth)
        response.success, response.layout = False, format_layout(stacks)
        response.message = reason
        if fallen:
            response.message += f"; in no stack: {', '.join(fallen)}"

    # The physics thread

    def _turn(self) -> None:
        for _ in range(STEPS_PER_STATE):
            self._arm.update()
            self._disturber.update()
            self._world.step()
        stamp = self._stamp()
        self._topics.publish_state(self._world, stamp)
        self._turns += 1
        if self._turns % STATES_PER_FRAME == 0:
            self._truth = true_scene_graph(self._world)
            self._topics.publish_truth(self._truth, stamp)
            self._topics.publish_pictures(self._world, stamp)

    def _reset(self, layout: Stacks, seed: int) -> tuple[Time, int]:
        """The time at which the scene was as asked for, and how many disturbances it ended."""
        self._world.reset(layout, seed)
        self._arm.reset()
        dropped = self._disturber.reset()
        self._turns = 0  # so that pictures are taken at the same moments every time
        self._topics.restart_pictures(seed)
        self._truth = true_scene_graph(self._world)
        self._start_pacing()
        return self._stamp(), dropped

    def _move_camera(self, number: int, position: Vector, target: Vector) -> None:
        name = self._scene.cameras[number].name
        try:
            self._world.move_camera(number, position, target)
        except SceneError as error:
            self.get_logger().warning(f"{name} stays where it is: {error}")
            return
        self._topics.move_camera(number, self._world.config.cameras[number], self._stamp())
        self.get_logger().info(f"{name} looks from ({', '.join(f'{x:.2f}' for x in position)}) m")

    def _start_pacing(self) -> None:
        self._pacer.change(self._world.time, self._real_time_factor)

    def _on_death(self, text: str) -> None:
        if not self.context.ok():  # the node is being stopped: nothing can be published any more
            return
        self._failed = True
        self.get_logger().fatal(f"the physics stopped:\n{text}")
        if self._on_failure:
            time.sleep(_FAREWELL_SECONDS)
            self._on_failure()

    def _stamp(self) -> Time:
        return stamp_from_nanoseconds(self._start_nanoseconds + round(self._world.time * 1e9))

    def _step_at(self, moment: Time) -> int | None:
        """The step of the physics that a stamp means; None for no stamp: now."""
        stamp = nanoseconds(moment)
        if stamp == 0:
            return None
        return round((stamp - self._start_nanoseconds) / 1e9 / self._world.timestep)


def run() -> int:
    """Runs the node until it is stopped; returns the process's exit code.

    That is ``EXIT_PHYSICS_FAILED`` (3) if it ended because its physics did, else as ``run_node``.
    """
    make_room_for_pictures()
    made: list[SimNode] = []

    def make() -> SimNode:
        made.append(SimNode(on_failure=rclpy.try_shutdown))
        return made[0]

    code = run_node(make)
    return EXIT_PHYSICS_FAILED if made and made[0].failure else code
