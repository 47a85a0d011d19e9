# SPDX-License-Identifier: Apache-2.0
"""Poses and sizes of all blocks of a scene, from what was measured of each.

Measurements are normal distributions; what else is known conditions them: blocks of a stack stand
on one another and the lowest on the table; and where all that is seen of all blocks could be cubes,
or cubes of one size, they are taken to be.
"""

from __future__ import annotations

from collections.abc import Collection, Iterable, Sequence
from dataclasses import dataclass
from typing import Final

import numpy as np
from numpy.typing import NDArray

from scene_graph import BOX, SPHERE, BlockPose

from .measure import BlockSurface

Array = NDArray[np.float64]

#: Standard deviation of the table's height, and of how much a block misses what it stands on [m].
CONTACT: Final = 5e-4
#: A block's lower end may be so many standard deviations, and this much more, from what it is
#: taken to stand on [m].
STANDS: Final = (3.0, 0.004)
#: Sizes known to this standard deviation say whether blocks may be cubes [m].
TELLS: Final = 0.0025
#: Sizes agree within this much [m], and beyond that within so many standard deviations each, and so
#: many as a root mean square of many. Those that are not known better than SHARP are of edges that
#: are hardly seen, and less certain than they state.
ALIKE: Final = 0.0005
SHARP: Final = 0.001
AGREES: Final = (2.5, 0.8)
HARDLY_SEEN: Final = (4.5, 3.0)
#: Where neither noise nor blur moves the end of a top that is seen at a glancing angle, it tells
#: how deep a block is: of cubes within 1.6 of these standard deviations.
HARDLY_SEEN_SHARPLY: Final = (2.0, 2.0)
#: A root mean square of as few values may be √2 times as large as one of many.
FEW: Final = 5
#: The first limit is one for so many values: of more, the furthest is further off.
OF_ONE: Final = 3
#: Standard deviation of the edges of what is taken for a cube, and for one of equal cubes [m].
CUBE: Final = 8e-4
EQUAL: Final = 3e-4

#: Values and their standard deviations [m].
_Values = Sequence[tuple[float, float]]
#: Standard deviations by which each value may differ, and all of them as a root mean square.
_Limits = tuple[float, float]

_X, _Y, _YAW, _ALONG, _ACROSS, _LOW, _HIGH = np.eye(7)
#: The three edges of a block, as sums of its parameters.
_EDGES: Final = (_ALONG, _ACROSS, _HIGH - _LOW)


@dataclass(frozen=True)
class MeasuredBlock:
    """One block as measured.

    Attributes:
        shape: ``box``, ``cylinder`` or ``sphere``.
        pose: in world; its yaw is in -π/4..π/4, as a box looks the same after a quarter turn.
        tilt: see :class:`BlockSurface` [rad].
        deviation: standard deviations of x, y, z of the centre [m], of yaw [rad] and of the size
            along its own x, y, z [m], shape (7,).
        rival: see :class:`BlockSurface`.
    """

    shape: str
    pose: BlockPose
    tilt: float = 0.0
    deviation: tuple[float, ...] = (0.0,) * 7
    rival: str = ""


@dataclass
class _Estimate:
    """A normal distribution of x, y, yaw, two widths, low and high, shapes (7,) and (7, 7)."""

    mean: Array
    covariance: Array

    def of(self, row: Array) -> tuple[float, float]:
        """A sum of parameters, and its standard deviation."""
        return float(row @ self.mean), max(float(row @ self.covariance @ row), 0.0) ** 0.5

    def condition(self, row: Array, value: float, deviation: float) -> None:
        """Takes in that a sum of parameters was found to be a value."""
        across = row @ self.covariance
        gain = self.covariance @ row / (across @ row + deviation**2)
        self.mean = self.mean + gain * (value - row @ self.mean)
        self.covariance = self.covariance - gain[:, None] * across


def pose_blocks(
    surfaces: Sequence[BlockSurface],
    stacks: Sequence[Sequence[int]],
    table_heights: Sequence[float],
    covered: Collection[int] = (),
    smallest: float = 0.0,
) -> tuple[MeasuredBlock, ...]:
    """Joins the measurements of a scene.

    Args:
        surfaces: of all N blocks.
        stacks: indices into ``surfaces``, from the bottom, of each stack.
        table_heights: z of the surface under each stack [m].
        covered: those of which other stacks cover a part: they say nothing of the others, and where
            they end that is not seen is told by what they stand on only if nothing fits under them.
        smallest: height of the lowest block that may be under such a one [m].
    """
    estimates = [
        _Estimate(
            np.array([*item.position, item.yaw, *item.widths, item.low, item.high]),
            item.covariance,
        )
        for item in surfaces
    ]
    for stack, table in zip(stacks, table_heights):
        _stand([estimates[index] for index in stack if index not in covered], table)
    whole = [
        (item, estimate)
        for index, (item, estimate) in enumerate(zip(surfaces, estimates))
        if index not in covered
    ]
    hardly = HARDLY_SEEN_SHARPLY if all(item.sharp for item in surfaces) else HARDLY_SEEN
    cubes = _take_for_cubes([estimate for item, estimate in whole if item.shape == BOX], hardly)
    edge = _take_for_equal([estimate for item, estimate in whole if item.shape != SPHERE], hardly)
    for index in covered:
        if cubes and surfaces[index].shape == BOX:
            _take_for_cubes([estimates[index]], HARDLY_SEEN, edge)
    for stack, table in zip(stacks, table_heights):
        if any(index in covered for index in stack):
            tower = [(surfaces[index], estimates[index]) for index in stack]
            _stand_covered(tower, table, smallest)
    return tuple(_posed(item, estimate) for item, estimate in zip(surfaces, estimates))


