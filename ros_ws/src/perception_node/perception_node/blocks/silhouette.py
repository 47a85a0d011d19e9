# SPDX-License-Identifier: Apache-2.0
"""Poses and sizes of blocks from their outlines alone, where no depth is known.

What a picture of one camera leaves open is told by what is known of the scene: the lowest block of
a tower stands on the table, each other one on the one below it, upright, and about on a place. The
outline of a convex body is given by how far it reaches in every direction of the picture,

    s(n) = max over its corners c of n · project(c),

so all blocks of a picture are fitted at once, by Gauss-Newton, to how far their masks reach. Where
something else covers an edge, the block reaches at least as far.
"""

from __future__ import annotations

from collections.abc import Sequence
from typing import Final, NamedTuple

import cv2
import numpy as np
from numpy.typing import NDArray

from perception_node.camera import PinholeCamera
from perception_node.errors import BadImageError
from perception_node.segment import Segments
from perception_node.segment.missed import missed_sentence
from scene_graph import BOX, SPHERE

from .behind import seen_behind, top_is_seen
from .measure import BlockSurface
from .outline import shape_from_outline
from .reach import DIRECTIONS, Reach, points_around, reach_of, towers_over
from .unit_bodies import DEEP, HIGH, LOW, TURN, UNITS, WIDE, X, Y

Array = NDArray[np.float64]
Mask = NDArray[np.bool_]
Fitted = tuple[Array, Array, Array]

#: Standard deviation of where an outline is, at the block [m], and so many times as much for what
#: neighbouring directions have in common.
OUTLINE: Final = 0.001
COMMON: Final = 1.7
#: What is known beforehand, as standard deviations: where a block stands on its place or on the one
#: below it, its yaw, its widths and how much they and its height differ [m, rad].
ON_PLACE: Final = 0.012
ON_BLOCK: Final = 0.008
YAW: Final = 0.5
WIDTH: Final = 0.03
SQUARE: Final = 0.005
CUBE: Final = 0.02
#: How equal the edges of cubes are, and outlines that all differ by no more than this from those of
#: cubes, as a root mean square, are theirs [m].
EQUAL: Final = 0.0005
CUBES_FIT: Final = 0.0016
#: Blocks of one width that fit are not believed where one of them is further from where it is
#: expected than by so many standard deviations: another width looks the same from nearer by.
ASTRAY: Final = 1.25
#: Those of other boxes have to be nearer by this.
BETTER: Final = 0.7
#: Yaws at which the fit begins [rad].
YAWS: Final = np.radians(np.arange(-45.0, 45.0, 7.5))
STEPS: Final = 7
#: No more are taken after one that changes no parameter by this [m, rad].
SETTLED: Final = 2e-5
#: An outline that differs by more than this as a root mean square is of no upright block [m].
MISFIT: Final = 0.0035
#: Light says that a block may be round where that explains it better than a box does by so much.
AS_LIKELY: Final = 0.4
#: By so many times the outline of a box differs more than that of a round block where it is a box
#: all the same, rather round than a box, and round for sure; less than this [m] is no difference.
ROUND: Final = (0.9, 1.1, 2.0)
EXACT: Final = 1e-4
#: Sizes that blocks can have [m].
SMALLEST: Final = 0.012
LARGEST: Final = 0.14

#: By so much parameters are changed to see what that does [m, rad].
_CHANGE: Final = np.array([1e-4, 1e-4, 1e-3, 1e-4, 1e-4, 1e-4, 1e-4])


def measure_silhouettes(
    rgb: NDArray[np.uint8], segments: Segments, camera: PinholeCamera, feet: Array
) -> tuple[BlockSurface, ...]:
    """What outlines say about each block, in the order of the segments.

    Args:
        rgb: shape (height, width, 3).
        feet: of the places, at least one, shape (m, 3) [m].

    Raises:
        BadImageError: if a block is not over a place; if there may be one that was not found, on
            one whose top is not seen whole.
    """
    outlines = [points_around(segment.part, segment.outline) for segment in segments]
    towers = towers_over(outlines, camera, feet)
    reach = reach_of(segments, outlines, towers, camera, feet)
    shapes = [_shape(rgb, segment.part) for segment in segments]
    fit = _Fit(towers, shapes, reach, outlines, camera, feet)
    found = fit.best()
    rivals = [""] * len(shapes)
    if any(shape != BOX for shape in shapes):
        boxes = _Fit(towers, [BOX] * len(shapes), reach, outlines, camera, feet).best()
        for index, shape in enumerate(shapes):
            worse = float(boxes[2][index] / max(found[2][index], EXACT))
            if shape == BOX or worse >= ROUND[2]:
                continue
            shapes[index], rivals[index] = (shape, BOX) if worse >= ROUND[1] else (BOX, shape)
            if worse < ROUND[0]:
                rivals[index] = ""
        if fit.shapes != shapes:
            fit = _Fit(towers, shapes, reach, outlines, camera, feet)
            found = fit.best()
    for index, segment in enumerate(segments):
        if segment.over is not None and not fit.top_is_seen(found, index):
            raise BadImageError(missed_sentence(*segment.over))
    return fit.surfaces(found, rivals)


