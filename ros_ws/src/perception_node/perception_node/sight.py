# SPDX-License-Identifier: Apache-2.0
"""Whether a picture shows the places at all: what is not seen is not free."""

from __future__ import annotations

import functools
from typing import Final

import numpy as np
from numpy.typing import NDArray

from scene_graph import BlockPose, Place, base_name

from .camera import PinholeCamera
from .config import PerceptionConfig
from .errors import BlockImageError
from .light import color_names
from .masks import pixels_of
from .names import mean_colors
from .observation import Observation
from .places import Places
from .places.occlusion import box_part
from .segment import Segments

Mask = NDArray[np.bool_]

#: At the foot of a place there is the table or a block; so wide and high is what is looked at [m].
FOOT: Final = (0.04, 0.04, 0.02)
#: Depth may be unknown at this share of it: cameras lose the edges of blocks.
MAX_UNKNOWN: Final = 0.6
#: Pixels that are no brighter than this and have no depth show nothing [0..255]; this share of a
#: column may be so.
BLACK: Final = 2
MAX_BLACK: Final = 0.02
#: Right above a column, so high, nothing is [m], but for as many stray pixels.
ABOVE: Final = 0.03
STRAY: Final = 10
#: Depth is as exact as this [m].
EXACT: Final = 0.008


def sight_problem(
    observation: Observation, segments: Segments, places: Places, config: PerceptionConfig
) -> str:
    """A sentence about the first place, or block, that is not wholly in the picture; or nothing.

    Nothing is said without camera or places, or of masks that came without depth.

    Raises:
        BlockImageError: it is one block only, which reaches the edge of the picture.
    """
    depth, camera = observation.depth, observation.camera
    if camera is None or not places.places or (depth is None and segments.hides is None):
        return ""
    for place in places.places:
        name = base_name(place.index)
        if not _inside(camera, _box(place, 0.0, FOOT)):
            return f"{name} is not in the picture; turn the camera, or correct its calibration"
        part, region = box_part(camera, _box(place, 0.0, FOOT))
        bare = _bare(observation, segments, part) & region
        if depth is not None and _share(bare, region) > MAX_UNKNOWN:
            return (
                f"whether anything stands on {name} is not known, as there is no depth; check the "
                "depth camera, and that nothing is before it"
            )
        width = 2.0 * config.column_half_width
        part, region = box_part(camera, _box(place, 0.0, (width, width, config.column_height)))
        black = _bare(observation, segments, part) & region
        for channel in range(3):
            black &= observation.rgb[part][..., channel] <= BLACK
        if _share(black, region) > MAX_BLACK:
            bare_too = "" if depth is None else " and has no depth"
            return (
                f"part of what is over {name} is black{bare_too}; is the lens partly covered, or "
                "part of the picture lost?"
            )
        if depth is not None and _is_higher(place, segments, observation, camera, config):
            return (
                f"what stands on {name} is higher than {config.column_height:g} m; set "
                "column_height to the height of the highest tower"
            )
    _check_edges(observation.rgb, segments)
    return ""


def _box(place: Place, lift: float, size: tuple[float, float, float]) -> BlockPose:
    """A box that stands so high over a place."""
    x, y, z = place.position_world
    return BlockPose((x, y, z + lift + 0.5 * size[2]), 0.0, size)


@functools.lru_cache(maxsize=32)
def _inside(camera: PinholeCamera, box: BlockPose) -> bool:
    half = 0.5 * np.array(box.size)
    corners = np.array([[i, j, -1.0] for i in (-1.0, 1.0) for j in (-1.0, 1.0)]) * half
    pixels = camera.project(corners + box.position_world)
    with np.errstate(invalid="ignore"):
        return bool(((pixels >= 0) & (pixels <= (camera.width - 1, camera.height - 1))).all())


def _is_higher(
    place: Place,
    segments: Segments,
    observation: Observation,
    camera: PinholeCamera,
    config: PerceptionConfig,
) -> bool:
    """Whether a stack reaches to the top of a column and goes on beyond: not an arm over it."""
    assert observation.depth is not None
    width = 2.0 * config.column_half_width
    ends = _box(place, config.column_height - ABOVE, (width, width, 2.0 * ABOVE))
    rows, columns, rays = _rays(camera, ends)
    if np.count_nonzero(segments.label_image[rows, columns]) <= STRAY:
        return False
    known = _known(observation.depth[rows, columns])
    rows, columns, rays = rows[known], columns[known], rays[known]
    points = camera.position_world + rays * observation.depth[rows, columns, None]
    off = points - place.position_world
    inside = np.abs(off[:, :2]).max(axis=1, initial=0.0) < config.column_half_width
    higher = off[:, 2] - config.column_height
    beyond = inside & (higher > EXACT) & (higher < ABOVE)
    below = (
        inside & (higher > -EXACT) & (higher <= EXACT) & (segments.label_image[rows, columns] > 0)
    )
    return min(int(np.count_nonzero(beyond)), int(np.count_nonzero(below))) > STRAY


@functools.lru_cache(maxsize=32)
def _rays(
    camera: PinholeCamera, box: BlockPose
) -> tuple[NDArray[np.intp], NDArray[np.intp], NDArray[np.float64]]:
    """Rows, columns and rays of the pixels behind which a box may be, (n,), (n,), (n, 3)."""
    part, region = box_part(camera, box)
    rows, columns = pixels_of(region)
    rows, columns = rows + part[0].start, columns + part[1].start
    return rows, columns, camera.rays_world(np.stack([columns, rows], axis=-1))


def _check_edges(rgb: NDArray[np.uint8], segments: Segments) -> None:
    """Raises BlockImageError for a block at the picture's edge, beyond which there may be more."""
    parts = [segment.part for segment in segments]
    for index, part in enumerate(parts):
        for side, edge in (
            ("left", part[:, 0]),
            ("right", part[:, -1]),
            ("upper", part[0]),
            ("lower", part[-1]),
        ):
            if edge.any():
                color = color_names(mean_colors(rgb, parts))[index]
                raise BlockImageError(
                    f"the {color} block reaches the {side} edge of the picture, so it is not known "
                    "what is beyond; turn the camera, or move it away",
                    segments.blocks[index].label,
                )


def _known(depth: NDArray[np.floating]) -> Mask:
    with np.errstate(invalid="ignore"):
        return np.asarray((depth > 0.0) & np.isfinite(depth))


def _bare(observation: Observation, segments: Segments, part: tuple[slice, slice]) -> Mask:
    """Which pixels of a part of the picture have neither depth nor a label."""
    bare = segments.label_image[part] == 0
    return bare if observation.depth is None else bare & ~_known(observation.depth[part])


def _share(some: Mask, region: Mask) -> float:
    return int(np.count_nonzero(some)) / max(1, int(np.count_nonzero(region)))
