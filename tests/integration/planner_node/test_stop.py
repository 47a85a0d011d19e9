# SPDX-License-Identifier: Apache-2.0
"""``ros2 run planner_node stop`` stops the arm, whoever set it moving, and says how it ended."""

from __future__ import annotations

import threading
from typing import Any

import pytest
from rclpy.action import ActionServer, CancelResponse
from rclpy.callback_groups import ReentrantCallbackGroup
from rclpy.node import Node
from ros2_run import Start, finish
from tamp_interfaces.action import AchieveGoal
from tamp_interfaces.msg import MotionStatus, SymbolicPlan
from tamp_runtime.presence import Presence
from tamp_runtime.qos import LATCHED, STATUS

from planner_node.cli.client import PlannerClient

PLAN_ID = "0123"


class Motion(Node):
    """Carries out a plan until it is asked to stop, and reports on it as motion_node does."""

    def __init__(self, end: MotionStatus, running: bool = True, **kwargs: Any) -> None:
        super().__init__("motion_node", **kwargs)
        self.stops: list[SymbolicPlan] = []
        running_now = MotionStatus(
            plan_id=PLAN_ID, state=MotionStatus.EXECUTING, arm=MotionStatus.ARM_MOVING
        )
        self.status = running_now if running else end
        self.end = end
        self._statuses = self.create_publisher(MotionStatus, "motion_status", STATUS)
        self.create_subscription(SymbolicPlan, "symbolic_plan", self._on_plan, LATCHED)
        self.create_timer(0.2, lambda: self._statuses.publish(self.status))

    def _on_plan(self, plan: SymbolicPlan) -> None:
        if not plan.moves:
            self.stops.append(plan)
            self.stop()

    def stop(self) -> None:
        """What it carries out ends."""
        self.status = self.end
        self._statuses.publish(self.end)


class Planner(Node):
    """Works on a goal until it is cancelled, and has the motion stopped then."""

    def __init__(self, motion: Motion, **kwargs: Any) -> None:
        super().__init__("planner_node", **kwargs)
        self._motion = motion
        self._presence = Presence(self, "planner_node")
        self._actions = ActionServer(
            self,
            AchieveGoal,
            "achieve_goal",
            self._work,
            callback_group=ReentrantCallbackGroup(),
            cancel_callback=lambda _goal: CancelResponse.ACCEPT,
        )

    def _work(self, goal: Any) -> AchieveGoal.Result:
        waiting = threading.Event()
        while not goal.is_cancel_requested and self.context.ok():
            waiting.wait(0.05)
        if self.context.ok():
            self._motion.stop()
            goal.canceled()
        return AchieveGoal.Result(status=AchieveGoal.Result.CANCELLED)

    def destroy_node(self) -> None:
        self._actions.destroy()
        super().destroy_node()


def ended(state: int, arm: int, held: str = "", message: str = "") -> MotionStatus:
    plan_id = "" if state == MotionStatus.IDLE else PLAN_ID
    return MotionStatus(plan_id=plan_id, state=state, arm=arm, held=held, message=message)


HOME = ended(MotionStatus.CANCELLED, MotionStatus.ARM_HOME, message="put red_box down first")


def test_fault_1_a_goal_is_cancelled_by_the_planner_that_has_it(
    ros_context: Any, start: Start
) -> None:
    motion = ros_context.add(Motion(HOME, context=ros_context.context))
    ros_context.add(Planner(motion, context=ros_context.context))
    with PlannerClient(ros_context.context) as client:
        client.start("red on blue", timeout=60.0)
        stopped = finish(start("planner_node", "stop"))
        assert stopped.code == 0, stopped
        assert stopped.stdout.splitlines() == [
            "stop: cancelled the goal of achieve_goal; waiting until the arm rests",
            "stop: put red_box down first",
            "stop: the arm is at home with an empty hand",
        ]
        assert client.result(60.0).status == AchieveGoal.Result.CANCELLED


def test_fault_1_without_a_planner_the_motion_node_is_asked_itself(
    ros_context: Any, start: Start
) -> None:
    motion = ros_context.add(Motion(HOME, context=ros_context.context))
    stopped = finish(start("planner_node", "stop"))
    assert stopped.code == 0, stopped
    assert "no planner_node answers" in stopped.stdout
    assert "put red_box down first" in stopped.stdout
    assert [plan.plan_id for plan in motion.stops] == [""]


def test_fault_1_a_plan_that_no_goal_stands_behind_is_stopped_too(
    ros_context: Any, start: Start
) -> None:
    motion = ros_context.add(Motion(HOME, context=ros_context.context))
    ros_context.add(Planner(motion, context=ros_context.context))  # it has no goal
    stopped = finish(start("planner_node", "stop"))
    assert stopped.code == 0, stopped
    assert len(motion.stops) == 1


@pytest.mark.parametrize(
    ("end", "code", "sentence"),
    [
        (
            ended(MotionStatus.FAILED, MotionStatus.ARM_RESTING, "red_box", "the arm is stuck"),
            3,
            "rests away from home, its hand at (0.00, 0.00, 0.00) m, and holds red_box",
        ),
        (ended(MotionStatus.FAILED, MotionStatus.ARM_UNKNOWN), 1, "it may still move"),
    ],
)
def test_how_it_ended_is_said_in_words_and_by_the_exit_code(
    ros_context: Any, start: Start, end: MotionStatus, code: int, sentence: str
) -> None:
    ros_context.add(Motion(end, context=ros_context.context))
    stopped = finish(start("planner_node", "stop"))
    assert stopped.code == code, stopped
    assert sentence in stopped.stdout
    assert end.message in stopped.stdout


def test_an_arm_that_rests_already_is_left_alone(ros_context: Any, start: Start) -> None:
    idle = ended(MotionStatus.IDLE, MotionStatus.ARM_HOME)
    ros_context.add(Motion(idle, running=False, context=ros_context.context))
    stopped = finish(start("planner_node", "stop"))
    assert stopped.code == 0, stopped
    assert "nothing was under way" in stopped.stdout


def test_an_arm_that_does_not_stop_is_not_waited_for_for_ever(
    ros_context: Any, start: Start
) -> None:
    moving = ended(MotionStatus.EXECUTING, MotionStatus.ARM_MOVING)
    ros_context.add(Motion(moving, context=ros_context.context))
    stopped = finish(start("planner_node", "stop", "--timeout", "8"))
    assert stopped.code == 1, stopped
    assert "after 8 s the arm still moves" in stopped.stderr


def test_without_a_graph_it_says_that_nobody_is_there(start: Start) -> None:
    stopped = finish(start("planner_node", "stop", "--timeout", "20"))
    assert stopped.code == 1
    assert "no motion_node is there" in stopped.stderr


def test_an_argument_that_makes_no_sense_is_refused(start: Start) -> None:
    stopped = finish(start("planner_node", "stop", "--timeout", "-1"))
    assert stopped.code == 2
    assert "must be positive" in stopped.stderr
