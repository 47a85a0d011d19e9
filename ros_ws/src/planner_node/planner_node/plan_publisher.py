# SPDX-License-Identifier: Apache-2.0
"""The way of plans to the motion node."""

from __future__ import annotations

from rclpy.node import Node
from tamp_interfaces.msg import PlanSighting, SymbolicPlan
from tamp_runtime.qos import LATCHED, NEWEST

from .conversions import plan_to_message, sight_to_message, stop_to_message
from .loop import Plan
from .loop.plan_watch import PlanSight


class PlanPublisher:
    """The topics symbolic_plan and plan_sighting, and the clock of its node."""

    def __init__(self, node: Node) -> None:
        """``node`` gets the publisher."""
        self._clock = node.get_clock()
        self._publisher = node.create_publisher(SymbolicPlan, "symbolic_plan", LATCHED)
        self._sights = node.create_publisher(PlanSighting, "plan_sighting", NEWEST)

    def publish(self, plan: Plan) -> None:
        """See :class:`planner_node.loop.PlanTopic`."""
        self._publisher.publish(plan_to_message(plan))

    def publish_stop(self, plan_id: str) -> None:
        """See :class:`planner_node.loop.PlanTopic`."""
        self._publisher.publish(stop_to_message(plan_id, self.now()))

    def publish_sight(self, plan_id: str, sight: PlanSight) -> None:
        """See :class:`planner_node.loop.PlanTopic`."""
        self._sights.publish(sight_to_message(plan_id, sight))

    def subscribers(self) -> int:
        """How many hear it."""
        count: int = self._publisher.get_subscription_count()
        return count

    def now(self) -> int:
        """The ROS time [ns]; 0 while simulated time has not arrived."""
        nanoseconds: int = self._clock.now().nanoseconds
        return nanoseconds
