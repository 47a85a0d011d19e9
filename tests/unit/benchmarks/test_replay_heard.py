# SPDX-License-Identifier: Apache-2.0
"""What passes over the topics becomes a recording."""

from __future__ import annotations

from dataclasses import replace
from typing import Any

import numpy as np
import pytest
from replay.record_graph import Heard, recording_of
from replay.recording import Recording, RecordingError
from replay_scenes import EDGE, PLACES, TABLE, block
from sensor_msgs.msg import JointState
from std_msgs.msg import Header
from tamp_interfaces.msg import SceneGraph as SceneGraphMsg
from tamp_runtime.messages.scene_graph import graph_to_message
from tamp_runtime.messages.stamps import duration_from_seconds, stamp_from_nanoseconds
from trajectory_msgs.msg import JointTrajectory, JointTrajectoryPoint

from scene_graph import UP, Place, Relation, SceneGraph, SceneObject

BEGAN = 1_700_000_000.0
STEP = 1.0 / 240.0
JOINTS = ("shoulder", "elbow")
RED = block("red_box", (0.5, 0.0, EDGE / 2))


def header(time: float) -> Header:
    return Header(stamp=stamp_from_nanoseconds(round((BEGAN + time) * 1e9)))


def truth(time: float, x: float = 0.5) -> SceneGraphMsg:
    item = SceneObject("red_box", "red", "box", (x, 0.0, EDGE / 2), size=RED.size)
    places = tuple(Place(index, place) for index, place in enumerate(PLACES))
    graph = SceneGraph((item,), frozenset({Relation("red_box", UP, "stack1")}), places)
    return graph_to_message(graph, header(time))


def state(time: float) -> JointState:
    """The shoulder turns from 2 s on; names come in another order."""
    value = max(time - 2.0, 0.0)
    return JointState(header=header(time), name=["elbow", "shoulder"], position=[-value, value])


def trajectory() -> JointTrajectory:
    message = JointTrajectory(joint_names=["elbow", "shoulder"])
    message.points = [
        JointTrajectoryPoint(
            positions=[-time, time],
            velocities=[-1.0, 1.0],
            time_from_start=duration_from_seconds(time),
        )
        for time in (0.0, 1.0, 2.0)
    ]
    return message


def recorded(heard: Heard) -> Recording:
    about: dict[str, Any] = {
        "seed": 1, "goal": "red on stack1", "success": True, "robot": "panda", "places": PLACES
    }  # fmt: skip
    return recording_of(heard, (TABLE, RED), JOINTS, STEP, **about)


def states(first: float = 0.0, last: float = 4.0) -> tuple[JointState, ...]:
    return tuple(state(time) for time in np.arange(first, last, 4 * STEP))


def test_times_begin_with_the_first_truth_and_joints_are_in_one_order() -> None:
    heard = Heard((truth(0.0), truth(1.0), truth(3.0)), states(), ((BEGAN + 2.1, trajectory()),))
    whole = recorded(heard)
    assert whole.source == "graph"
    assert whole.trace.times == pytest.approx([0.0, 1.0, 3.0], abs=1e-6)
    assert whole.trace.joints[-1] == pytest.approx([1.0, -1.0], abs=1e-3)
    assert whole.start == pytest.approx([0.0, 0.0])
    assert whole.relations == (("red_box", "up", "stack1"),)
    (command,) = whole.commands
    assert command.begins == pytest.approx(2.0, abs=1.5 * STEP)
    assert command.positions[-1] == pytest.approx([2.0, -2.0])
    assert command.velocities is not None
    assert command.velocities[0] == pytest.approx([1.0, -1.0])


def test_an_order_to_stand_still_is_kept_where_it_was_heard() -> None:
    heard = Heard(
        (truth(0.0), truth(3.0)),
        states(),
        ((BEGAN + 2.0, trajectory()), (BEGAN + 2.5, JointTrajectory())),
    )
    last = recorded(heard).commands[-1]
    assert len(last.times) == 0
    assert last.begins == pytest.approx(2.5, abs=1e-6)


def test_truths_without_joint_states_beside_them_are_left_out() -> None:
    lost = (*states(0.0, 1.0), *states(2.0, 4.0))
    heard = Heard((truth(0.0), truth(0.5), truth(1.5), truth(3.0)), lost, ())
    assert recorded(heard).trace.times == pytest.approx([0.0, 0.5, 3.0], abs=1e-6)


def test_another_scene_than_that_of_the_seed_is_refused() -> None:
    with pytest.raises(RecordingError, match=r"red_box is 20\.0 mm from where"):
        recorded(Heard((truth(0.0, x=0.52), truth(1.0)), states(), ()))


def test_blocks_are_where_the_first_truth_has_them() -> None:
    whole = recorded(Heard((truth(0.0, x=0.5004), truth(1.0)), states(), ()))
    assert whole.blocks == (replace(RED, position=(0.5004, 0.0, EDGE / 2)),)
    assert whole.bodies[0] == TABLE
