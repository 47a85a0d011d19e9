# SPDX-License-Identifier: Apache-2.0
"""``ros2 launch tamp_bringup demo.launch.py``, as far as it runs without ROS's launch.

What the file asks of launch is recorded by a stand-in; whether parameters take effect is decided by
the real rcl, given the files that launch_ros would give it.
"""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path
from typing import Any

import pytest
import yaml
from launch_stand_in import EmitEvent, Launched, LogInfo, Node, RegisterEventHandler, Shutdown
from rclpy.context import Context
from rclpy.node import Node as RosNode

CONFIG = Path(__file__).parents[3] / "ros_ws/src/tamp_bringup/config"
GRAPH = ["sim_node", "perception_node", "planner_node", "motion_node"]
Launch = Callable[..., Launched]


@pytest.fixture
def launch(monkeypatch: pytest.MonkeyPatch) -> Launch:
    def run(*missing: str, **given: str) -> Launched:
        return Launched(monkeypatch, {*GRAPH, "tamp_bringup", "rviz2"} - {*missing}, given)

    return run


def parameters_of(node: Node, folder: Path) -> dict[str, Any]:
    """The parameters that the process of a node would have; launch_ros writes dicts into files."""
    arguments = ["--ros-args"]
    for index, item in enumerate(node.parameters):
        path = Path(item) if isinstance(item, str) else folder / f"{index}.yaml"
        if isinstance(item, dict):
            path.write_text(yaml.dump({"/**": {"ros__parameters": item}}))
        arguments += ["--params-file", str(path)]
    context = Context()
    context.init()
    ros_node = RosNode(
        node.package,
        context=context,
        namespace=node.namespace,
        cli_args=arguments,
        use_global_arguments=False,
        automatically_declare_parameters_from_overrides=True,
        start_parameter_services=False,
    )
    try:
        return {name: item.value for name, item in ros_node._parameters.items()}
    finally:
        ros_node.destroy_node()
        context.shutdown()


def test_the_four_nodes_are_started_and_nothing_else(launch: Launch) -> None:
    assert list(launch().nodes) == GRAPH


def test_fault_7_every_argument_is_described_and_has_a_default(launch: Launch) -> None:
    arguments = launch().arguments
    assert set(arguments) == {
        *("seed", "blocks", "real_time_factor", "simulation", "namespace", "rviz")
    }
    for argument in arguments.values():
        assert argument.description and argument.default_value is not None


@pytest.mark.parametrize("namespace", ["", "left"])
def test_fault_7_arguments_win_over_the_parameter_file(
    launch: Launch, tmp_path: Path, namespace: str
) -> None:
    nodes = launch(real_time_factor="5.0", seed="3", blocks="6", namespace=namespace).nodes
    simulator = parameters_of(nodes["sim_node"], tmp_path)
    assert simulator["real_time_factor"] == 5.0
    assert (simulator["seed"], simulator["blocks"]) == (3, 6)
    assert simulator["use_sim_time"] is False, "it is the clock"
    for name in GRAPH[1:]:
        assert parameters_of(nodes[name], tmp_path)["use_sim_time"] is True


def test_fault_7_without_the_simulator_the_nodes_have_wall_time(
    launch: Launch, tmp_path: Path
) -> None:
    nodes = launch(simulation="false").nodes
    assert list(nodes) == GRAPH[1:]
    for node in nodes.values():
        assert parameters_of(node, tmp_path)["use_sim_time"] is False


@pytest.mark.parametrize(
    ("given", "sentence"),
    [
        ({"real_time_factor": "fast"}, "real_time_factor:=fast is not a number"),
        ({"blocks": "5.5"}, "blocks:=5.5 is not a whole number"),
        ({"rviz": "perhaps"}, "rviz"),
    ],
)
def test_an_argument_that_makes_no_sense_starts_nothing(
    launch: Launch, given: dict[str, str], sentence: str
) -> None:
    with pytest.raises(RuntimeError, match=sentence):
        launch(**given)


def test_fault_7_without_rviz2_the_graph_runs_and_says_so(launch: Launch) -> None:
    launched = launch("rviz2", rviz="true")
    assert list(launched.nodes) == GRAPH
    assert "rviz2 is not installed" in launched.said[0]
    assert list(launch(rviz="true").nodes) == [*GRAPH, "rviz2"]


def test_fault_7_where_a_node_is_missing_no_other_is_started(launch: Launch) -> None:
    with pytest.raises(RuntimeError, match="motion_node; nothing was started"):
        launch("motion_node")


@pytest.mark.parametrize("name", GRAPH)
def test_fault_7_when_a_node_ends_it_is_said_and_the_rest_is_stopped(
    launch: Launch, name: str
) -> None:
    launched = launch(rviz="true")
    said, stop = launched.end(name, -9)
    assert isinstance(said, LogInfo) and f"{name} ended with exit code -9" in said.msg
    assert isinstance(stop, EmitEvent) and isinstance(stop.event, Shutdown)
    assert name in stop.event.reason
    # It is listened for before the node is started, which may end at once.
    kinds = [type(item) for item in launched.entities]
    assert kinds.index(RegisterEventHandler) < kinds.index(Node)
    launched.context.is_shutdown = True  # Ctrl-C ends all of them
    assert launched.end(name, 0) == []


def test_a_closed_rviz_leaves_the_graph_alone(launch: Launch) -> None:
    assert launch(rviz="true").end("rviz2", 0) == []


def test_fault_6_in_a_namespace_everything_is_in_it(launch: Launch) -> None:
    for node in launch(namespace="/left/", rviz="true").nodes.values():
        assert node.namespace == "/left"
        assert dict(node.remappings) == {"/clock": "clock", "/tf": "tf", "/tf_static": "tf_static"}


def test_fault_6_rviz_names_no_topic_absolutely() -> None:
    topics: list[str] = []

    def collect(item: Any) -> None:
        if isinstance(item, dict):
            for key, value in item.items():
                if key.endswith("Topic") and isinstance(value, dict):
                    topics.append(value["Value"])
                collect(value)
        elif isinstance(item, list):
            for value in item:
                collect(value)

    collect(yaml.safe_load((CONFIG / "demo.rviz").read_text()))
    assert len(topics) == 3
    assert not [topic for topic in topics if topic.startswith("/")]
