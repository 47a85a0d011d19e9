# SPDX-License-Identifier: Apache-2.0
"""Starting points for paths among obstacles: ways of the hand over, left and right of them.

The hand, upright and with what it holds, is moved on a grid of positions on which it touches
nothing. The shortest way from end to end is the first; each further one avoids where those before
led, and so passes on another side. The links behind the hand are left to the path problem.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from itertools import product
from typing import Final

import numpy as np
from numpy.typing import NDArray
from scipy.sparse import coo_array
from scipy.sparse.csgraph import dijkstra

from ..blocks import Column
from ..obstacles import Obstacle
from ..phases import Phase
from ..robots import Gripper

Array = NDArray[np.float64]

#: Between two positions of the grid [m].
SPACING: Final = 0.04
#: How far the grid reaches beyond the ends and what is between them, and above all of it [m].
AROUND: Final = 0.24
ABOVE: Final = 0.24
#: The hand comes no nearer to the arm's own axis [m].
NEAREST: Final = 0.22
#: How much farther out than its ends a way may lead [m].
OUTWARDS: Final = 0.12
#: A further way avoids what is so near to those before [m], where it counts so many times.
APART: Final = 0.13
AVOIDED: Final = 4.0
#: A position this far beyond what is free may be left or reached [m].
_REACHED: Final = 0.09
#: Offsets to half of a position's neighbours; the others are theirs.
_NEIGHBOURS: Final = [o for o in product((-1, 0, 1), repeat=3) if o > (0, 0, 0)]


@dataclass(frozen=True)
class _Boxes:
    """Upright boxes: centres (k, 3), half extents (k, 3), yaws (k,) [m, rad]."""

    centers: Array
    halves: Array
    yaws: Array


class HandGrid:
    """Positions of the tool centre point at which an upright hand touches nothing.

    Args:
        ends: where the way begins and ends, shape (2, 3) [m].
        yaws: of the hand at both, shape (2,) [rad]; it is to be free with either.
        margin: distance that is kept [m].
        floor: height of the table [m].
    """

    def __init__(
        self,
        gripper: Gripper,
        phase: Phase,
        obstacles: Sequence[Obstacle],
        ends: Array,
        yaws: Array,
        margin: float,
        floor: float,
    ) -> None:
        boxes = _boxes(phase.columns, obstacles, floor)
        hanging = phase.tool.bottom - gripper.tcp_offset
        top = max([float(ends[:, 2].max()), *(boxes.centers[:, 2] + boxes.halves[:, 2])])
        low = ends.min(axis=0) - AROUND
        high = ends.max(axis=0) + AROUND
        low[2] = floor + hanging + margin
        high[2] = top + hanging + ABOVE
        axes = [np.arange(a, b + SPACING, SPACING) for a, b in zip(low, high)]
        self._shape = tuple(len(axis) for axis in axes)
        self._points = np.stack(np.meshgrid(*axes, indexing="ij"), axis=-1).reshape(-1, 3)
        radius = np.hypot(self._points[:, 0], self._points[:, 1])
        farthest = np.hypot(ends[:, 0], ends[:, 1]).max() + OUTWARDS
        free = (radius > NEAREST) & (radius < farthest)
        tool = phase.tool
        parts = (
            (gripper.hand_half, gripper.hand_top, gripper.palm),
            ((tool.half_x, tool.half_y), gripper.palm, tool.bottom),
        )
        for half, upper, lower in parts:
            middle = gripper.tcp_offset - (upper + lower) / 2
            centers = self._points + (0.0, 0.0, middle)
            size = np.array([*half, (lower - upper) / 2])
            for yaw in np.unique(np.round(np.mod(yaws, np.pi), 2)):
                free &= ~_overlap(centers, size, float(yaw), boxes, margin)
        self._free, self._ends = free, ends

    def ways(self, count: int) -> Iterator[Array]:
        """Up to ``count`` ways, shortest first, ends included, each of shape (points, 3) [m]."""
        if not self._free.any():
            return
        weight = np.ones(len(self._points))
        distance = np.linalg.norm(self._points[:, None] - self._ends, axis=2)
        distance[~self._free] = np.inf
        start, goal = (int(index) for index in distance.argmin(axis=0))
        if max(distance[start, 0], distance[goal, 1]) > _REACHED:
            return
        for _ in range(count):
            way = self._way(start, goal, weight)
            if way is None:
                return
            yield np.vstack([self._ends[:1], way, self._ends[1:]])
            inner = way[2:-2] if len(way) > 5 else way
            if not len(inner):
                return
            near = np.linalg.norm(self._points[:, None] - inner, axis=2).min(axis=1) < APART
            weight = weight + AVOIDED * near

    def _way(self, start: int, goal: int, weight: Array) -> Array | None:
        index = np.arange(len(self._points)).reshape(self._shape)
        rows, columns, costs = [], [], []
        for offset in _NEIGHBOURS:
            here = index[tuple(_cut(-o) for o in offset)].ravel()
            there = index[tuple(_cut(o) for o in offset)].ravel()
            both = self._free[here] & self._free[there]
            here, there = here[both], there[both]
            length = SPACING * float(np.linalg.norm(offset))
            rows.append(here)
            columns.append(there)
            costs.append(length * (weight[here] + weight[there]) / 2)
        size = len(self._points)
        graph = coo_array(
            (np.concatenate(costs), (np.concatenate(rows), np.concatenate(columns))), (size, size)
        ).tocsr()
        _, before = dijkstra(graph, directed=False, indices=start, return_predecessors=True)
        way = [goal]
        while way[-1] != start:
            previous = int(before[way[-1]])
            if previous < 0:
                return None
            way.append(previous)
        return np.asarray(self._points[way[::-1]])


def _cut(offset: int) -> slice:
    """What has a neighbour at an offset along an axis."""
    return slice(1, None) if offset > 0 else slice(None, -1) if offset < 0 else slice(None)


def _boxes(columns: Sequence[Column], obstacles: Sequence[Obstacle], floor: float) -> _Boxes:
    centers = [[*c.center, (c.top + floor) / 2] for c in columns]
    halves = [[*c.half, (c.top - floor) / 2] for c in columns]
    centers += [list(item.position_world) for item in obstacles]
    halves += [[extent / 2 for extent in item.size] for item in obstacles]
    yaws = [0.0] * len(columns) + [item.yaw for item in obstacles]
    return _Boxes(np.array(centers), np.array(halves), np.array(yaws))


def _overlap(
    centers: Array, half: Array, yaw: float, boxes: _Boxes, margin: float
) -> NDArray[np.bool_]:
    """Whether a box (3,) of some yaw is nearer than a margin to any box, by its centres (n, 3)."""
    found = np.zeros(len(centers), dtype=bool)
    for center, other, turn in zip(boxes.centers, boxes.halves, boxes.yaws):
        if other[2] <= 0:
            continue
        delta = centers - center
        apart = np.abs(delta[:, 2]) > half[2] + other[2] + margin
        for angle in (yaw, yaw + np.pi / 2, turn, turn + np.pi / 2):
            axis = np.array([np.cos(angle), np.sin(angle)])
            reach = _reach(half, angle - yaw) + _reach(other, angle - turn) + margin
            apart |= np.abs(delta[:, :2] @ axis) > reach
        found |= ~apart
    return found


def _reach(half: Array, angle: float) -> float:
    """Half extent of a rectangle along a direction at an angle to its first axis [m]."""
    return float(half[0] * abs(np.cos(angle)) + half[1] * abs(np.sin(angle)))
