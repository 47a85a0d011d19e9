# SPDX-License-Identifier: Apache-2.0
"""What ``sim_node`` exports; see there."""

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
from .scene import CameraConfig, SceneConfig
from .sensor import (
    ColorConfig,
    DeliveryConfig,
    DepthConfig,
    SegmentationConfig,
    SensorConfig,
    sense,
)
from .simulated_arms import SIMULATED_ARMS, SimulatedArm
from .trajectory import JointLimits, Trajectory, TrajectoryError
from .urdf import robot_description
from .world import World

__all__ = [
    "SIMULATED_ARMS",
    "ArmController",
    "CameraConfig",
    "ColorConfig",
    "DeliveryConfig",
    "DepthConfig",
    "Frame",
    "JointLimits",
    "LayoutError",
    "SceneConfig",
    "SegmentationConfig",
    "SensorConfig",
    "SimulatedArm",
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
    "sense",
    "true_scene_graph",
]
