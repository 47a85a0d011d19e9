# SPDX-License-Identifier: Apache-2.0
"""The topics that command the arm: each hands what it hears to its controller."""

from __future__ import annotations

from collections.abc import Callable

from builtin_interfaces.msg import Time
from rclpy.callback_groups import MutuallyExclusiveCallbackGroup
from rclpy.node import Node
from tamp_runtime.qos import RELIABLE
from trajectory_msgs.msg import JointTrajectory

from .controller import CommandsMotors, FollowsTrajectories
from .conversions import trajectory_arrays
from .trajectory import TrajectoryError


class TrajectoryTopics:
    """Subscribes to the topics of some controllers.

    Args:
        controllers: what is commanded.
        post: has something done in the thread that owns the physics.
        step_at: the step of the physics that a stamp means; None for no stamp: now.
    """

    def __init__(
        self,
        node: Node,
        controllers: CommandsMotors,
        post: Callable[[Callable[[], None]], None],
        step_at: Callable[[Time], int | None],
    ) -> None:
        self._log, self._post, self._step_at = node.get_logger(), post, step_at
        self._alone = len(controllers.topics) == 1
        # One after the other: of two trajectories the later one must be the last to be followed.
        group = MutuallyExclusiveCallbackGroup()
        for topic, controller in controllers.topics.items():
            node.create_subscription(
                JointTrajectory,
                topic,
                self._ear(topic, controller),
                RELIABLE,
                callback_group=group,
            )

    def _ear(
        self, topic: str, controller: FollowsTrajectories
    ) -> Callable[[JointTrajectory], None]:
        where = "" if self._alone else f"{topic}: "

        def follow(message: JointTrajectory) -> None:
            try:
                if not message.points:
                    controller.stop()
                    return
                trajectory = controller.follow(
                    message.joint_names,
                    *trajectory_arrays(message),
                    self._step_at(message.header.stamp),
                )
                self._log.info(
                    f"{where}following a trajectory of {len(message.points)} points, "
                    f"{trajectory.duration:.1f} s"
                )
            except TrajectoryError as error:
                self._log.error(f"{topic} refused: {error}; the arm goes on")

        return lambda message: self._post(lambda: follow(message))
