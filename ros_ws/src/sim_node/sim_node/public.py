# SPDX-License-Identifier: Apache-2.0
"""What ``sim_node`` exports; see there."""

from .arm_models import ARM_MODELS, ArmModel
from .camera import Frame
from .controller import ArmController
from .ground_truth import true_scene_graph
from .layouts import (
    LayoutError,
    all_layouts,
    check_layout,
    format_layout,
    parse_layout,
    random_arrangement,
    random_layout,
)
from .robot_description import robot_description
from .scene import CameraConfig, SceneConfig
from .trajectory import JointLimits, Trajectory, TrajectoryError
from .world import World

__all__ = [
    "ARM_MODELS",
    "ArmController",
    "ArmModel",
    "CameraConfig",
    "Frame",
    "JointLimits",
    "LayoutError",
    "SceneConfig",
    "Trajectory",
    "TrajectoryError",
    "World",
    "all_layouts",
    "check_layout",
    "format_layout",
    "parse_layout",
    "random_arrangement",
    "random_layout",
    "robot_description",
    "true_scene_graph",
]
