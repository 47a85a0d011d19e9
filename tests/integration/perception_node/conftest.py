# SPDX-License-Identifier: Apache-2.0
"""A perception_node and a camera that shows it pictures."""

from __future__ import annotations

from typing import Any

import pytest
from fake_camera import OTHER, TOWERS, FakeCamera
from rclpy.node import Node

from perception_node.node import PerceptionNode
from scene_graph import Stacks
from sim_node.camera import Frame
from sim_node.world import World


@pytest.fixture(scope="module")
def frames() -> dict[Stacks, Frame]:
    rendered = {}
    with World() as world:
        for layout in (TOWERS, OTHER):
            world.reset(layout)
            rendered[layout] = world.render()
    return rendered


@pytest.fixture
def perception(ros_context: Any) -> PerceptionNode:
    """In a namespace, as every name is relative."""
    return ros_context.add(PerceptionNode(context=ros_context.context, namespace="/cell"))


@pytest.fixture
def camera(ros_context: Any, perception: PerceptionNode) -> FakeCamera:
    node = ros_context.add(Node("fake_camera", context=ros_context.context, namespace="/cell"))
    camera = FakeCamera(ros_context, node)
    ros_context.wait_until(
        lambda: (
            all(publisher.get_subscription_count() for publisher in camera.publishers)
            and perception.count_subscribers("scene_graph")
        ),
        what="discovery",
    )
    return camera
