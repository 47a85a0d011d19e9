# SPDX-License-Identifier: Apache-2.0
"""Whether the table is where places, camera and depth say that it is."""

from __future__ import annotations

from typing import Final

import numpy as np

from perception_node.masks import pixels_of
from perception_node.observation import Observation
from perception_node.segment import Segments

from .standing import Places

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
    feet = np.array([place.position_world for place in places.places])
    height = float(np.median(feet[:, 2]))
    step = max(1, round((depth.size / LOOKED_AT) ** 0.5))
    some = depth[::step, ::step]
    known = (segments.label_image[::step, ::step] == 0) & np.isfinite(some) & (some > 0.0)
    rows, columns = pixels_of(known)
    rows, columns = step * rows, step * columns
    rays = camera.rays_world(np.stack([columns, rows], axis=-1))
    with np.errstate(divide="ignore", invalid="ignore"):
        reach = (height - camera.position_world[2]) / rays[:, 2]
    hits = camera.position_world + rays * reach[:, None]
    low, high = feet[:, :2].min(axis=0) - MARGIN, feet[:, :2].max(axis=0) + MARGIN
    inside = (reach > 0.0) & ((hits[:, :2] > low) & (hits[:, :2] < high)).all(axis=1)
    if np.count_nonzero(inside) < MIN_PIXELS:
        return ""
    measured = depth[rows[inside], columns[inside]]
    offsets = camera.position_world[2] + rays[inside, 2] * measured - height
    first, middle, last = np.percentile(offsets, [25, 50, 75])
    if abs(middle) <= MAX_OFFSET or last - first > MAX_SPREAD:
        return ""
    side = "above" if middle > 0.0 else "below"
    return (
        f"what should be the table is measured {1000 * abs(middle):.0f} mm {side} it; check the "
        "depth camera, camera/extrinsics (the calibration), and the height of the places"
    )
