# SPDX-License-Identifier: Apache-2.0
"""Poses and sizes of all blocks of a scene, from what was measured of each.

An edge is known to a pixel (2 mm), a tower's height nearly exactly, because its top face is seen.
Blocks in a stack stand on one another and the lowest on the table, and blocks that could be of one
size, after all that was measured, are taken to be: together this gives centres to about 0.5 mm.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Final

import numpy as np

from scene_graph import BOX, BlockPose

from .surface import BlockSurface, Interval, block_frame

#: How much intervals may miss one another and still be taken to agree [m]: with exact depth and
#: calibration, and else.
AGREEMENT: Final = (0.0006, 0.002)


@dataclass(frozen=True)
class MeasuredBlock:
    """One block as measured.

    Attributes:
        shape: ``box``, ``cylinder`` or ``sphere``.
        pose: in world; its yaw is in -π/4..π/4, as a box looks the same after a quarter turn.
        tilt: see :class:`BlockSurface` [rad].
    """

    shape: str
    pose: BlockPose
    tilt: float = 0.0


def pose_blocks(
    surfaces: Sequence[BlockSurface],
    stacks: Sequence[Sequence[int]],
    table_heights: Sequence[float],
) -> tuple[MeasuredBlock, ...]:
    """Joins the measurements of a scene.

    Args:
        surfaces: of all N blocks.
        stacks: indices into ``surfaces``, from the bottom, of each stack.
        table_heights: z of the surface under each stack [m].
    """
    vertical = _levels(surfaces, stacks, table_heights)
    widths = [
        Interval(item.right.low - item.left.high, item.right.high - item.left.low)
        for item in surfaces
    ]
    heights = [top - bottom for bottom, top in vertical]
    cube = _agreed([*widths, *(Interval(h - AGREEMENT[0], h + AGREEMENT[0]) for h in heights)])
    # If they are cubes, as far as anyone can tell: heights are known better than widths.
    common = _agreed(widths) if cube is None else float(np.median(heights))
    return tuple(
        _posed(surface, *vertical[index], widths[index].middle if common is None else common)
        for index, surface in enumerate(surfaces)
    )


def _posed(surface: BlockSurface, bottom: float, top: float, width: float) -> MeasuredBlock:
    half = 0.5 * width
    y = _overlap(
        Interval(surface.left.low + half, surface.left.high + half),
        Interval(surface.right.low - half, surface.right.high - half),
    )
    # The depth of the footprint cannot be measured from the front: it is taken to be as wide.
    local = np.array([surface.front - half, y, 0.5 * (bottom + top)])
    position = block_frame(surface.yaw) @ local
    yaw = surface.yaw - np.round(surface.yaw / (np.pi / 2)) * (np.pi / 2)
    return MeasuredBlock(
        surface.shape,
        BlockPose(
            position_world=(float(position[0]), float(position[1]), float(position[2])),
            yaw=float(yaw) if surface.shape == BOX else 0.0,
            size=(width, width, top - bottom),
        ),
        surface.tilt,
    )


def _levels(
    surfaces: Sequence[BlockSurface],
    stacks: Sequence[Sequence[int]],
    table_heights: Sequence[float],
) -> list[tuple[float, float]]:
    """z of the lower and upper end of every block [m], by the simplest story that fits.

    First: all blocks are of one height and stand on one another. Else the same within one stack.
    Else every block by its own edges, where neighbours share one if they can.
    """
    levels = [(item.bottom.middle, item.top.middle) for item in surfaces]
    towers = [([surfaces[i] for i in stack], table) for stack, table in zip(stacks, table_heights)]
    common = _common_height(towers)
    for stack, tower in zip(stacks, towers):
        table = tower[1]
        height = _common_height([tower]) if common is None else common
        if height is not None:
            for level, index in enumerate(stack):
                levels[index] = (table + level * height, table + (level + 1) * height)
            continue
        below = table
        for index in stack:
            bottom, top = surfaces[index].bottom, surfaces[index].top
            stands = bottom.low - AGREEMENT[-1] <= below <= bottom.high + AGREEMENT[-1]
            levels[index] = (below if stands else bottom.middle, top.middle)
            below = top.middle
    return levels


def _common_height(towers: Sequence[tuple[list[BlockSurface], float]]) -> float | None:
    """The height of every block [m], if all could be of one height and stand on one another.

    Args:
        towers: blocks from the bottom, and the height of the table [m].
    """
    for slack in AGREEMENT:
        found = []
        for blocks, table in towers:
            for level, item in enumerate(blocks):
                for count, edge in ((level, item.bottom), (level + 1, item.top)):
                    low, high = edge.low - table - slack, edge.high - table + slack
                    if count:
                        found.append(Interval(low / count, high / count))
                    elif not low <= 0.0 <= high:  # does not stand on the table
                        found.append(Interval(np.inf, -np.inf))
        height = _agreed(found, slack=0.0)
        if height is not None:
            return height
    return None


def _agreed(intervals: Sequence[Interval], slack: float = AGREEMENT[0]) -> float | None:
    """The middle of what all intervals allow, None if they exclude one another."""
    if not intervals:
        return None
    low = max(item.low for item in intervals) - slack
    high = min(item.high for item in intervals) + slack
    return 0.5 * (low + high) if low <= high else None


def _overlap(first: Interval, second: Interval) -> float:
    """The middle of the intersection; without one, between the two, nearer to the sharper."""
    low, high = max(first.low, second.low), min(first.high, second.high)
    if low <= high:
        return 0.5 * (low + high)
    first_doubt, second_doubt = first.high - first.low + 1e-6, second.high - second.low + 1e-6
    weight = second_doubt / (first_doubt + second_doubt)
    return weight * first.middle + (1.0 - weight) * second.middle
