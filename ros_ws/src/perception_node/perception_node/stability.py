# SPDX-License-Identifier: Apache-2.0
"""Whether every block stands on a place or a block, as the words ``up`` and ``stackN`` claim."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from .block_poses import BlockPose


@dataclass(frozen=True)
class StabilityLimits:
    """What still counts as standing.

    Attributes:
        place_tolerance: horizontal distance of the lowest block from its place's centre [m].
        gap: height between a block and what it stands on [m].
        tilt: angle of a block's front from the vertical [rad].
        overhang: horizontal distance between the centres of a block and the one below, as part of
            the block's width; at one half the upper one falls.
    """

    place_tolerance: float = 0.03
    gap: float = 0.008
    tilt: float = 0.14
    overhang: float = 0.45


def instability(
    poses: Sequence[BlockPose],
    names: Sequence[str],
    stacks: Sequence[Sequence[int]],
    places_world: Sequence[tuple[float, float, float]],
    limits: StabilityLimits,
) -> str:
    """A sentence about the first block that does not stand, or an empty string.

    Args:
        stacks: indices into ``poses`` from the bottom, for each place.
    """
    for index, (stack, place) in enumerate(zip(stacks, places_world)):
        below: BlockPose | None = None
        for item in stack:
            pose, name = poses[item], names[item]
            if pose.tilt > limits.tilt:
                return f"{name} leans by {np.degrees(pose.tilt):.0f} degrees"
            support = place[2] if below is None else below.top
            under = "the table" if below is None else names[stack[stack.index(item) - 1]]
            if abs(pose.bottom - support) > limits.gap:
                return (
                    f"{name} is in the air or tilted: its lower end is "
                    f"{1000 * (pose.bottom - support):.0f} mm above {under}"
                )
            centre = place if below is None else below.position_world
            offset = float(np.hypot(*np.subtract(pose.position_world[:2], centre[:2])))
            if below is None and offset > limits.place_tolerance:
                return f"{name} stands {1000 * offset:.0f} mm beside the centre of stack{index}"
            if below is not None and offset > limits.overhang * pose.size[0]:
                return f"{name} overhangs {under} by {1000 * offset:.0f} mm"
            below = pose
    return ""
