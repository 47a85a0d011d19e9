# SPDX-License-Identifier: Apache-2.0
"""Blocks that lie or lean: nothing is planned on them, but they do not blind for the others."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

from scene_graph import SceneGraph, SceneObject, object_name

from .blocks import BlockSurface
from .light import color_names
from .names import mean_colors
from .segment import Segments
from .visual_module.coordinates import Coordinates


@dataclass(frozen=True)
class FallenBlock:
    """A block of which no upright face is seen; or something that looks like one.

    Attributes:
        index: of its segment.
        label: of its mask.
        color: as a word.
        shape: that of the model which is least bad.
        position_world: about where its middle is [m].
        coordinates, iou: what G says of it.
    """

    index: int
    label: int
    color: str
    shape: str
    position_world: tuple[float, float, float]
    coordinates: tuple[float, float]
    iou: float


def find_fallen(
    rgb: NDArray[np.uint8],
    segments: Segments,
    surfaces: Sequence[BlockSurface],
    coordinates: Coordinates,
) -> tuple[FallenBlock, ...]:
    """Those of the blocks that were not measured as upright ones.

    Args:
        rgb: shape (height, width, 3).
        surfaces: of the segments, in their order; none where nothing was measured.
    """
    lying = [index for index, item in enumerate(surfaces) if not item.upright]
    if not lying:
        return ()
    colors = color_names(mean_colors(rgb, [segment.part for segment in segments]))
    fallen = []
    for index in lying:
        surface, (a, b) = surfaces[index], coordinates.phi[index]
        fallen.append(
            FallenBlock(
                index=index,
                label=segments.blocks[index].label,
                color=colors[index],
                shape=surface.shape,
                position_world=(*surface.position, 0.5 * (surface.low + surface.high)),
                coordinates=(float(a), float(b)),
                iou=float(coordinates.iou[index]),
            )
        )
    return tuple(fallen)


def with_fallen(graph: SceneGraph, fallen: Sequence[FallenBlock]) -> SceneGraph:
    """The graph with these blocks added: in no relation, without a size, as none is known."""
    objects = list(graph.objects)
    for block in fallen:
        name, number = object_name(block.color, block.shape), 1
        taken = {item.name for item in objects}
        while name in taken:
            number += 1
            name = f"{object_name(block.color, block.shape)}_{number}"
        objects.append(
            SceneObject(
                name=name,
                color=block.color,
                shape=block.shape,
                position_world=block.position_world,
                label=block.label,
                coordinates=block.coordinates,
                confidence=block.iou,
            )
        )
    objects.sort(key=lambda item: item.name)
    confidence = min(graph.confidence, *(block.iou for block in fallen))
    return replace(graph, objects=tuple(objects), confidence=confidence)
