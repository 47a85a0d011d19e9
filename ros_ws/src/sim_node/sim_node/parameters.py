# SPDX-License-Identifier: Apache-2.0
"""The node's parameters, and the first scene that they ask for."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any, Final

from tamp_runtime.parameters import ParameterSpec

from scene_graph import Stacks

from .generators import GENERATORS, UNIFORM, requested_layout
from .layouts import MIN_RANDOM_BLOCKS
from .scene import SceneConfig
from .scene.blocks import MOST_BLOCKS
from .sensor.parameters import SENSOR_PARAMETERS
from .simulated_arms import PANDA, SIMULATED_ARMS
from .urdf import BOXES, mesh_uris_problem


def _generator_problem(name: str) -> str:
    """the name of a generator in sim_node.generators"""
    if not name or name in GENERATORS:
        return ""
    return f"generator = {name!r} is not known; known: {', '.join(GENERATORS)}"


def _robot_problem(name: str) -> str:
    """the name of an arm in sim_node.simulated_arms"""
    known = ", ".join(sorted(SIMULATED_ARMS))
    return "" if name in SIMULATED_ARMS else f"robot = {name!r} is not a known arm; known: {known}"


PARAMETERS: Final = (
    ParameterSpec(
        "real_time_factor",
        1.0,
        "simulated seconds per second; 0: as fast as it goes",
        minimum=0.0,
        maximum=1000.0,
    ),
    ParameterSpec(
        "robot", PANDA.name, "which arm stands there", read_only=True, check=_robot_problem
    ),
    ParameterSpec(
        "gripper_apart",
        False,
        "two controllers as ros2_control has them: the arm's, which hears joint_trajectory, and "
        "the gripper's, which hears gripper_trajectory; false: one of all joints",
        read_only=True,
    ),
    ParameterSpec(
        "mesh_uris",
        BOXES,
        "what robot_description says of the arm's meshes: boxes around them, which every machine "
        "can show; files: where they are on this machine; or what to put before their paths",
        read_only=True,
        check=mesh_uris_problem,
    ),
    ParameterSpec(
        "seed", 0, "seed of the first scene", minimum=0, maximum=2**31 - 1, read_only=True
    ),
    ParameterSpec(
        "blocks",
        5,
        "blocks in the first scene where it is random, at most as many as the scene allows (7 "
        "where it says nothing); one that is given as layout may have fewer",
        minimum=MIN_RANDOM_BLOCKS,
        maximum=MOST_BLOCKS,
        read_only=True,
    ),
    ParameterSpec(
        "generator",
        UNIFORM,
        "what the first scene is like where it is random: "
        + "; ".join(f"{name}: {item.meaning}" for name, item in GENERATORS.items()),
        read_only=True,
        check=_generator_problem,
    ),
    ParameterSpec(
        "scene",
        "",
        "what stands where: path of a YAML file, or the name of an example in share/sim_node/scenes"
        "; empty: three places, boxes of one size, one camera",
        read_only=True,
    ),
    ParameterSpec(
        "layout",
        [""],
        "first scene, one string a stack from the left, names from the bottom, comma separated; "
        "all empty: random by seed",
        read_only=True,
    ),
    *SENSOR_PARAMETERS,
)


def first_layout(values: Mapping[str, Any], scene: SceneConfig) -> Stacks:
    """The layout that the parameters ask for; raises LayoutError if it is impossible."""
    texts = values["layout"] if any(values["layout"]) else ()
    return requested_layout(scene, texts, values["seed"], values["blocks"], values["generator"])
