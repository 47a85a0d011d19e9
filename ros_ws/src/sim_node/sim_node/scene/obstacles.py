# SPDX-License-Identifier: Apache-2.0
"""Things that are not blocks: walls, trays, clutter."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Annotated, Final

import numpy as np
from numpy.typing import NDArray

from scene_graph import BOX, COLORS, CYLINDER, PRISM, SPHERE

from .errors import SceneError
from .reading import Count, OneOf, ReadBy, Within, read
from .table import BASE_RADIUS, TABLE_LOWER, TABLE_UPPER

Vector = tuple[float, float, float]

#: An open box: a bottom and four sides.
TRAY: Final = "tray"
OBSTACLE_SHAPES: Final = (BOX, CYLINDER, SPHERE, PRISM, TRAY)
#: How thick bottom and sides of a tray are [m].
TRAY_WALL: Final = 0.004


def _read_position(data: object, key: str) -> tuple[float, ...]:
    """[x, y, z] of the middle, or [x, y]: it stands on the table."""
    position: tuple[float, ...] = read(tuple[float, ...], data, key)
    Count(2, 3).check(position, key)
    return position


def _read_color(data: object, key: str) -> Vector:
    """[r, g, b] in 0..1, or the name of a colour."""
    if isinstance(data, str):
        OneOf(tuple(COLORS)).check(data, key)
        return COLORS[data]
    color: Vector = read(tuple[float, float, float], data, key)
    return color


@dataclass(frozen=True)
class Obstacle:
    """Something that stands or lies around, with label 0 in the pictures.

    Attributes:
        name: for sentences.
        shape: one of :data:`OBSTACLE_SHAPES`.
        size: full extents along its own axes [m].
        position: of its middle [m]; two numbers: it stands on the table.
        yaw: about the world's z axis [rad].
        color: sRGB in 0..1.
        mass: [kg]; 0: it never moves.
        friction: lateral.
    """

    name: str = ""
    shape: Annotated[str, OneOf(OBSTACLE_SHAPES)] = BOX
    size: Annotated[Vector, Within(0.005, 1.2, "m")] = (0.05, 0.05, 0.05)
    position: Annotated[tuple[float, ...], ReadBy(_read_position), Within(-2.0, 2.0, "m")] = ()
    yaw: Annotated[float, Within(-7.0, 7.0, "rad")] = 0.0
    color: Annotated[Vector, ReadBy(_read_color), Within(0.0, 1.0)] = (0.6, 0.6, 0.6)
    mass: Annotated[float, Within(0.0, 10.0, "kg")] = 0.0
    friction: Annotated[float, Within(0.05, 2.0)] = 0.9

    @property
    def position_world(self) -> Vector:
        """Of its middle [m]."""
        x, y, *rest = self.position
        return (x, y, rest[0] if rest else 0.5 * self.size[2])

    @property
    def lies_still(self) -> bool:
        """Whether it never moves."""
        return self.mass == 0.0

    def distance_to(self, point: Sequence[float]) -> float:
        """From a point of the table to what it covers, seen from above, 0 inside [m]."""
        x, y = np.subtract(point[:2], self.position[:2])
        cosine, sine = np.cos(self.yaw), np.sin(self.yaw)
        own = np.abs([cosine * x + sine * y, -sine * x + cosine * y])
        if self.shape in (CYLINDER, SPHERE):
            return max(0.0, float(np.hypot(*own)) - 0.5 * self.size[0])
        return float(np.linalg.norm(np.maximum(own - 0.5 * np.array(self.size[:2]), 0.0)))


def check_obstacles(
    obstacles: Sequence[Obstacle], places_world: NDArray[np.float64], widest: float, key: str
) -> None:
    """Raises SceneError for things that cannot be where they are said to be.

    Args:
        places_world: shape (m, 3) [m].
        widest: longest horizontal edge of a block [m].
    """
    names: list[str] = []
    for number, item in enumerate(obstacles):
        here = f"{key}[{number}]"
        if not item.name or item.name in names:
            raise SceneError(f"{here}.name", f"= {item.name!r}: each has a name of its own")
        names.append(item.name)
        _check_form(item, here)
        _check_spot(item, here)
        clearance = 0.5 * np.sqrt(2.0) * widest
        for place, centre in enumerate(places_world):
            if item.distance_to(centre) < clearance:
                raise SceneError(
                    f"{here}.position",
                    f"= {list(item.position)} puts {item.name} on places[{place}]; "
                    f"{1000 * clearance:.0f} mm around its centre have to be free",
                )


def _check_form(item: Obstacle, key: str) -> None:
    size = item.size
    if item.shape == SPHERE and len(set(size)) > 1:
        raise SceneError(f"{key}.size", f"= {list(size)}: a sphere has one size, thrice")
    if item.shape == CYLINDER and size[0] != size[1]:
        raise SceneError(f"{key}.size", f"= {list(size)}: a cylinder is [d, d, height]")
    if item.shape == TRAY and (min(size[:2]) < 4 * TRAY_WALL or size[2] < 2 * TRAY_WALL):
        raise SceneError(f"{key}.size", f"= {list(size)}: nothing is left inside of the tray")


def _check_spot(item: Obstacle, key: str) -> None:
    if not item.position:
        raise SceneError(f"{key}.position", "is missing; [x, y] on the table, or [x, y, z]")
    x, y, z = item.position_world
    low = z - 0.5 * item.size[2]
    if low < -1e-6:
        raise SceneError(
            f"{key}.position",
            f"= {list(item.position)}: {item.name} would reach {-1000 * low:.0f} mm into the table",
        )
    if not (TABLE_LOWER[0] < x < TABLE_UPPER[0] and TABLE_LOWER[1] < y < TABLE_UPPER[1]):
        raise SceneError(
            f"{key}.position",
            f"= {list(item.position)} is not over the table, which reaches from "
            f"{list(TABLE_LOWER)} to {list(TABLE_UPPER)}",
        )
    if item.distance_to((0.0, 0.0)) < BASE_RADIUS:
        raise SceneError(
            f"{key}.position",
            f"= {list(item.position)} puts {item.name} into the arm's foot; {BASE_RADIUS:g} m "
            "around [0, 0] have to be free",
        )
