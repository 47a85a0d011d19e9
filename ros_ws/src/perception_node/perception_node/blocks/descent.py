# SPDX-License-Identifier: Apache-2.0
"""The descent to the models of blocks that fit a picture best: damped Gauss-Newton.

The cost of a block is half the sum of squared residuals in standard deviations, Huber's beyond
:data:`HUBER`: of points about the model's faces, of the outline about the model's outline, and of
what is known beforehand. In C (``descent.c``) where that can be compiled, one block after the
other, and else in numpy, all blocks side by side.
"""

from __future__ import annotations

import ctypes
from collections.abc import Sequence
from dataclasses import dataclass, replace
from pathlib import Path
from typing import Final, NamedTuple

import cv2
import numpy as np
from numpy.typing import NDArray
from tamp_runtime.machine_code import address, written

from perception_node.camera import PinholeCamera
from scene_graph import BOX, CYLINDER, SPHERE

from .evidence import Evidence
from .models import CIRCLE, Model, Seen

Array = NDArray[np.float64]

#: Residuals beyond so many standard deviations count less than by their square.
HUBER: Final = 2.0
#: A step that lowers the cost by less is the last.
GAIN: Final = 0.02
#: A block that no step with less damping improves is done.
MAX_DAMPING: Final = 1e4
#: Edges of an outline shorter than this have no direction that can be told [px].
SHORT_EDGE: Final = 0.2

_FILE: Final = Path(__file__).with_suffix(".c")
#: Kinds of blocks, as they are numbered there.
IN_C: Final = (BOX, CYLINDER, SPHERE)


@dataclass(frozen=True)
class Prior:
    """What is known beforehand: ``rows @ parameters`` is ``values``, with standard deviation 1.

    Attributes:
        rows: shape (m, P); of full rank, so that whatever is not seen stays near it.
        values: shape (m,).
    """

    rows: Array
    values: Array

    @classmethod
    def about(cls, start: Array, doubt: Array) -> Prior:
        """Each parameter is about where it starts, with these standard deviations, shape (P,)."""
        return cls(np.diag(1.0 / doubt), start / doubt)

    def and_also(self, row: Array, value: float, doubt: float) -> Prior:
        """The same, and a sum of parameters is about a value."""
        rows = np.concatenate([self.rows, row[None] / doubt])
        return Prior(rows, np.append(self.values, value / doubt))


class Lowest(NamedTuple):
    """Where the descents of B blocks ended.

    Attributes:
        parameters: shape (B, P).
        information: JᵀWJ, the inverse of their covariance, shape (B, P, P).
        cost: shape (B,).
        off: of their points from the models' faces, shape (B, N) [m].
    """

    parameters: Array
    information: Array
    cost: Array
    off: Array