def _shape(rgb: NDArray[np.uint8], part: Mask) -> str:
    left, top, width, height = cv2.boundingRect(part.astype(np.uint8))
    box = np.s_[max(0, top - 1) : top + height + 1, max(0, left - 1) : left + width + 1]
    return shape_from_outline(rgb[box], part[box], AS_LIKELY)


class _Known(NamedTuple):
    """What is known beforehand of 6N parameters p: ``normal_off @ p - right`` is its slope.

    Attributes:
        normal: of its residuals' squares, shape (6N, 6N).
        normal_off: the same without what only damps, shape (6N, 6N).
        right: shape (6N,).
    """

    normal: Array
    normal_off: Array
    right: Array


class _Fit:
    """All blocks of a picture, fitted at once."""

    def __init__(
        self,
        towers: Sequence[Sequence[int]],
        shapes: Sequence[str],
        reach: Reach,
        outlines: Sequence[Array],
        camera: PinholeCamera,
        feet: Array,
    ) -> None:
        self.towers, self.shapes, self.reach = towers, list(shapes), reach
        self.outlines = outlines
        self.camera, self.feet = camera, feet
        self.count = len(shapes)
        units = [UNITS[shape] for shape in shapes]
        most = max(map(len, units))
        # Bodies with fewer corners have their last one several times.
        self.units = np.stack(
            [np.pad(unit, ((0, most - len(unit)), (0, 0)), mode="edge") for unit in units]
        )
        self.below = np.full(self.count, -1)
        self.foot = np.zeros((self.count, 3))
        for foot, tower in zip(feet, towers):
            self.foot[tower] = foot
            self.below[tower[1:]] = tower[:-1]
        self.order = [index for tower in towers for index in tower]
        # z of a block's lower end is the sum of the heights below it.
        self.under = np.zeros((self.count, self.count))
        for tower in towers:
            for level, index in enumerate(tower):
                self.under[index, list(tower[:level])] = 1.0

    def best(self) -> Fitted:
        """Parameters of all blocks, shape (N, 6); covariance; misfits, shape (N,) [m]."""
        start = self._start()
        fits = [self._fitted(start, EQUAL, EQUAL, alike=True)]
        astray = self._astray(fits[0][0])
        if fits[0][2].max() > CUBES_FIT or astray > ASTRAY:
            start = self._turned(start)
            fits.append(self._fitted(start, EQUAL, EQUAL))
            if fits[0][2].max() <= CUBES_FIT and self._astray(fits[1][0]) >= astray:
                return fits[0]
        if fits[-1][2].max() > CUBES_FIT:
            others = self._fitted(start, SQUARE, CUBE)
            if others[2].max() < BETTER * fits[-1][2].max():
                fits.append(others)
        return fits[-1]

    def top_is_seen(self, found: Fitted, index: int) -> bool:
        """Whether nothing can stand on a block."""
        return top_is_seen(
            self._with_low(found[0])[index], self.shapes[index], self.outlines[index],
            float(self.reach.scale[index]), self.camera,
        )  # fmt: skip

    def _astray(self, values: Array) -> float:
        """How far a block is at most from its place or the one below it [standard deviations]."""
        on_block = self.below >= 0
        under = np.where(on_block[:, None], values[self.below, :2], self.foot[:, :2])
        off = np.linalg.norm(values[:, :2] - under, axis=1)
        return float((off / np.where(on_block, ON_BLOCK, ON_PLACE)).max())

    def surfaces(self, found: Fitted, rivals: Sequence[str]) -> tuple[BlockSurface, ...]:
        """What was found, in the order of the segments."""
        values, covariance, misfit = found
        behind = seen_behind(
            self._with_low(values), self.shapes, self.below, self.outlines, self.reach.scale,
            self.camera,
        )  # fmt: skip
        return tuple(
            self._surface(
                index, values, covariance, float(misfit[index]), rivals[index], bool(behind[index])
            )
            for index in range(self.count)
        )

    def _turned(self, start: Array) -> Array:
        """Where the fit of cubes ends that began at the best of several yaws, for each block.

        One that is turned by an eighth and smaller looks nearly the same.
        """
        ends, misfits = [], []
        for yaw in (None, 0.0, 0.25 * np.pi):
            turned = start.copy()
            if yaw is not None:
                turned[[shape == BOX for shape in self.shapes], TURN] = yaw
            values, _, misfit = self._fitted(turned, EQUAL, EQUAL)
            ends.append(values)
            misfits.append(misfit)
        best = np.array(misfits).argmin(axis=0)
        return np.asarray(np.array(ends)[best, np.arange(self.count)])

    def _fitted(
        self, values: Array, square: float, cube: float, alike: bool = False
    ) -> tuple[Array, Array, Array]:
        """Parameters, their covariance, and by how much outlines differ [m].

        Args:
            values: where the fit begins.
            square, cube: by how much the widths, and the height and a width, of a box differ.
            alike: whether all blocks have one width.
        """
        known = self._known(square, cube, alike)
        for _ in range(STEPS):
            normal, right = self._normal(values, known)
            step = np.linalg.solve(normal, -right).reshape(self.count, 6)
            limit = np.array([0.02, 0.02, 0.25, 0.02, 0.02, 0.02])
            values = values + np.clip(step, -limit, limit)
            values[:, WIDE:LOW] = np.clip(values[:, WIDE:LOW], SMALLEST, LARGEST)
            if np.abs(step).max() < SETTLED:
                break
        covariance = np.linalg.inv(self._normal(values, known)[0])
        squares = (self._off(values) ** 2).mean(axis=1)
        return values, np.asarray(covariance, np.float64), np.sqrt(squares) / self.reach.scale

    def _start(self) -> Array:
        """x, y, yaw, widths and height of each block, shape (N, 6)."""
        values = np.zeros((self.count, 6))
        values[:, :2] = self.foot[:, :2]
        # Directions 0 and half of them are right and left, those between down and up.
        far, quarter = self.reach.far, DIRECTIONS // 4
        across = (far[:, 0] + far[:, 2 * quarter]) / self.reach.scale
        values[:, WIDE] = values[:, DEEP] = values[:, HIGH] = np.clip(
            across / 1.15, SMALLEST, LARGEST
        )
        costs = []
        for yaw in YAWS:
            turned = values.copy()
            turned[:, TURN] = yaw
            width = across / (abs(np.cos(yaw)) + abs(np.sin(yaw)))
            turned[:, WIDE:LOW] = np.clip(width, SMALLEST, LARGEST)[:, None]
            # In the picture the outline is where it is: only its form tells the yaw.
            off = self._off(turned)
            form = off - off @ self.reach.directions @ self.reach.directions.T * (2.0 / DIRECTIONS)
            costs.append((form**2).sum(axis=1))
        best = np.array(costs).argmin(axis=0)
        values[:, TURN] = YAWS[best]
        width = across / (np.abs(np.cos(values[:, TURN])) + np.abs(np.sin(values[:, TURN])))
        values[:, WIDE:LOW] = np.clip(width, SMALLEST, LARGEST)[:, None]
        round_ones = [index for index, shape in enumerate(self.shapes) if shape != BOX]
        values[round_ones, TURN] = 0.0
        return values

    def _with_low(self, values: Array) -> Array:
        """The parameters and z of the lower end, shape (N, 7)."""
        low = self.foot[:, 2] + self.under @ values[:, HIGH]
        return np.column_stack([values, low])

    def _seen(self, values: Array) -> Array:
        """How far blocks reach in each direction, (..., N, 7) -> (..., N, K) [px]."""
        c, s = np.cos(values[..., TURN]), np.sin(values[..., TURN])
        size = values[..., None, WIDE:LOW]
        own = self.units * size
        x = c[..., None] * own[..., 0] - s[..., None] * own[..., 1] + values[..., X, None]
        y = s[..., None] * own[..., 0] + c[..., None] * own[..., 1] + values[..., Y, None]
        z = own[..., 2] + (values[..., LOW] + 0.5 * values[..., HIGH])[..., None]
        pixels = self.camera.project(np.stack([x, y, z], -1))
        return np.asarray((pixels @ self.reach.directions.T).max(axis=-2))

    def _off(self, values: Array) -> Array:
        """By how much they reach too far, shape (N, K) [px]."""
        off = self._seen(self._with_low(values)) - self.reach.far
        return np.where(self.reach.covered, np.minimum(off, 0.0), off)

    def _normal(self, values: Array, known: _Known) -> tuple[Array, Array]:
        """The normal equations' matrix and right side for all 6N parameters."""
        full = self._with_low(values)
        changed = full + np.eye(7)[:, None, :] * _CHANGE
        seen = self._seen(np.concatenate([full[None], changed]))
        off = seen[0] - self.reach.far
        active = ~self.reach.covered | (off < 0.0)
        slopes = (seen[1:] - seen[0]) / _CHANGE[:, None, None]  # (7, N, K)
        count, k = off.shape
        matrix = np.zeros((count, k, count, 6))
        own = np.arange(count)
        matrix[own, :, own, :] = slopes[:6].transpose(1, 2, 0)
        matrix[..., HIGH] += slopes[LOW][:, :, None] * self.under[:, None, :]
        doubt = COMMON * OUTLINE * self.reach.scale[:, None]
        flat = (matrix / doubt[..., None, None] * active[..., None, None]).reshape(count * k, -1)
        flat_off = (off / doubt * active).ravel()
        return (
            flat.T @ flat + known.normal,
            flat.T @ flat_off + known.normal_off @ values.ravel() - known.right,
        )

    def _known(self, square: float, cube: float, alike: bool) -> _Known:
        """What is known beforehand, as further residuals: sums of parameters are about values."""
        rows, about, sure, is_pulled = [], [], [], []

        def add(
            value: float, doubt: float, *terms: tuple[int, int, float], pulls: bool = True
        ) -> None:
            row = np.zeros((self.count, 6))
            for index, column, factor in terms:
                row[index, column] += factor
            rows.append(row.ravel())
            about.append(value)
            sure.append(doubt**-2)
            is_pulled.append(pulls)

        for index in range(self.count):
            below = int(self.below[index])
            is_box = self.shapes[index] == BOX
            for axis in (X, Y):
                add(self.foot[index, axis], ON_PLACE, (index, axis, 1.0))
                if below >= 0:
                    add(0.0, ON_BLOCK, (index, axis, 1.0), (below, axis, -1.0))
            # No yaw is likelier than another one: steps are kept short.
            add(0.0, YAW if is_box else 1e-3, (index, TURN, 1.0), pulls=False)
            add(0.0, square if is_box else 1e-4, (index, WIDE, 1.0), (index, DEEP, -1.0))
            high_as_wide = 1e-4 if self.shapes[index] == SPHERE else cube if is_box else CUBE
            add(0.0, high_as_wide, (index, HIGH, 1.0), (index, WIDE, -1.0))
            add(0.045, WIDTH, (index, WIDE, 1.0))
            if alike and index:
                add(0.0, EQUAL, (index, WIDE, 1.0), (index - 1, WIDE, -1.0))
        matrix = np.array(rows)
        weighted = (matrix * np.array(sure)[:, None]).T
        pulled = matrix * np.array(is_pulled)[:, None]
        return _Known(weighted @ matrix, weighted @ pulled, weighted @ np.array(about))

    def _surface(
        self, index: int, values: Array, covariance: Array, misfit: float, rival: str, behind: bool
    ) -> BlockSurface:
        x, y, yaw, wide, deep, high = (float(value) for value in values[index])
        to_block = np.zeros((7, self.count, 6))
        to_block[[0, 1, 2, 3, 4], index, [X, Y, TURN, WIDE, DEEP]] = 1.0
        to_block[5, :, HIGH] = self.under[index]
        to_block[6, :, HIGH] = self.under[index]
        to_block[6, index, HIGH] = 1.0
        flat = to_block.reshape(7, -1)
        low = float(self.foot[index, 2] + self.under[index] @ values[:, HIGH])
        turn = round(yaw / (np.pi / 2)) if self.shapes[index] == BOX else 0
        if turn % 2:
            flat = flat[[0, 1, 2, 4, 3, 5, 6]]
            wide, deep = deep, wide
        doubt = flat @ covariance @ flat.T + 1e-9 * np.eye(7)
        return BlockSurface(
            self.shapes[index], (x, y), yaw - turn * np.pi / 2, (wide, deep), low, low + high,
            doubt, rival=rival, upright=misfit < MISFIT, seen_low=low,
            behind=behind,
        )  # fmt: skip
