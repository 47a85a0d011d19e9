# SPDX-License-Identifier: Apache-2.0
"""Every package's algorithm imports and runs where there is neither rclpy nor any message."""

from __future__ import annotations

import subprocess
import sys
from pathlib import Path

SOURCES = Path(__file__).parents[2] / "ros_ws" / "src"
#: Where messages may be met: the node's wiring, what turns messages into values, and clients.
ROS_PARTS = (
    *("node", "conversions", "parameters", "executable", "cli", "messages"),
    *("image_client", "latent_view", "plan_publisher", "topics", "camera_topics", "view_requests"),
    "trajectory_topics",
)
#: Packages that are ROS throughout, but for the modules named.
ROS_PACKAGES = {
    "tamp_runtime": ("machine_code", "motion_report"),
    "tamp_bringup": ("task", "plan_picture"),
}

#: Makes rclpy, the interface generators' run time and every message package unimportable.
NO_ROS = """
import importlib.abc, sys
class NoRos(importlib.abc.MetaPathFinder):
    def find_spec(self, name, path=None, target=None):
        top = name.partition(".")[0]
        if top in ("rclpy", "tamp_interfaces", "ament_index_python") or top.startswith(
            ("rosidl", "rpyutils")
        ) or top.endswith(("_msgs", "_interfaces")):
            raise ImportError(f"{name} is hidden by this test")
        return None
sys.meta_path.insert(0, NoRos())
"""

RUN_ALL = """
import numpy as np
from motion_node import PANDA, MotionPlanner
from perception_node import DEFAULT_WEIGHTS, Observation, Perception, PinholeCamera, load_weights
from planner_node import make_plan, parse_goal, resolve_goal
from scene_graph import GraphStatus, format_stacks
from sim_node import World, robot_description, true_scene_graph

with World() as world:
    world.reset((("red_box", "blue_box"), (), ("green_box",)))
    frame, camera = world.render(), world.config.camera
    truth = true_scene_graph(world)
seen = Perception(load_weights(DEFAULT_WEIGHTS)).perceive(
    Observation(
        frame.rgb,
        None,
        frame.depth,
        PinholeCamera(camera.intrinsics, camera.world_from_optical, camera.width, camera.height),
    )
)
assert seen.status is GraphStatus.CONFIDENT, seen.message
assert seen.graph.stacks() == truth.stacks()
goal = resolve_goal(parse_goal("red on green"), seen.graph.names)
found = make_plan(seen.graph.stacks(), goal)
assert goal.holds(found.states[-1]) and len(found.moves) == 2
planner = MotionPlanner(robot_description())
motion = planner.solve(seen.graph, found.moves, np.array(PANDA.home), np.array([0.04, 0.04]))
print(format_stacks(found.states[-1]), round(motion.trajectory.duration))
"""


def python(code: str) -> subprocess.CompletedProcess[str]:
    return subprocess.run(
        [sys.executable, "-c", NO_ROS + code], capture_output=True, text=True, timeout=250.0
    )


def core_modules() -> list[str]:
    modules = []
    for package in sorted(SOURCES.iterdir()):
        folder = package / package.name
        for path in sorted(folder.rglob("*.py")) if folder.is_dir() else []:
            parts = path.relative_to(package).with_suffix("").parts
            inside = parts[1:]
            allowed = ROS_PACKAGES.get(package.name)
            if allowed is not None and inside not in [(name,) for name in allowed]:
                continue
            if any(part in ROS_PARTS for part in inside):
                continue
            modules.append(".".join(parts).removesuffix(".__init__"))
    return modules


def test_the_hidden_packages_are_hidden() -> None:
    for name in ("rclpy", "sensor_msgs.msg", "tamp_interfaces.msg"):
        ended = python(f"import {name}")
        assert "is hidden by this test" in ended.stderr


def test_every_core_module_imports() -> None:
    modules = core_modules()
    assert len(modules) > 60
    ended = python(f"import importlib\nfor name in {modules!r}: importlib.import_module(name)")
    assert ended.returncode == 0, ended.stderr


def test_pixels_to_trajectory_without_ros() -> None:
    ended = python(RUN_ALL)
    assert ended.returncode == 0, ended.stderr
    state, seconds = ended.stdout.rsplit(maxsplit=1)
    assert "green_box red_box" in state
    assert int(seconds) > 0