def _stand(tower: Iterable[_Estimate], table: float) -> None:
    """Blocks stand on one another, from the bottom, where they can."""
    level, doubt, below = table, CONTACT, None
    for block in tower:
        low, low_doubt = block.of(_LOW)
        if abs(low - level) < STANDS[0] * np.hypot(low_doubt, doubt) + STANDS[1]:
            if below is not None:
                below.condition(_HIGH, low, float(np.hypot(low_doubt, CONTACT)))
                level, doubt = below.of(_HIGH)
            block.condition(_LOW, level, float(np.hypot(doubt, CONTACT)))
        (level, doubt), below = block.of(_HIGH), block


def _stand_covered(
    tower: Iterable[tuple[BlockSurface, _Estimate]], table: float, smallest: float
) -> None:
    """As :func:`_stand` of a tower of which other stacks cover a part."""
    level = table
    for surface, block in tower:
        low, doubt = block.of(_LOW)
        seen = doubt < TELLS and abs(low - level) < STANDS[0] * doubt + STANDS[1]
        if seen or (doubt >= TELLS and surface.seen_low < level + smallest):
            block.condition(_LOW, level, CONTACT)
        level = block.of(_HIGH)[0]


def _take_for_cubes(boxes: Sequence[_Estimate], hardly: _Limits, edge: float | None = None) -> bool:
    """If every box could be a cube, as far as its edges are known, they all are.

    Args:
        hardly: of edges that are hardly seen, see :data:`HARDLY_SEEN`.
        edge: of the cube, where it is known [m].

    Returns:
        Whether they are.
    """
    edges = [[box.of(row) for row in _EDGES] for box in boxes]
    if not _agree([(values, _mean(values) if edge is None else edge) for values in edges], hardly):
        return False
    for box in boxes:
        for row in (_ALONG - _ACROSS, _ALONG - _EDGES[2], _ACROSS - _EDGES[2]):
            box.condition(row, 0.0, CUBE)
        if edge is not None:
            box.condition(_ALONG, edge, EQUAL)
    return bool(boxes)


def _take_for_equal(blocks: Sequence[_Estimate], hardly: _Limits) -> float | None:
    """If all edges could be of one length, as far as they are known, they are: it; else None."""
    edges = [block.of(row) for block in blocks for row in _EDGES]
    common = _mean(edges)
    if common is None or not _agree([(edges, common)], hardly):
        return None
    for block in blocks:
        for row in _EDGES:
            block.condition(row, common, EQUAL)
    return common


def _mean(values: _Values) -> float | None:
    """The mean of values; None if not one of them is known well."""
    if not any(doubt < TELLS for _, doubt in values):
        return None
    found, doubt = np.array(values).T
    weights = 1.0 / (doubt**2 + CONTACT**2)
    return float(found @ weights / weights.sum())


def _agree(groups: Sequence[tuple[_Values, float | None]], hardly: _Limits) -> bool:
    """Whether the values of each group can be its mean."""
    hardly_seen: list[float] = []
    for values, mean in groups:
        if mean is None:
            return False
        found, doubt = np.array(values).T
        beyond = np.maximum(np.abs(found - mean) - ALIKE, 0.0) / doubt
        sharp = doubt < SHARP
        count = max(1, int(sharp.sum()))
        few = float(np.sqrt(1.0 + FEW / count))
        most = float(np.sqrt(AGREES[0] ** 2 + 2.0 * np.log(max(1.0, count / OF_ONE))))
        if not _within(beyond[sharp], most, AGREES[1] * few):
            return False
        hardly_seen += list(beyond[~sharp])
    return _within(np.array(hardly_seen), *hardly)


def _within(beyond: Array, most: float, together: float) -> bool:
    """Whether so many standard deviations each, and as a root mean square, are not too many."""
    if len(beyond) == 0:
        return True
    return bool(beyond.max() <= most and np.sqrt(np.mean(beyond**2)) <= together)


def _posed(surface: BlockSurface, estimate: _Estimate) -> MeasuredBlock:
    mean = estimate.mean
    rows = (_X, _Y, 0.5 * (_LOW + _HIGH), _YAW, *_EDGES)
    return MeasuredBlock(
        surface.shape,
        BlockPose(
            position_world=(float(mean[0]), float(mean[1]), float(0.5 * (mean[5] + mean[6]))),
            yaw=float(mean[2]) if surface.shape == BOX else 0.0,
            size=(float(mean[3]), float(mean[4]), float(mean[6] - mean[5])),
        ),
        surface.tilt,
        tuple(estimate.of(row)[1] for row in rows),
        surface.rival,
    )
