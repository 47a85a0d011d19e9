# SPDX-License-Identifier: Apache-2.0
"""A perception_node and a camera that shows it pictures."""

from __future__ import annotations

from typing import Any

import pytest
from fake_camera import (
    COLOR_ALONE,
    OTHER,
    TOPICS,
    TOWERS,
    WITHOUT_LABELS,
    FakeCamera,
    camera_before,
)
from rclpy.parameter import Parameter

from perception_node.node import PerceptionNode
from perception_node.segment import RGB, SEGMENTATION_TOPIC
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
def perception_of_labels(ros_context: Any) -> PerceptionNode:
    """One whose masks come from a detector."""
    source = Parameter("mask_source", value=SEGMENTATION_TOPIC)
    return ros_context.add(
        PerceptionNode(context=ros_context.context, namespace="/cell", parameter_overrides=[source])
    )


@pytest.fixture
def perception_of_colors(ros_context: Any) -> PerceptionNode:
    """One that has nothing but colour."""
    source = Parameter("mask_source", value=RGB)
    return ros_context.add(
        PerceptionNode(context=ros_context.context, namespace="/cell", parameter_overrides=[source])
    )


@pytest.fixture
def color_camera(ros_context: Any, perception_of_colors: PerceptionNode) -> FakeCamera:
    """A camera without depth."""
    return camera_before(ros_context, perception_of_colors, COLOR_ALONE)


@pytest.fixture
def camera(ros_context: Any, perception: PerceptionNode) -> FakeCamera:
    """A camera that publishes no labels."""
    return camera_before(ros_context, perception, WITHOUT_LABELS)


@pytest.fixture
def labelling_camera(ros_context: Any, perception_of_labels: PerceptionNode) -> FakeCamera:
    """A camera with a detector."""
    return camera_before(ros_context, perception_of_labels, tuple(TOPICS))
