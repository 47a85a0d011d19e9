# SPDX-License-Identifier: Apache-2.0
"""Blocks that lie before the row of places, where nothing is planned on: they are named, too.

A block that is pushed off a tower ends up there. It is in no relation and has no size, like one
that lies among the places, see :mod:`.fallen`; only it is in nobody's way. So are those that are
seen besides a block of which a picture is refused.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace
from typing import Final

import numpy as np

from scene_graph import UNKNOWN, SceneGraph, SceneObject, object_name

from .blocks import measure
from .blocks.measure import BlockSurface, measure_blocks
from .errors import PerceptionError
from .light import color_names
from .names import mean_colors
from .observation import Observation
from .segment import Segments, Volume
from .segment.region import look_at
from .segment.rgbd import MIN_PIXELS, find_in_rgbd

#: Over the table, what is higher is worth a closer look [m].
_HIGH: Final = 0.01
#: No block is wider or higher [m], and none hangs higher over the table than this [m].
_LARGEST: Final = 0.09
_HANGS: Final = 0.015


def find_strays(
    observation: Observation, volume: Volume, segments: Segments
) -> tuple[SceneObject, ...]:
    """What looks like a block before the row; nothing where nothing is higher than the table.

    Args:
        observation: nothing is found where it has no depth or no camera.
        volume: around the places.
        segments: the blocks that were found in it.
    """
    if observation.camera is None or observation.depth is None:
        return ()
    strip = volume.before(observation.camera)
    region = look_at(observation, strip)
    if region is None:
        return ()
    with np.errstate(invalid="ignore"):
        high = region.inside & (region.points[..., 2] > strip.floor + _HIGH)
    # What reaches into it and is of a block of the row, is of that.
    row = segments.label_image > 0
    if np.count_nonzero(high & ~row[region.box]) < MIN_PIXELS:
        return ()
    try:
        found = find_in_rgbd(observation, strip)
        apart = [item for item in found if not (item.mask & row).any()]
        if not apart:
            return ()
        found = replace(found, blocks=tuple(apart))
        surfaces = measure_blocks(found, observation.depth, observation.camera, observation.noise)
    except PerceptionError:  # whatever it is, it is in nobody's way
        return ()
    objects = _objects(observation, found, surfaces)
    on_the_table = [abs(surface.low - strip.floor) < _HANGS for surface in surfaces]
    return tuple(item for item, lies in zip(objects, on_the_table) if item is not None and lies)


def seen_besides(observation: Observation, segments: Segments, label: int) -> list[SceneObject]:
    """What is seen of a scene of which a block of a label makes that nothing can be planned on."""
    others = replace(segments, blocks=tuple(item for item in segments if item.label != label))
    try:
        surfaces = measure(observation, others)
    except PerceptionError:
        return []
    return [item for item in _objects(observation, others, surfaces) if item is not None]


def _objects(
    observation: Observation, segments: Segments, surfaces: Sequence[BlockSurface]
) -> list[SceneObject | None]:
    """Measured things; None for what has no colour with a name, lies, or is larger than a block."""
    colors = color_names(mean_colors(observation.rgb, [item.part for item in segments]))
    return [
        SceneObject(
            name=object_name(color, surface.shape),
            color=color,
            shape=surface.shape,
            position_world=(*surface.position, 0.5 * (surface.low + surface.high)),
        )
        if color != UNKNOWN
        and surface.upright
        and max(surface.high - surface.low, *surface.widths) < _LARGEST
        else None
        for surface, color in zip(surfaces, colors)
    ]


def with_strays(graph: SceneGraph, strays: Sequence[SceneObject]) -> SceneGraph:
    """The graph with those of them that are not in it by their name."""
    objects = {item.name: item for item in (*strays, *graph.objects)}
    return replace(graph, objects=tuple(objects[name] for name in sorted(objects)))
