# SPDX-License-Identifier: Apache-2.0
"""Things that stand around and are no blocks: walls, posts, trays; what a scene file says of them.

The list ``obstacles`` of a file is that of ``sim_node``'s scenes, so that one file serves both::

    obstacles:
      - {name: wall, size: [0.20, 0.02, 0.12], position: [0.5, 0.075]}
      - {name: post, shape: cylinder, size: [0.04, 0.04, 0.25], position: [0.45, -0.32]}

Frame ``world``: the arm's base, the table at z = 0; metres and radians.
"""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from pathlib import Path
from typing import Any, Final

import numpy as np
import yaml
from numpy.typing import NDArray

from scene_graph import BOX, CYLINDER, PRISM, SPHERE

from .errors import MotionError

Vector = tuple[float, float, float]

#: An open box: a bottom and four sides, so thick [m].
TRAY: Final = "tray"
TRAY_WALL: Final = 0.004
SHAPES: Final = (BOX, CYLINDER, SPHERE, PRISM, TRAY)
#: Shapes that look the same from above however they are turned.
ROUND: Final = (CYLINDER, SPHERE)
#: More are not read.
MOST: Final = 30
#: Sizes and distances from the arm's base that make sense [m].
_SIZES: Final = (0.001, 2.0)
_FARTHEST: Final = 3.0
#: An axis this near to vertical is.
_UPRIGHT: Final = 1 - 1e-6
#: Keys of a scene's obstacles that say nothing about where they are.
_UNUSED: Final = ("color", "mass", "friction")
_KEYS: Final = ("name", "shape", "size", "position", "yaw", *_UNUSED)


class ObstacleError(MotionError):
    """Obstacles cannot be used; the sentence names the file or the marker, and the key.

    ``frame``: whether it is because of their frame; ``number``: because there are too many.
    """

    def __init__(self, message: str, frame: bool = False, number: bool = False) -> None:
        super().__init__(message)
        self.frame, self.number = frame, number


@dataclass(frozen=True)
class Obstacle:
    """An upright box, or the upright cylinder in it; what is not round counts as its box.

    Attributes:
        name: as it appears in reasons.
        size: full extents along its own axes [m].
        position_world: of its middle [m].
        yaw: about the world's z axis [rad].
        round: whether its outline from above is the circle of diameter ``size[0]``.
    """

    name: str
    size: Vector
    position_world: Vector
    yaw: float = 0.0
    round: bool = False

    @property
    def top(self) -> float:
        """Height of its upper end [m]."""
        return self.position_world[2] + self.size[2] / 2


def read_obstacles(path: str) -> tuple[Obstacle, ...]:
    """The obstacles of a YAML file: its list ``obstacles``, or all of it if it is a list.

    Args:
        path: of the file; empty: there are no obstacles.

    Raises:
        ObstacleError: if it cannot be read or used.
    """
    if not path:
        return ()
    try:
        data = yaml.safe_load(Path(path).expanduser().read_text(encoding="utf-8"))
    except (OSError, UnicodeDecodeError) as error:
        reason = getattr(error, "strerror", None) or "it is not a text"
        raise ObstacleError(f"{path!r} cannot be read: {reason}") from error
    except (yaml.YAMLError, ValueError) as error:
        mark = getattr(error, "problem_mark", None)
        line = f", line {mark.line + 1}" if mark else ""
        raise ObstacleError(f"{path!r} is no YAML{line}") from error
    try:
        return obstacles_from(data)
    except ObstacleError as error:
        raise ObstacleError(f"{path!r}: {error}") from error


def obstacles_from(data: object) -> tuple[Obstacle, ...]:
    """The obstacles of plain data, a list or a mapping with the key ``obstacles``.

    Raises:
        ObstacleError: the sentence names the key and what is possible.
    """
    listed = data.get("obstacles") if isinstance(data, Mapping) else data
    listed = [] if listed is None else listed
    if not isinstance(listed, list | tuple) or len(listed) > MOST:
        raise ObstacleError(f"obstacles is not a list of at most {MOST} things")
    found: list[Obstacle] = []
    names: set[str] = set()
    for number, item in enumerate(listed):
        parts = _obstacle(item, f"obstacles[{number}]")
        if parts[0].name in names:
            raise ObstacleError(
                f"obstacles[{number}].name = {parts[0].name!r}: each has a name of its own"
            )
        names.add(parts[0].name)
        found += parts
    return tuple(found)