@dataclass(frozen=True)
class Problem:
    """What is fitted to what: B blocks, what they have fewer of than others filled with weight 0.

    Attributes:
        seen, used: points and which of them are real, (B, N).
        outline, inverse: points of the outlines [px] and 1 / standard deviation, 0 where there is
            none, (B, O, 2) and (B, O) [1/px].
        rows, values: the priors, (B, m, P) and (B, m).
    """

    model: Model
    camera: PinholeCamera
    seen: Seen
    used: Array
    outline: Array
    inverse: Array
    rows: Array
    values: Array

    @classmethod
    def of(cls, model: Model, priors: Sequence[Prior], evidence: Sequence[Evidence]) -> Problem:
        """Of blocks that are seen by one camera, at least one."""
        camera = evidence[0].camera
        rim = [1.0 / item.edge_noise for item in evidence]
        return cls(
            model,
            camera,
            Seen(
                camera.position_world,
                _padded([item.points for item in evidence]),
                _padded([item.rays for item in evidence]),
                _padded([item.noise for item in evidence]),
            ),
            _padded([np.ones(len(item.noise)) for item in evidence]),
            _padded([item.outline for item in evidence]),
            _padded(rim),
            np.stack([prior.rows for prior in priors]),
            np.stack([prior.values for prior in priors]),
        )

    def blurred(self, floor: float, factor: float) -> Problem:
        """The same with everything less exact.

        Args:
            floor: standard deviation of a surface about its model [m].
            factor: by which the outline's is larger.
        """
        seen = self.seen._replace(floor=floor)
        return replace(self, seen=seen, inverse=self.inverse / factor)

    def repeated(self, times: int) -> Problem:
        """The same blocks so many times, one after another."""
        seen = self.seen
        own = (self.used, self.outline, self.inverse, self.rows, self.values)
        points, rays, noise, *others = (
            np.concatenate([array] * times) for array in (seen.points, seen.rays, seen.noise, *own)
        )
        seen = Seen(seen.origin, points, rays, noise, seen.floor)
        return Problem(self.model, self.camera, seen, *others)

    def only(self, blocks: Sequence[int]) -> Problem:
        """The same of some of the blocks, by their indices."""
        some, seen = list(blocks), self.seen
        own = (self.used, self.outline, self.inverse, self.rows, self.values)
        points, rays, noise, *others = (
            array[some] for array in (seen.points, seen.rays, seen.noise, *own)
        )
        seen = Seen(seen.origin, points, rays, noise, seen.floor)
        return Problem(self.model, self.camera, seen, *others)

    def at(self, parameters: Array) -> _Linearised:
        """What the models' residuals are there."""
        surface = self.model.surface(parameters, self.seen)
        outside, outside_slopes = self._outside(parameters)
        inverse = self.used / surface.doubt
        residuals = np.concatenate([surface.off * inverse, outside * self.inverse], axis=1)
        slopes = np.concatenate(
            [surface.slopes * inverse[..., None], outside_slopes * self.inverse[..., None]], axis=1
        )
        size = np.abs(residuals)
        weights = np.minimum(1.0, HUBER / np.maximum(size, 1e-12))
        known = np.einsum("bmp,bp->bm", self.rows, parameters) - self.values
        # Half the square up to HUBER, beyond it a straight line.
        cost = 0.5 * (weights * size * (2.0 * size - weights * size)).sum(axis=1)
        return _Linearised(
            np.concatenate([residuals, known], axis=1),
            np.concatenate([slopes, self.rows], axis=1),
            np.concatenate([weights, np.ones(known.shape)], axis=1),
            cost + 0.5 * (known * known).sum(axis=1),
        )

    def _outside(self, parameters: Array) -> tuple[Array, Array]:
        """How far the outlines' points are outside of the models' [px], (B, O), and its slopes."""
        model, points = self.model, self.outline
        blocks, count = parameters.shape
        steps = np.concatenate([np.zeros((1, count)), np.diag(model.steps)])
        corners = model.outline(parameters + steps[:, None], self.camera.position_world)
        pixels = np.nan_to_num(self.camera.project(corners), nan=-1e4)  # (1 + P, B, n, 2)
        hulls = [
            cv2.convexHull(item, returnPoints=False)[:, 0] for item in pixels[0].astype(np.float32)
        ]
        most = max(map(len, hulls))
        # What a hull has less of than others are edges without length.
        hull = np.stack([np.append(item, np.repeat(item[-1], most - len(item))) for item in hulls])
        after = np.stack(
            [np.append(item[1:], np.repeat(item[0], most + 1 - len(item))) for item in hulls]
        )
        of = np.arange(blocks)[:, None]
        begin, along = pixels[0, of, hull], pixels[0, of, after] - pixels[0, of, hull]
        length = np.sqrt((along * along).sum(axis=-1))
        along = along / np.maximum(length, 1e-9)[..., None]
        normal = np.stack([along[..., 1], -along[..., 0]], axis=-1)
        # Whichever way round the hulls go: their inside is on the other side of the normals.
        inward = ((begin.mean(axis=1) - begin[:, 0]) * normal[:, 0]).sum(axis=-1) > 0.0
        normal[inward] *= -1.0
        distances = points @ normal.transpose(0, 2, 1) - (begin * normal).sum(axis=-1)[:, None]
        distances[np.broadcast_to((length < SHORT_EDGE)[:, None], distances.shape)] = -np.inf
        edge = distances.argmax(axis=2)
        off = np.take_along_axis(distances, edge[..., None], axis=2)[..., 0]
        # A point moves with both ends of its edge, by how near it is to each.
        share = ((points - begin[of, edge]) * along[of, edge]).sum(axis=-1)
        share = np.clip(share / np.maximum(length[of, edge], 1e-9), 0.0, 1.0)[..., None]
        moves = (pixels[1:] - pixels[0]) / model.steps[:, None, None, None]
        first, last = (
            np.einsum("pbei,bei->bep", moves[:, of, ends], normal)[of, edge]
            for ends in (hull, after)
        )
        return off, (share - 1.0) * first - share * last


class _Task(ctypes.Structure):
    """What all blocks have in common, see ``descent.c``."""

    _fields_ = [
        *((name, ctypes.c_int) for name in ("kind", "points", "rim", "priors", "sides")),
        *((name, ctypes.c_void_p) for name in ("origin", "pose", "lens", "circle")),
        *((name, ctypes.c_double) for name in ("floor", "huber", "short_edge")),
        ("steps", ctypes.c_void_p),
    ]


