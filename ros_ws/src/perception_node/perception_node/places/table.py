# SPDX-License-Identifier: Apache-2.0
"""Whether the table is where places, camera and depth say that it is."""

from __future__ import annotations

import functools
from typing import Final

import numpy as np
from numpy.typing import NDArray

from perception_node.camera import PinholeCamera
from perception_node.masks import pixels_of
from perception_node.observation import Observation
from perception_node.quantiles import quantiles
from perception_node.segment import Segments

from .standing import Places, Points

#: The table around the places is looked at as far as this from the outer ones [m].
MARGIN: Final = 0.12
#: More than this is no noise of a depth camera [m].
MAX_OFFSET: Final = 0.015
#: A surface whose middle half is spread by more than this is not a table [m].
MAX_SPREAD: Final = 0.006
#: Of the picture about so many pixels are looked at, on a grid,
LOOKED_AT: Final = 128**2
#: and fewer than this of the table say nothing.
MIN_PIXELS: Final = 50


def table_problem(observation: Observation, segments: Segments, places: Places) -> str:
    """A sentence if a flat surface is seen where the table should be, but higher or lower.

    Nothing is said without depth, camera or places, or where too little of the table is seen.
    """
    depth, camera = observation.depth, observation.camera
    if depth is None or camera is None or not places.places:
        return ""
    positions = tuple(place.position_world for place in places.places)
    height = _height(positions)
    step = max(1, round((depth.size / LOOKED_AT) ** 0.5))
    rows, columns, down = _on_table(camera, positions, step)
    measured = depth[rows, columns]
    known = (segments.label_image[rows, columns] == 0) & np.isfinite(measured) & (measured > 0.0)
    if np.count_nonzero(known) < MIN_PIXELS:
        return ""
    offsets = camera.position_world[2] + down[known] * measured[known] - height
    first, middle, last = quantiles(offsets, 0.25, 0.5, 0.75)
    if abs(middle) <= MAX_OFFSET or last - first > MAX_SPREAD:
        return ""
    side = "above" if middle > 0.0 else "below"
    return (
        f"what should be the table is measured {1000 * abs(middle):.0f} mm {side} it; check the "
        "depth camera, camera/extrinsics (the calibration), and the height of the places"
    )


@functools.lru_cache(maxsize=4)
def _on_table(
    camera: PinholeCamera, places: Points, step: int
) -> tuple[NDArray[np.intp], NDArray[np.intp], NDArray[np.float64]]:
    """Pixels that show the table around the places, if nothing is on it, on a grid of ``step``.

    Returns:
        Their rows and columns, and z of their rays, shape (n,) each.
    """
    feet = np.array(places)
    grid = np.ones((-(-camera.height // step), -(-camera.width // step)), bool)
    rows, columns = (step * index for index in pixels_of(grid))
    rays = camera.rays_world(np.stack([columns, rows], axis=-1))
    with np.errstate(divide="ignore", invalid="ignore"):
        reach = (_height(places) - camera.position_world[2]) / rays[:, 2]
        hits = camera.position_world + rays * reach[:, None]
    low, high = feet[:, :2].min(axis=0) - MARGIN, feet[:, :2].max(axis=0) + MARGIN
    inside = (reach > 0.0) & ((hits[:, :2] > low) & (hits[:, :2] < high)).all(axis=1)
    return rows[inside], columns[inside], rays[inside, 2]


def _height(places: Points) -> float:
    """Of the table [m]."""
    return float(np.median([z for _, _, z in places]))
