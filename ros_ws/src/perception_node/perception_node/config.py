# SPDX-License-Identifier: Apache-2.0
"""What perception knows of the scene beforehand, and what it accepts."""

from __future__ import annotations

from dataclasses import dataclass, field

from scene_graph import ROW_OF_THREE

from .places import Points
from .segment import RGBD


@dataclass(frozen=True)
class StabilityLimits:
    """What still counts as standing.

    Attributes:
        place_tolerance: horizontal distance of the lowest block from its place's centre [m].
        gap: height between a block and what it stands on [m].
        tilt: angle of a block's front from the vertical [rad].
        overhang: horizontal distance between the centres of a block and the one below, as part of
            the block's width; at one half the upper one falls.
        doubt: standard deviation with which the centre of a block may be known, along any
            horizontal axis [m].
    """

    place_tolerance: float = 0.036
    gap: float = 0.008
    tilt: float = 0.14
    overhang: float = 0.45
    doubt: float = 0.002


@dataclass(frozen=True)
class PlaceSearch:
    """How places are found where they are not given, see :mod:`.places.found`.

    Attributes:
        count: of the places, the free ones included; 0: as many as there are stacks.
        gap: free places are this far from any other: the hand needs room [m].
        reach: least and greatest distance of a place from the arm's axis, the z axis of world [m].
        table_height: z of the table [m].
    """

    count: int = 0
    gap: float = 0.12
    reach: tuple[float, float] = (0.30, 0.75)
    table_height: float = 0.0


@dataclass(frozen=True)
class PerceptionConfig:
    """What perception knows of the scene, and what it accepts.

    Attributes:
        mask_source: where the blocks' pixels come from, see ``segment.SEGMENTERS``.
        stack_positions: centres of the m places on the table, from the left of the image [m]; none
            where the places are unknown, which leaves left-relations instead of bases.
        search: how places are found where that is asked for.
        min_confidence: least confidence of a confident graph (A.2.5).
        max_hidden: greatest hidden share of the column over a place.
        column_half_width, column_height: of the columns in which blocks can stand [m].
        smallest_block: edge of the smallest cube that there may be: behind blocks, where none of
            that size fits unseen, there is none [m].
        limits: what counts as standing.
    """

    mask_source: str = RGBD
    stack_positions: Points = ROW_OF_THREE
    search: PlaceSearch = field(default_factory=PlaceSearch)
    min_confidence: float = 0.6
    max_hidden: float = 0.005
    column_half_width: float = 0.035
    column_height: float = 0.36
    smallest_block: float = 0.025
    limits: StabilityLimits = field(default_factory=StabilityLimits)