def descended(
    problem: Problem, parameters: Array, trials: int, enough: float, offs: bool = True
) -> Lowest:
    """Damped Gauss-Newton.

    Args:
        parameters: where it begins, shape (B, P).
        trials: steps at most; 0: only what is there is told.
        enough: a step that changes no parameter by more is the last.
        offs: whether ``off`` is wanted; without it may be empty.
    """
    library, model, seen = written(_FILE), problem.model, problem.seen
    if library is None or model.shape not in IN_C:
        return descended_by_numpy(problem, parameters, trials, enough)
    k = problem.camera.intrinsics
    common = [
        np.ascontiguousarray(array, np.float64)
        for array in (
            seen.origin, problem.camera.world_from_optical,
            (k[0, 0], k[1, 1], k[0, 2], k[1, 2]), CIRCLE,
        )
    ]  # fmt: skip
    own = [
        np.ascontiguousarray(array, np.float64)
        for array in (
            seen.points, seen.rays, seen.noise, problem.used, problem.outline, problem.inverse,
            problem.rows, problem.values,
        )
    ]  # fmt: skip
    steps, limits = model.steps, np.array([model.narrowest, model.widest])
    blocks, points = seen.noise.shape
    task = _Task(
        IN_C.index(model.shape), points, problem.inverse.shape[1], problem.values.shape[1],
        len(CIRCLE), *(array.ctypes.data for array in common),
        seen.floor, HUBER, SHORT_EDGE, steps.ctypes.data,
    )  # fmt: skip
    extents = np.array(model.extents, np.intc)
    count = len(steps)
    found = Lowest(
        np.array(parameters, np.float64, order="C"),
        np.empty((blocks, count, count)), np.empty(blocks), np.empty((blocks, points * offs)),
    )  # fmt: skip
    library.descend(
        ctypes.byref(task), blocks, *map(address, own), len(extents), address(extents),
        address(limits),
        trials, *map(ctypes.c_double, (enough, GAIN, MAX_DAMPING)), *map(address, found[:3]),
        address(found.off) if offs else None,
    )  # fmt: skip
    return found


class _Linearised(NamedTuple):
    """Residuals of B blocks in standard deviations, shape (B, R): depths, outline, prior.

    Attributes:
        slopes: their derivatives, shape (B, R, P).
        weights: Huber's, shape (B, R).
        cost: of all, shape (B,).
    """

    residuals: Array
    slopes: Array
    weights: Array
    cost: Array

    def information(self) -> Array:
        """JᵀWJ, shape (B, P, P)."""
        weighted = self.slopes * self.weights[..., None]
        return np.asarray(weighted.transpose(0, 2, 1) @ self.slopes)

    def gradient(self) -> Array:
        """JᵀWr, shape (B, P)."""
        return np.einsum("brp,br->bp", self.slopes, self.weights * self.residuals)

    def where(self, better: NDArray[np.bool_], other: _Linearised) -> _Linearised:
        """The other one's blocks where it is better, shape (B,)."""
        return _Linearised(
            *(
                np.where(better.reshape(-1, *(1,) * (mine.ndim - 1)), theirs, mine)
                for mine, theirs in zip(self, other)
            )
        )


def descended_by_numpy(problem: Problem, parameters: Array, trials: int, enough: float) -> Lowest:
    """As :func:`descended`, all blocks side by side."""
    model = problem.model
    extents = model.extents
    damping = np.full(len(parameters), 1e-3)
    going = np.ones(len(parameters), bool)
    here = problem.at(parameters)
    for _ in range(trials):
        information = here.information()
        damped = information + damping[:, None, None] * (information * np.eye(len(model.steps)))
        step = -np.linalg.solve(damped, here.gradient()[..., None])[..., 0]
        trial = parameters + step
        trial[:, extents] = np.clip(trial[:, extents], model.narrowest, model.widest)
        there = problem.at(trial)
        better = going & (there.cost <= here.cost + 1e-9)
        small = (np.abs(step).max(axis=1) < enough) | (here.cost - there.cost < GAIN)
        parameters = np.where(better[:, None], trial, parameters)
        here = here.where(better, there)
        damping = np.where(better, np.maximum(0.1 * damping, 1e-6), 10.0 * damping)
        going &= ~(better & small) & (damping < MAX_DAMPING)
        if not going.any():
            break
    off = model.surface(parameters, problem.seen).off
    return Lowest(parameters, here.information(), here.cost, off)


def _padded(arrays: Sequence[Array]) -> Array:
    """Arrays of different lengths (n, ...) as one, with zeros behind the shorter ones."""
    most = max(len(item) for item in arrays)
    out = np.zeros((len(arrays), max(most, 1), *arrays[0].shape[1:]))
    for row, item in zip(out, arrays):
        row[: len(item)] = item
    return out
