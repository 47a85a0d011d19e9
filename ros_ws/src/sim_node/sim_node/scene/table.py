# SPDX-License-Identifier: Apache-2.0
"""The table, what of it the arm reaches, and the places on it."""

from __future__ import annotations

import itertools
from collections.abc import Iterable, Sequence
from typing import Final

import numpy as np

from scene_graph.places import Point

from .cameras import CameraConfig
from .errors import SceneError
from .reading import Count, read

#: The table's corners, x and y in world; its surface is at z = 0 [m].
TABLE_LOWER: Final = (-0.15, -0.6)
TABLE_UPPER: Final = (0.85, 0.6)
#: How far from the arm's axis a hand that points down puts blocks [m].
REACH: Final = (0.30, 0.75)
#: What the arm's foot takes of the table [m].
BASE_RADIUS: Final = 0.16
#: How high it can stack blocks [m].
HIGHEST_STACK: Final = 0.5
#: How many places there can be.
MOST_PLACES: Final = 8
#: Between the edges of blocks on neighbouring places [m].
_LEAST_GAP: Final = 0.01
#: Places of two rows differ in their distance from the camera by more than those of one [m].
_ROW_DEPTH: Final = 0.06


def read_places(data: object, key: str) -> tuple[Point, ...]:
    """Places as [x, y] on the table; raises SceneError."""
    places = read(tuple[tuple[float, float], ...], data, key)
    Count(1, MOST_PLACES).check(places, key)
    return tuple((x, y, 0.0) for x, y in places)


def check_places(places: Sequence[Point], widest: float, camera: CameraConfig, key: str) -> None:
    """Raises SceneError for places where no stacks can stand, or not in this order.

    Args:
        widest: longest horizontal edge of a block [m].
        camera: they are numbered as it sees them.
    """
    low, high = np.array(TABLE_LOWER) + 0.5 * widest, np.array(TABLE_UPPER) - 0.5 * widest
    for number, (x, y, _) in enumerate(places):
        here = f"{key}[{number}]"
        if not (low[0] <= x <= high[0] and low[1] <= y <= high[1]):
            raise SceneError(
                here,
                f"= {[x, y]} is off the table; blocks can stand from {_rounded(low)} to "
                f"{_rounded(high)}",
            )
        if not REACH[0] <= np.hypot(x, y) <= REACH[1]:
            raise SceneError(
                here,
                f"= {[x, y]} is {np.hypot(x, y):.2f} m from the arm's axis, which reaches "
                f"{REACH[0]:g} to {REACH[1]:g} m",
            )
    for (i, one), (j, other) in itertools.combinations(enumerate(places), 2):
        distance = float(np.hypot(one[0] - other[0], one[1] - other[1]))
        if distance < widest + _LEAST_GAP:
            raise SceneError(
                f"{key}[{j}]",
                f"= {list(other[:2])} is {1000 * distance:.0f} mm from {key}[{i}]; blocks of "
                f"{1000 * widest:.0f} mm need {1000 * (widest + _LEAST_GAP):.0f} mm",
            )
    _check_order(places, camera, key)


def _check_order(places: Sequence[Point], camera: CameraConfig, key: str) -> None:
    """One row from the left, or two, each from the left, the nearer one to the camera first."""
    column, _, depth = camera.pixels(np.array(places, dtype=float).reshape(-1, 3)).T
    begins = [i for i in range(1, len(places)) if column[i] < column[i - 1]]
    if len(begins) == 1 and depth[begins[0] :].min() > depth[: begins[0]].max() + _ROW_DEPTH:
        return
    if begins:
        raise SceneError(
            f"{key}[{begins[-1]}]",
            f"is left of {key}[{begins[-1] - 1}] in the picture; places are numbered from the left "
            "in one row, or in two of which the one nearer to the camera comes first",
        )


def _rounded(values: Iterable[float]) -> list[float]:
    return [round(float(value), 3) for value in values]
