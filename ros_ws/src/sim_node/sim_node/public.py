# SPDX-License-Identifier: Apache-2.0
"""What ``sim_node`` exports; see there."""

from .controller import ArmController
from .frame import Frame
from .generators import GENERATORS, generate_layout
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
from .scene import (
    Block,
    CameraConfig,
    Obstacle,
    SceneConfig,
    SceneError,
    example_scenes,
    load_scene,
    parse_scene,
)
from .sensor import (
    ColorConfig,
    DeliveryConfig,
    DepthConfig,
    SegmentationConfig,
    SensorConfig,
    sense,
)
from .simulated_arms import SIMULATED_ARMS, SimulatedArm
from .stock_controller import TwoControllers
from .trajectory import JointLimits, Trajectory, TrajectoryError
from .urdf import robot_description
from .world import World

__all__ = [
    "GENERATORS",
    "SIMULATED_ARMS",
    "ArmController",
    "Block",
    "CameraConfig",
    "ColorConfig",
    "DeliveryConfig",
    "DepthConfig",
    "Frame",
    "JointLimits",
    "LayoutError",
    "Obstacle",
    "SceneConfig",
    "SceneError",
    "SegmentationConfig",
    "SensorConfig",
    "SimulatedArm",
    "Trajectory",
    "TrajectoryError",
    "TwoControllers",
    "World",
    "all_layouts",
    "check_layout",
    "example_scenes",
    "format_layout",
    "generate_layout",
    "load_scene",
    "parse_layout",
    "parse_scene",
    "random_arrangement",
    "random_layout",
    "robot_description",
    "sense",
    "true_scene_graph",
]
