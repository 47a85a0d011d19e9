# SPDX-License-Identifier: Apache-2.0
"""``ros2 run planner_node stop``: stops the arm, whoever set it moving, and says how it ended.

It cancels every goal of achieve_goal. Where no planner answers, or none had a goal, it asks the
motion node itself to stop whatever it carries out and to go home.
"""

from __future__ import annotations

import argparse
import sys
import time
import uuid
from collections.abc import Sequence
from typing import Final

import rclpy
from rclpy.node import Node
from rclpy.utilities import remove_ros_args
from std_msgs.msg import Header
from tamp_interfaces.msg import MotionStatus, SymbolicPlan
from tamp_runtime.node_thread import NodeThread
from tamp_runtime.qos import LATCHED, STATUS

from .arm_text import describe_arm
from .client import PlannerClient
from .commands import prepare
from .interrupts import exit_code, say
from .rest import RestWatch
from .unavailable import PlannerUnavailableError

#: It cannot be said that the arm rests: nobody answers, or not in time.
EXIT_UNKNOWN: Final = 1
#: The arm rests, but not at home, or something is in its hand.
EXIT_NOT_HOME: Final = 3

#: How long the planner may take to answer [s].
PLANNER_TIMEOUT: Final = 5.0
#: How long the motion node may be silent; it beats once a second [s].
MOTION_TIMEOUT: Final = 5.0
#: How long a planner that cancelled a goal may take until it has the arm stopped [s].
PLANNER_STOPS: Final = 5.0
_POLL_SECONDS: Final = 0.1


class MotionStopper(Node):
    """Hears what the motion node reports, and asks it to stop."""

    def __init__(self) -> None:
        super().__init__(f"motion_stopper_{uuid.uuid4().hex[:6]}")
        self.watch = RestWatch()
        self._plans = self.create_publisher(SymbolicPlan, "symbolic_plan", LATCHED)
        self.create_subscription(MotionStatus, "motion_status", self.watch.hear, STATUS)

    def listeners(self) -> int:
        """How many would hear the request."""
        count: int = self._plans.get_subscription_count()
        return count

    def ask(self) -> None:
        """Asks the motion node to stop, whatever it carries out."""
        header = Header(stamp=self.get_clock().now().to_msg())
        self._plans.publish(SymbolicPlan(header=header))


def stop(arguments: Sequence[str] | None = None) -> int:
    """Stops the arm and prints how it ended.

    Returns:
        0: the arm is at home with an empty hand; 3: it rests, but elsewhere or with something in
        its hand; 1: it cannot be said that it rests; 2: an argument makes no sense; 130: Ctrl-C,
        what was asked for stays asked for.
    """
    arguments = sys.argv if arguments is None else arguments
    parser = argparse.ArgumentParser(
        prog="stop",
        description="Stops the arm, whoever set it moving, and waits until it rests.",
        epilog="Exit code 0: it is at home with an empty hand; 3: it rests, but elsewhere or with "
        "something in its hand; 1: it cannot be said that it rests.",
    )
    parser.add_argument("--timeout", type=float, default=60.0, help="[s], default %(default)s")
    options = parser.parse_args(remove_ros_args(arguments)[1:])
    if not options.timeout > 0.0:
        parser.error(f"--timeout {options.timeout:g}: must be positive")
    prepare(arguments)
    try:
        return _stop(options.timeout)
    except KeyboardInterrupt as interrupt:
        say("stop: not waiting any longer; what was asked for stays asked for")
        return exit_code(interrupt)
    finally:
        rclpy.try_shutdown()


def _stop(timeout: float) -> int:
    deadline = time.monotonic() + timeout
    node = MotionStopper()
    spinning = NodeThread(node)
    try:
        cancelled = _cancel_goals(min(PLANNER_TIMEOUT, timeout))
        node.watch.start()
        grace = time.monotonic() + (PLANNER_STOPS if cancelled else 0.0)
        asked = False
        while time.monotonic() < deadline:
            if node.watch.at_rest and (cancelled or asked):
                return _tell(node.watch)
            if not asked and time.monotonic() >= grace and node.listeners():
                node.ask()
                node.watch.start()
                asked = True
            if node.watch.silence() > MOTION_TIMEOUT:
                break
            time.sleep(_POLL_SECONDS)
        return _tell_doubt(node, asked, timeout)
    finally:
        spinning.stop()
        node.destroy_node()


def _cancel_goals(timeout: float) -> int:
    """Cancels the goals of the planner and says so; returns how many there were."""
    with PlannerClient() as planner:
        try:
            count = planner.cancel_all(timeout)
        except PlannerUnavailableError:
            say("stop: no planner_node answers; asking motion_node itself", sys.stdout)
            return 0
    if count:
        goals = "the goal" if count == 1 else f"{count} goals"
        say(f"stop: cancelled {goals} of achieve_goal; waiting until the arm rests", sys.stdout)
    return count


def _tell(watch: RestWatch) -> int:
    status = watch.last
    assert status is not None
    arm = describe_arm(status)
    ended = watch.ended
    if ended is not None and ended.message:
        say(f"stop: {ended.message}", sys.stdout)
    elif ended is None:
        say("stop: nothing was under way", sys.stdout)
    say(f"stop: {arm}", sys.stdout)
    if status.arm == MotionStatus.ARM_UNKNOWN:
        return EXIT_UNKNOWN
    at_home = status.arm == MotionStatus.ARM_HOME and not status.held
    return 0 if at_home else EXIT_NOT_HOME


def _tell_doubt(node: MotionStopper, asked: bool, timeout: float) -> int:
    last = node.watch.last
    if last is None and not node.listeners():
        why = "no motion_node is there"
    elif last is None or node.watch.silence() > MOTION_TIMEOUT:
        why = f"motion_node has reported nothing for {MOTION_TIMEOUT:g} s"
    else:
        why = f"after {timeout:g} s {describe_arm(last)}, and motion_node says: {last.message}"
    asked_for = ", although it was asked to stop" if asked else ""
    say(
        f"stop: {why}{asked_for}. If the arm moves, use its emergency stop; the logs of "
        "motion_node and of the arm's driver say more"
    )
    return EXIT_UNKNOWN
