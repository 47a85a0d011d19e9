# SPDX-License-Identifier: Apache-2.0
"""The same scene and trajectory end the same, bit by bit, however quick or busy the machine is."""

from __future__ import annotations

import threading
from collections.abc import Iterator
from contextlib import contextmanager
from typing import Any

import numpy as np
import pytest
from builtin_interfaces.msg import Duration, Time
from rclpy.node import Node
from rclpy.parameter import Parameter
from tamp_interfaces.msg import SceneGraph
from tamp_interfaces.srv import ResetScene
from tamp_runtime.messages.stamps import nanoseconds, stamp_from_nanoseconds
from tamp_runtime.qos import RELIABLE, STATUS
from trajectory_msgs.msg import JointTrajectory, JointTrajectoryPoint

from sim_node.node import SimNode
from sim_node.simulated_arms import PANDA

LAYOUT = ["red_box,blue_box", "green_box,yellow_box,purple_box", ""]
#: From home into the tower in the middle.
DOWN = np.array([0.0, 0.37, 0.0, -2.39, 0.0, 2.76, 0.79, 0.04, 0.04])
#: Latched, and deep enough that a busy machine loses none.
EVERY_TRUTH = STATUS
#: After the reset: when the arm sets out, and when all lies still [s].
BEGINS, ENDS = 4.0, 8.0


@contextmanager
def busy(threads: int) -> Iterator[None]:
    """Python threads that take the processor, and the interpreter, from the simulator."""
    done = threading.Event()

    def spin() -> None:
        while not done.is_set():
            sum(range(1000))

    others = [threading.Thread(target=spin, daemon=True) for _ in range(threads)]
    for other in others:
        other.start()
    try:
        yield
    finally:
        done.set()
        for other in others:
            other.join()


def final_poses(ros_context: Any, name: str, factor: float) -> dict[str, tuple[float, ...]]:
    """Where the blocks are ``ENDS`` after a reset in which the arm knocks a tower over.

    Args:
        name: of the simulator's namespace.
    """
    context = ros_context.context
    sim = ros_context.add(
        SimNode(
            context=context,
            namespace=name,
            parameter_overrides=[Parameter("real_time_factor", value=1.0)],
        )
    )
    node = Node("watcher", context=context, namespace=name)
    truths: list[SceneGraph] = []
    node.create_subscription(SceneGraph, "sim/ground_truth", truths.append, EVERY_TRUTH)
    arm = node.create_publisher(JointTrajectory, "joint_trajectory", RELIABLE)
    reset = node.create_client(ResetScene, "sim/reset")
    ros_context.add(node)
    ros_context.wait_until(lambda: arm.get_subscription_count() == 1)
    assert reset.wait_for_service(timeout_sec=10.0)
    future = reset.call_async(ResetScene.Request(layout=LAYOUT, seed=5))
    ros_context.wait_until(future.done, what="sim/reset")
    start = nanoseconds(future.result().stamp)
    message = JointTrajectory(joint_names=list(PANDA.joints))
    message.header.stamp = stamp_from_nanoseconds(start + round(BEGINS * 1e9))
    message.points = [
        JointTrajectoryPoint(positions=point.tolist(), time_from_start=Duration(sec=second))
        for second, point in ((0, PANDA.home_positions), (1, DOWN))
    ]
    published = threading.Event()
    # Time stands still until the trajectory is there.
    sim._physics.post(lambda: published.wait() and None)
    arm.publish(message)
    ros_context.wait_until(lambda: sim._physics._calls.qsize() > 0, what="the trajectory")
    sim.set_parameters([Parameter("real_time_factor", value=factor)])
    published.set()
    end = start + round(ENDS * 1e9)

    def at_end() -> SceneGraph | None:
        return next((truth for truth in truths if _time(truth.header.stamp) >= end), None)

    ros_context.wait_until(at_end, what="the end")
    truth = at_end()
    assert truth is not None
    assert _time(truth.header.stamp) - end < 100_000_000
    sim.set_parameters([Parameter("real_time_factor", value=0.1)])
    poses = ((item.name, item.pose.position, item.pose.orientation) for item in truth.objects)
    return {name: (p.x, p.y, p.z, q.x, q.y, q.z, q.w) for name, p, q in poses}


def _time(stamp: Time) -> int:
    return int(nanoseconds(stamp))


@pytest.mark.parametrize(("factor", "threads"), [(0.0, 0), (1.0, 3)])
def test_the_load_of_the_machine_and_the_pace_change_nothing(
    ros_context: Any, factor: float, threads: int
) -> None:
    expected = final_poses(ros_context, "first", 2.0)
    assert (
        min(pose[2] for pose in expected.values())
        < 0.04
        < max(pose[2] for pose in expected.values())
    )
    with busy(threads):
        assert final_poses(ros_context, "second", factor) == expected
