# SPDX-License-Identifier: Apache-2.0
"""What stands where: the description of a scene, its checks, and its YAML files.

``config`` has it all together; ``blocks``, ``obstacles``, ``cameras`` and ``table`` have the values
of each part beside what is impossible of them; ``reading`` turns plain data into those values,
and ``files`` finds the data.
"""

from .blocks import Block, Blocks, NamedBlock, Span
from .cameras import CameraConfig
from .config import ArmConfig, Light, SceneConfig, check_scene
from .errors import SceneError
from .files import example_scenes, load_scene, parse_scene
from .obstacles import Obstacle

__all__ = [
    "ArmConfig",
    "Block",
    "Blocks",
    "CameraConfig",
    "Light",
    "NamedBlock",
    "Obstacle",
    "SceneConfig",
    "SceneError",
    "Span",
    "check_scene",
    "example_scenes",
    "load_scene",
    "parse_scene",
]
