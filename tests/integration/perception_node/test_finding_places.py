# SPDX-License-Identifier: Apache-2.0
"""Places that are found stay where they are until somebody asks for them anew."""

from __future__ import annotations

from typing import Any

from fake_camera import OTHER, TOWERS, WITHOUT_LABELS, FakeCamera, camera_before
from rclpy.parameter import Parameter
from std_srvs.srv import Trigger
from tamp_interfaces.msg import SceneGraph
from tamp_runtime.messages.scene_graph import graph_from_message

from perception_node.node import PerceptionNode
from scene_graph import ROW_OF_THREE, Stacks
from sim_node.camera import Frame


def test_places_stay_until_they_are_asked_for_anew(
    ros_context: Any, frames: dict[Stacks, Frame]
) -> None:
    # Of stack_positions only the height of the table is used.
    told = {"places": "found", "stack_positions": [9.0, 9.0, 0.0]}
    overrides = [Parameter(name, value=value) for name, value in told.items()]
    perception = ros_context.add(
        PerceptionNode(
            context=ros_context.context, namespace="/cell", parameter_overrides=overrides
        )
    )
    camera = camera_before(ros_context, perception, WITHOUT_LABELS)
    client = camera.node.create_client(Trigger, "find_places")
    assert client.wait_for_service(10.0)

    def find() -> Trigger.Response:
        future = client.call_async(Trigger.Request())
        ros_context.wait_until(future.done)
        return future.result()

    def find_in(frame: Frame) -> Trigger.Response:
        answers: list[Trigger.Response] = []

        def is_found() -> bool:
            camera.show(frame)
            answers.append(find())
            return "no picture" not in answers[-1].message  # the machine may be slow

        ros_context.wait_until(is_found)
        return answers[-1]

    answer = find()
    assert not answer.success and "no picture" in answer.message

    seen = camera.calibrate_and_show(frames[TOWERS])
    assert seen.status == SceneGraph.CONFIDENT, seen.message
    assert graph_from_message(seen).stacks() == TOWERS
    for base, (x, y, z) in zip(seen.bases, ROW_OF_THREE):
        assert abs(base.position.x - x) < 0.005 and abs(base.position.y - y) < 0.005
        assert base.position.z == z

    # A tower that is taken away leaves its place.
    without = camera.show(frames[OTHER])
    assert graph_from_message(without).stacks() == OTHER
    assert without.bases[0].position == seen.bases[0].position

    # A row that cannot be leaves them all as they are.
    perception.set_parameters([Parameter("place_count", value=1)])
    answer = find_in(frames[OTHER])
    assert not answer.success and "2 stacks are seen but place_count is 1" in answer.message
    assert graph_from_message(camera.show(frames[OTHER])).stacks() == OTHER

    perception.set_parameters([Parameter("place_count", value=0)])
    answer = find_in(frames[OTHER])
    assert answer.success and answer.message.startswith("2 places at (0.")
    assert graph_from_message(camera.show(frames[OTHER])).stacks() == OTHER[1:]


def test_places_that_are_given_are_not_looked_for(
    ros_context: Any, camera: FakeCamera, frames: dict[Stacks, Frame]
) -> None:
    client = camera.node.create_client(Trigger, "find_places")
    assert client.wait_for_service(10.0)
    camera.calibrate_and_show(frames[TOWERS])
    future = client.call_async(Trigger.Request())
    ros_context.wait_until(future.done)
    assert not future.result().success
    assert future.result().message == (
        "the places are given by stack_positions; set places to found"
    )
