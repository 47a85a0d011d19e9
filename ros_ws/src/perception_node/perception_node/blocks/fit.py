# SPDX-License-Identifier: Apache-2.0
"""Fits models of blocks to what a picture says about them, with the covariance of the result.

Maximum likelihood: points are normal about the model's faces, the points of the outline about the
model's outline, to a fraction of a pixel. Gauss-Newton with Huber's weights, so that a few pixels
of another thing do little; the inverse of the normal matrix is the covariance. All blocks of a
scene are fitted side by side.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Final, NamedTuple

import cv2
import numpy as np
from numpy.typing import NDArray

from perception_node.camera import PinholeCamera

from .evidence import Evidence
from .models import Model, Seen

Array = NDArray[np.float64]

#: Residuals beyond so many standard deviations count less than by their square.
HUBER: Final = 2.0
#: At first depths and outline count as if they were so much less exact, so that what is far off
#: pulls all the same: standard deviation of a surface [m], factor for the outline's.
COARSE: Final = (0.004, 2.0)
#: Trials of the coarse and of the exact descent, and steps that are the end of it [m, rad].
MAX_TRIALS: Final = (4, 7)
ENOUGH: Final = (1e-3, 1e-4)
#: A step that lowers the cost by less is the last.
GAIN: Final = 0.02
#: A block that no step with less damping improves is done.
MAX_DAMPING: Final = 1e4
#: Edges of an outline shorter than this have no direction that can be told [px].
SHORT_EDGE: Final = 0.2
#: By this much an extent is changed to see what the picture says of it [m].
PROBE: Final = 0.005


@dataclass(frozen=True)
class Fit:
    """A model that was fitted.

    Attributes:
        model: its kind.
        parameters: shape (P,).
        covariance: shape (P, P).
        cost: half the sum of squared residuals, Huber's beyond :data:`HUBER`, a residual.
        distance: of the points from the model, as a root mean square, the farthest fifth left
            out [m].
    """

    model: Model
    parameters: Array
    covariance: Array
    cost: float
    distance: float


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


@dataclass(frozen=True)
class _Problem:
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
    def of(cls, model: Model, priors: Sequence[Prior], evidence: Sequence[Evidence]) -> _Problem:
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

    def blurred(self) -> _Problem:
        """The same with everything less exact, see :data:`COARSE`."""
        seen = self.seen._replace(floor=COARSE[0])
        return _Problem(
            self.model, self.camera, seen, self.used, self.outline, self.inverse / COARSE[1],
            self.rows, self.values,
        )  # fmt: skip

    def repeated(self, times: int) -> _Problem:
        """The same blocks so many times, one after another."""

        def again(array: Array) -> Array:
            return np.concatenate([array] * times)

        seen = self.seen
        points, rays, noise = again(seen.points), again(seen.rays), again(seen.noise)
        return _Problem(
            self.model, self.camera, Seen(seen.origin, points, rays, noise, seen.floor),
            again(self.used), again(self.outline), again(self.inverse),
            again(self.rows), again(self.values),
        )  # fmt: skip

    def at(self, parameters: Array) -> _Linearised:
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


def fit(
    model: Model, starts: Sequence[Array], priors: Sequence[Prior], evidence: Sequence[Evidence]
) -> list[Fit]:
    """Fits a model to each of B blocks.

    Args:
        starts: parameters to begin with, shape (P,) each.
        evidence: from one picture; at least one.
    """
    problem = _Problem.of(model, priors, evidence)
    near, _ = _descend(problem.blurred(), np.stack(starts), MAX_TRIALS[0], ENOUGH[0])
    parameters, found = _descend(problem, near, MAX_TRIALS[1], ENOUGH[1])
    off = model.surface(parameters, problem.seen).off
    covariances = _covariances(problem, parameters, found)
    fits = []
    for index, item in enumerate(evidence):
        squares = np.sort(off[index, : len(item.noise)] ** 2)[: max(1, (4 * len(item.noise)) // 5)]
        fits.append(
            Fit(
                model,
                parameters[index],
                covariances[index],
                float(found.cost[index]) / (len(item.noise) + len(item.outline)),
                float(np.sqrt(squares.mean())),
            )
        )
    return fits


def _descend(
    problem: _Problem, parameters: Array, trials: int, enough: float
) -> tuple[Array, _Linearised]:
    """Damped Gauss-Newton of all blocks side by side."""
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
    return parameters, here


def _covariances(problem: _Problem, parameters: Array, found: _Linearised) -> Array:
    """Inverses of the information, shape (B, P, P), wider where the cost is flatter than it says.

    An edge at the back that the front just hides bounds a width on one side only: derivatives take
    it for known. So each extent is changed by :data:`PROBE` both ways, the front staying where it
    is, and what the cost says of that counts.
    """
    information = found.information()
    covariances = np.linalg.inv(information)
    hidden = problem.model.hidden(parameters, problem.camera.position_world)
    if not len(hidden):
        return np.asarray(covariances, np.float64)
    # All at once, both ways of each direction as blocks of their own.
    changes = PROBE * np.concatenate([hidden, -hidden])
    costs = problem.repeated(len(changes)).at(
        (parameters + changes).reshape(-1, parameters.shape[1])
    )
    rises = costs.cost.reshape(2, len(hidden), -1).min(axis=0) - found.cost
    # A parabola that rises by this much over the step has this variance.
    variances = PROBE**2 / (2.0 * np.maximum(rises, 1e-3))
    for directions, variance in zip(hidden, variances):
        mine = 1.0 / np.einsum("bp,bpq,bq->b", directions, information, directions)
        wider = np.maximum(variance - mine, 0.0)
        covariances += wider[:, None, None] * directions[:, :, None] * directions[:, None]
    return np.asarray(covariances, np.float64)


def _padded(arrays: Sequence[Array]) -> Array:
    """Arrays of different lengths (n, ...) as one, with zeros behind the shorter ones."""
    most = max(len(item) for item in arrays)
    out = np.zeros((len(arrays), max(most, 1), *arrays[0].shape[1:]))
    for row, item in zip(out, arrays):
        row[: len(item)] = item
    return out
