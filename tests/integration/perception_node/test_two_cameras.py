# SPDX-License-Identifier: Apache-2.0
"""Two cameras make one graph; one that falls silent is left out, and the graph says so."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import pytest
from fake_camera import FakeCamera
from rclpy.node import Node
from rclpy.parameter import Parameter
from tamp_interfaces.msg import SceneGraph
from tamp_runtime.messages.scene_graph import graph_from_message
from tamp_runtime.qos import NEWEST

from perception_node.node import PerceptionNode
from scene_graph import Stacks
from sim_node import World, parse_scene
from sim_node.node import SimNode

SCENE = """
places: [[0.58, -0.15], [0.58, 0.0], [0.58, 0.15], [0.42, -0.15], [0.42, 0.0], [0.42, 0.15]]
cameras:
  - {position: [1.45, 0.0, 0.4], target: [0.5, 0.0, 0.08]}
  - {name: side, position: [0.8, -1.05, 0.75], target: [0.5, 0.0, 0.1], vertical_fov: 0.6}
"""
HIDING: Stacks = ((), ("red_box", "blue_box", "green_box"), (), (), ("yellow_box",), ())


def test_what_two_cameras_see_is_joined_until_one_falls_silent(
    ros_context: Any, monkeypatch: pytest.MonkeyPatch
) -> None:
    with World(parse_scene(SCENE)) as world:
        world.reset(HIDING)
        frames = [world.render(number) for number in range(2)]
        configs = world.config.cameras
        places = [float(value) for place in world.config.stack_positions for value in place]
    told = {"cameras": ["camera", "side"], "stack_positions": places}
    overrides = [Parameter(name, value=value) for name, value in told.items()]
    ros_context.add(PerceptionNode(context=ros_context.context, parameter_overrides=overrides))
    node = ros_context.add(Node("fake_cameras", context=ros_context.context))
    front, side = (FakeCamera(ros_context, node, config=config) for config in configs)

    def show_both() -> SceneGraph:
        side.seconds = front.seconds
        side.publish(side.messages(frames[1], configs[1]))
        return front.show(frames[0], configs[0])

    ros_context.wait_until(
        lambda: all(
            publisher.get_subscription_count()
            for camera in (front, side)
            for publisher in camera.publishers.values()
        ),
        what="discovery",
    )
    for camera in (front, side):
        camera.calibrate()
    both: list[SceneGraph] = []

    def placed() -> bool:
        both.append(show_both())
        return "extrinsics" not in both[-1].message

    ros_context.wait_until(placed, what="extrinsics of both")
    assert both[-1].status == SceneGraph.CONFIDENT and not both[-1].message
    assert graph_from_message(both[-1]).stacks() == HIDING

    monkeypatch.setattr("perception_node.moments.SILENCE", 0.0)
    seen: list[SceneGraph] = []

    def goes_on() -> bool:
        front.publish(front.messages(frames[0], configs[0]))
        seen.extend(front.graphs[-1:])
        return seen[-1].status == SceneGraph.HIDDEN

    ros_context.wait_until(goes_on, what="a graph without the side")
    assert "no picture of side comes" in seen[-1].message
    assert "hidden_stack4" in [item.name for item in seen[-1].objects]

    monkeypatch.undo()

    def is_back() -> bool:
        both.append(show_both())
        return both[-1].status == SceneGraph.CONFIDENT

    ros_context.wait_until(is_back, what="a graph of both again")
    assert not both[-1].message


def test_the_simulators_camera_goes_where_the_hidden_block_is_seen(
    ros_context: Any, tmp_path: Path
) -> None:
    # Beside the first one it sees no more than that.
    scene = tmp_path / "beside.yaml"
    scene.write_text(SCENE.replace("[0.8, -1.05, 0.75]", "[1.44, 0.03, 0.4]"))
    layout = [",".join(stack) for stack in HIDING]
    places = [value for place in parse_scene(SCENE).stack_positions for value in map(float, place)]
    simulator = {"scene": str(scene), "layout": layout}
    perception = {"cameras": ["camera", "side"], "stack_positions": places, "use_sim_time": True}
    for kind, told in ((SimNode, simulator), (PerceptionNode, perception)):
        overrides = [Parameter(name, value=value) for name, value in told.items()]
        ros_context.add(kind(context=ros_context.context, parameter_overrides=overrides))
    node = ros_context.add(Node("listener", context=ros_context.context))
    graphs: list[SceneGraph] = []
    node.create_subscription(SceneGraph, "scene_graph", graphs.append, NEWEST)
    ros_context.wait_until(
        lambda: graphs and graphs[-1].status == SceneGraph.CONFIDENT, what="a view that shows all"
    )
    assert graph_from_message(graphs[-1]).stacks() == HIDING