def _obstacle(data: object, key: str) -> list[Obstacle]:
    if not isinstance(data, Mapping):
        raise ObstacleError(f"{key} is not a mapping with name, size and position")
    for name in data:
        if name not in _KEYS:
            raise ObstacleError(f"{key}.{name} is unknown; known: {', '.join(_KEYS)}")
    name = data.get("name")
    if not isinstance(name, str) or not name:
        raise ObstacleError(f"{key}.name = {name!r}: each has a name of its own")
    shape = data.get("shape", BOX)
    if shape not in SHAPES:
        raise ObstacleError(f"{key}.shape = {shape!r} is unknown; known: {', '.join(SHAPES)}")
    size = _numbers(data.get("size", (0.05, 0.05, 0.05)), f"{key}.size", (3,), *_SIZES)
    far = (-_FARTHEST, _FARTHEST)
    position = _numbers(data.get("position", ()), f"{key}.position", (2, 3), *far)
    (yaw,) = _numbers([data.get("yaw", 0.0)], f"{key}.yaw", (1,), -7.0, 7.0)
    if shape in ROUND and size[0] != size[1]:
        raise ObstacleError(f"{key}.size = {list(size)}: a {shape} is as deep as it is wide")
    x, y, *rest = position
    z = rest[0] if rest else size[2] / 2
    whole = Obstacle(name, (size[0], size[1], size[2]), (x, y, z), yaw, shape in ROUND)
    return _tray(whole) if shape == TRAY else [whole]


def upright_box(
    name: str, size: Vector, position_world: Vector, rotation: NDArray[np.float64]
) -> Obstacle:
    """The upright box around a box however it is turned, itself if it stands upright.

    Args:
        rotation: its axes in world, one a column, shape (3, 3).
    """
    level = np.hypot(rotation[0], rotation[1]) * size
    longest = int(np.argmax(level))
    yaw = float(np.arctan2(rotation[1, longest], rotation[0, longest]))
    cos, sin = math.cos(yaw), math.sin(yaw)
    own = np.array([[cos, sin, 0.0], [-sin, cos, 0.0], [0.0, 0.0, 1.0]]) @ rotation
    x, y, z = (float(extent) for extent in np.abs(own) @ np.array(size))
    return Obstacle(name, (x, y, z), position_world, yaw)


def upright_cylinder(
    name: str, size: Vector, position_world: Vector, rotation: NDArray[np.float64]
) -> Obstacle:
    """A cylinder about its third axis: itself if it stands upright, else the box around it."""
    if abs(rotation[2, 2]) > _UPRIGHT and size[0] == size[1]:
        return Obstacle(name, size, position_world, 0.0, round=True)
    return upright_box(name, size, position_world, rotation)


def capsule(name: str, ends_world: tuple[Vector, Vector], radius: float) -> Obstacle:
    """The upright cylinder or box around all that is within a radius of a line [m]."""
    first, second = np.array(ends_world[0]), np.array(ends_world[1])
    x, y, z = (float(value) for value in (first + second) / 2)
    way = second - first
    level, rise = float(np.hypot(way[0], way[1])), abs(float(way[2]))
    size = (level + 2 * radius, 2 * radius, rise + 2 * radius)
    yaw = float(np.arctan2(way[1], way[0]))
    return Obstacle(name, size, (x, y, z), yaw, round=level == 0.0)


def within_range(item: Obstacle, key: str) -> Obstacle:
    """The obstacle, if its numbers make sense.

    Raises:
        ObstacleError: as for those of a file; the sentence begins with ``key``.
    """
    _numbers(item.size, f"{key}.size", (3,), *_SIZES)
    _numbers(item.position_world, f"{key}.position", (3,), -_FARTHEST, _FARTHEST)
    return item


def _numbers(
    value: Any, key: str, counts: tuple[int, ...], low: float, high: float
) -> tuple[float, ...]:
    wanted = " or ".join(map(str, counts))
    if not isinstance(value, Sequence) or isinstance(value, str) or len(value) not in counts:
        raise ObstacleError(f"{key} = {value!r} is not a list of {wanted} numbers")
    for number in value:
        if isinstance(number, bool) or not isinstance(number, int | float):
            raise ObstacleError(f"{key} = {value!r} is not a list of {wanted} numbers")
        if not math.isfinite(number) or not low <= number <= high:
            raise ObstacleError(f"{key} = {value!r} is out of range; {low:g} to {high:g}")
    return tuple(float(number) for number in value)


def _tray(whole: Obstacle) -> list[Obstacle]:
    """Its bottom and its sides."""
    (width, depth, height), (x, y, z) = whole.size, whole.position_world
    cos, sin, half = math.cos(whole.yaw), math.sin(whole.yaw), TRAY_WALL / 2

    def part(size: Vector, along: float, across: float, lift: float) -> Obstacle:
        at = (x + cos * along - sin * across, y + sin * along + cos * across, z + lift)
        return replace(whole, size=size, position_world=at)

    return [
        part((width, depth, TRAY_WALL), 0.0, 0.0, half - height / 2),
        part((TRAY_WALL, depth, height), half - width / 2, 0.0, 0.0),
        part((TRAY_WALL, depth, height), width / 2 - half, 0.0, 0.0),
        part((width, TRAY_WALL, height), 0.0, half - depth / 2, 0.0),
        part((width, TRAY_WALL, height), 0.0, depth / 2 - half, 0.0),
    ]
