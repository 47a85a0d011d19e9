# SPDX-License-Identifier: Apache-2.0
"""The observer of evaluations hears every graph, and tells simulated time by the ground truth."""

from __future__ import annotations

from collections import Counter
from typing import Any

import pytest
from rclpy.node import Node
from std_msgs.msg import Header
from tamp_interfaces.msg import SceneGraph
from tamp_runtime.messages.stamps import stamp_from_nanoseconds
from tamp_runtime.qos import LATCHED, NEWEST

from tamp_bringup.scene_observer import SceneObserver


def test_the_times_of_all_graphs_count_confident_or_not(ros_context: Any) -> None:
    node = ros_context.add(Node("perception_node", context=ros_context.context))
    publisher = node.create_publisher(SceneGraph, "scene_graph", NEWEST)
    statuses = [SceneGraph.CONFIDENT, SceneGraph.OCCLUDED, SceneGraph.BAD_IMAGE]
    with SceneObserver(context=ros_context.context) as observer:
        observer.wait_for_nodes(["perception_node"], timeout=120.0)
        for number, status in enumerate(statuses):

            def arrives(number: int = number, status: int = status) -> bool:
                publisher.publish(SceneGraph(status=status, processing_seconds=0.5 * number))
                return status in {seen for seen, _ in observer.graph_times}

            ros_context.wait_until(arrives)
        seconds = dict(observer.graph_times)
        assert seconds == {status: 0.5 * number for number, status in enumerate(statuses)}
        assert Counter(observer.node_names)["perception_node"] == 1


def test_simulated_time_is_that_of_the_newest_ground_truth(ros_context: Any) -> None:
    node = ros_context.add(Node("sim_node", context=ros_context.context))
    with SceneObserver(context=ros_context.context) as observer:
        assert observer.simulated_seconds == 0.0 and observer.truth is None
        publisher = node.create_publisher(SceneGraph, "sim/ground_truth", LATCHED)
        header = Header(stamp=stamp_from_nanoseconds(12_500_000_000))
        publisher.publish(SceneGraph(header=header))
        ros_context.wait_until(lambda: observer.truth is not None)
        assert observer.simulated_seconds == pytest.approx(12.5)
