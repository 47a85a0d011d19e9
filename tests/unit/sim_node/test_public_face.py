# SPDX-License-Identifier: Apache-2.0
"""What a notebook imports from ``sim_node``: documented, without ROS, and only when asked for."""

from __future__ import annotations

import inspect
import subprocess
import sys

import pytest

import sim_node


@pytest.mark.parametrize("name", sim_node.__all__)
def test_every_exported_class_and_function_says_what_it_is(name: str) -> None:
    item = getattr(sim_node, name)
    assert inspect.getdoc(item)


def test_an_unknown_name_is_an_attribute_error() -> None:
    with pytest.raises(AttributeError, match="teapot"):
        _ = sim_node.teapot


def run(script: str) -> str:
    result = subprocess.run(
        [sys.executable, "-c", script], capture_output=True, text=True, check=True, timeout=120
    )
    return result.stdout.splitlines()[-1]


def test_the_package_itself_imports_nothing_heavy() -> None:
    """An executable imports it before it can listen to Ctrl-C."""
    script = "import sys, sim_node; print({'numpy', 'pybullet', 'rclpy'} & set(sys.modules))"
    assert run(script) == "set()"


def test_a_world_runs_where_ros_cannot_be_imported() -> None:
    blocked = "import sys; sys.modules.update(dict.fromkeys(['rclpy', 'sensor_msgs', 'std_msgs']))"
    script = (
        "from sim_node import World, random_layout, true_scene_graph\n"
        "with World() as world:\n"
        "    world.reset(random_layout(seed=3, blocks=4))\n"
        "    labels = world.render().labels\n"
        "    print(labels.max(), len(true_scene_graph(world).objects))\n"
    )
    assert run(f"{blocked}\n{script}") == "4 4"
