# SPDX-License-Identifier: Apache-2.0
"""Measures each block of a picture by itself: which model explains it best, and how well."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, replace
from typing import Final

import numpy as np
from numpy.typing import NDArray

from perception_node.camera import PinholeCamera
from perception_node.errors import BadImageError, UnmeasuredError
from perception_node.quantiles import quantiles
from perception_node.segment import Segments
from scene_graph import BOX, CYLINDER

from .descent import Prior
from .evidence import Evidence, covering, evidence_of
from .fit import Fit, covariances, fit
from .models import BallModel, BoxModel, CylinderModel, Model

Array = NDArray[np.float64]

#: A box that fits as well as this is one, see ``Fit.cost``: of exact pictures it is below 0.1, with
#: noise about 0.35, and of a cylinder up to 0.5.
PERFECT: Final = 0.12
#: With noise of depth from this on [m at 1 m], as well as this.
NOISY: Final = 0.0005
PERFECT_NOISY: Final = 0.36
#: A box that is narrower than so many standard deviations of its depth may be round all the same.
NARROW: Final = 12.0
#: What fits as well as this is no ball, of which a box has more than 0.8.
GOOD: Final = 0.55
#: A shape is in doubt where another one costs hardly more than the best: of boxes and cylinders of
#: which enough is seen, the best costs at most 0.76 and, of one in a thousand, 0.93 of the other.
ALIKE: Final = 0.85
#: What fits worse than this is no upright block: one that leans by 0.1 rad has 1.5 and more.
BAD: Final = 1.2
#: Depths further than this from every model, as a root mean square, are of no upright block [m];
#: beside it as many standard deviations of their noise.
FLAT: Final = 0.003
FLAT_NOISE: Final = 1.6
#: By so much the yaw is changed at which the fit of a box begins that ended badly [rad].
TURNS: Final = (-0.08, -0.03, 0.03, 0.08)
#: Yaws at which a box's faces are looked for [rad].
YAWS: Final = np.radians(np.arange(-45.0, 45.0, 5.0))
_C, _S = np.cos(YAWS), np.sin(YAWS)
#: Normals of two of its faces at each of them, shape (yaws, 2, 2).
_AXES: Final = np.stack([np.stack([_C, _S], -1), np.stack([-_S, _C], -1)], axis=1)
#: What is known of a block beforehand, as standard deviations: where it is, how wide, its yaw.
DOUBT: Final = 0.02
YAW_DOUBT: Final = 0.5
#: How square the footprint of a box is whose depth is not seen [m].
SQUARE: Final = 0.01


@dataclass(frozen=True)
class BlockSurface:
    """One block as its own pixels show it. Lengths in m, frame world.

    Attributes:
        shape: ``box``, ``cylinder`` or ``sphere``.
        position: (x, y) of its axis.
        yaw: -π/4..π/4; 0 for round shapes.
        widths: extents along its own x and y.
        low, high: z of its lower and upper end.
        covariance: of x, y, yaw, the two widths, low and high, shape (7, 7).
        tilt: angle between its front and the vertical [rad].
        rival: a shape that explains it nearly as well; empty: there is none.
        upright: whether it is a block that stands upright; else nothing but about where it is can
            be relied on.
        seen_low: z of about the lowest of its points that are seen [m].
        behind: whether it is rather seen behind the block below it than on it; by outlines only.
        sharp: whether depth has no noise and edges are where the picture shows them.
    """

    shape: str
    position: tuple[float, float]
    yaw: float
    widths: tuple[float, float]
    low: float
    high: float
    covariance: Array
    tilt: float = 0.0
    rival: str = ""
    upright: bool = True
    seen_low: float = 0.0
    behind: bool = False
    sharp: bool = False


def measure_blocks(
    segments: Segments,
    depth: NDArray[np.floating],
    camera: PinholeCamera,
    noise: float = 0.0,
    sure: NDArray[np.bool_] | None = None,
    edge_doubt: float = 0.0,
) -> tuple[BlockSurface, ...]:
    """What a picture says about each block, in the order of the segments.

    Args:
        depth: along the optical axis; anything but a positive number means unknown, shape (height,
            width) [m].
        noise: standard deviation of depth at 1 m; it grows with the square [m].
        sure: where depth is as measured, shape (height, width); None: everywhere.
        edge_doubt: see :class:`Observation` [px].

    Raises:
        UnmeasuredError: if too little depth of a block is known; the sentence names its label.
    """
    above = covering(segments, depth, camera)
    evidence = []
    for index, (segment, covers) in enumerate(zip(segments, above)):
        try:
            evidence.append(
                evidence_of(segment, segments, depth, camera, noise, covers, sure, edge_doubt)
            )
        except BadImageError as error:
            raise UnmeasuredError(
                f"the depth of the object with label {segment.label} cannot be used: {error}; "
                "check the depth camera",
                index,
            ) from error
    surfaces = []
    fits, rivals = _best(evidence, noise)
    sharp = noise < NOISY and edge_doubt == 0.0
    for best, item, rival, covariance in zip(fits, evidence, rivals, covariances(fits)):
        far = FLAT + FLAT_NOISE * float(quantiles(item.noise, 0.5)[0])
        upright = best.distance <= far and best.cost <= BAD
        surface = _surface(best, item, covariance)
        surfaces.append(replace(surface, rival=rival, upright=upright, sharp=sharp))
    return tuple(surfaces)


def _best(evidence: Sequence[Evidence], noise: float) -> tuple[list[Fit], list[str]]:
    """For each block the model that explains it best: a box, unless something round is better.

    And the shape of another one that does nearly as well; empty: none.
    """
    best = _fit(BoxModel(), _box, evidence)
    costs = [{item.model.shape: item.cost} for item in best]
    perfect = PERFECT if noise < NOISY else PERFECT_NOISY
    for enough, model, start in ((perfect, CylinderModel(), _cylinder), (GOOD, BallModel(), _ball)):
        doubtful = [
            index
            for index, (item, seen) in enumerate(zip(best, evidence))
            if item.cost > enough or (model.shape == CYLINDER and _is_narrow(item, seen))
        ]
        others = _fit(model, start, [evidence[index] for index in doubtful])
        for index, other in zip(doubtful, others):
            costs[index][model.shape] = other.cost
            best[index] = min(best[index], other, key=lambda item: item.cost)
    _turn_poor_ones(best, evidence)
    return best, [_rival(item, others) for item, others in zip(best, costs)]


def _is_narrow(box: Fit, evidence: Evidence) -> bool:
    noise = float(quantiles(evidence.noise, 0.5)[0])
    return bool(box.parameters[box.model.extents].min() < NARROW * noise)


def _rival(best: Fit, costs: Mapping[str, float]) -> str:
    """The shape other than the best's that costs least, where that is hardly more."""
    others = {shape: cost for shape, cost in costs.items() if shape != best.model.shape}
    nearest = min(others, key=others.__getitem__, default="")
    return nearest if nearest and best.cost > ALIKE * others[nearest] else ""


def _turn_poor_ones(best: list[Fit], evidence: Sequence[Evidence]) -> None:
    """Boxes that fit badly are fitted anew: from a little further left and right, and as seen.

    Where a side is seen at a glancing angle, the descent can get stuck beside the best yaw, or
    where the block is taken to be as deep as wide.
    """
    poor = [index for index, item in enumerate(best) if item.cost > GOOD]
    again = [(index, turn) for index in poor for turn in (*TURNS, 0.0)]
    if not again:
        return
    starts, priors = [], []
    begins = {
        (index, as_seen): _box(evidence[index], as_seen=as_seen)
        for index, as_seen in {(index, turn == 0.0) for index, turn in again}
    }
    for index, turn in again:
        start, prior = begins[index, turn == 0.0]
        start = start.copy()
        start[2] += turn
        starts.append(start)
        priors.append(prior)
    fits = fit(BoxModel(), starts, priors, [evidence[index] for index, _ in again])
    for (index, _), other in zip(again, fits):
        best[index] = min(best[index], other, key=lambda item: item.cost)


def _fit(
    model: Model, start: Callable[[Evidence], tuple[Array, Prior]], evidence: Sequence[Evidence]
) -> list[Fit]:
    if not evidence:
        return []
    starts, priors = zip(*map(start, evidence))
    return fit(model, starts, priors, evidence)


def _box(evidence: Evidence, as_seen: bool = False) -> tuple[Array, Prior]:
    """Where the fit of a box begins, and what is known of it beforehand.

    Args:
        as_seen: whether no width is taken for more than is seen of it.
    """
    points = evidence.points
    low, high = quantiles(points[:, 2], 0.02, 0.98)
    walls = points[points[:, 2] < high - min(0.003, 0.3 * (high - low))]
    if len(walls) < 8:
        walls = points
    toward = evidence.camera.position_world[:2] - points[:, :2].mean(axis=0)
    yaw, front = _faces(walls[:, :2], toward)
    axes = np.array([[np.cos(yaw), np.sin(yaw)], [-np.sin(yaw), np.cos(yaw)]])
    sign = np.where(axes @ toward < 0.0, -1.0, 1.0)
    ends = quantiles(points[:, :2] @ axes.T, 0.01, 0.99)
    back = np.where(sign > 0, ends[0], ends[1])
    widths = np.maximum(sign * (front - back), 0.012)
    # What is hardly seen of a face says nothing of how far it goes.
    if widths.min() < 0.75 * widths.max() and not as_seen:
        widths[:] = widths.max()
    centre = (front - sign * 0.5 * widths) @ axes
    start = np.array([*centre, yaw, *widths, low, high])
    doubt = np.array([DOUBT, DOUBT, YAW_DOUBT, 2 * DOUBT, 2 * DOUBT, DOUBT, DOUBT])
    prior = Prior.about(start, doubt).and_also(np.array([0, 0, 0, 1.0, -1.0, 0, 0]), 0.0, SQUARE)
    return start, prior


def _faces(walls: Array, toward: Array) -> tuple[float, Array]:
    """Yaw of the two upright faces that look towards the camera, and how far out they are, (2,).

    The yaw at which the points are nearest to one or the other of two perpendicular lines.
    """
    sign = np.where(_AXES @ toward < 0.0, -1.0, 1.0)
    along = walls @ _AXES.reshape(-1, 2).T * sign.ravel()
    front = quantiles(along, 0.9)[0]
    off = np.abs(along - front).reshape(len(walls), len(YAWS), 2)
    off = np.minimum(np.minimum(off[..., 0], off[..., 1]), 0.006)
    best, front = int(off.mean(axis=0).argmin()), front.reshape(-1, 2)
    return float(YAWS[best]), front[best] * sign[best]


def _cylinder(evidence: Evidence) -> tuple[Array, Prior]:
    points = evidence.points
    low, high = quantiles(points[:, 2], 0.02, 0.98)
    toward = evidence.camera.position_world[:2] - points[:, :2].mean(axis=0)
    toward = toward / np.linalg.norm(toward)
    side = np.array([-toward[1], toward[0]])
    left, right = quantiles(points[:, :2] @ side, 0.01, 0.99)
    radius = max(0.5 * (right - left), 0.006)
    (near,) = quantiles(points[:, :2] @ toward, 0.95)
    centre = toward * (near - radius) + side * 0.5 * (left + right)
    start = np.array([*centre, radius, low, high])
    return start, Prior.about(start, np.array([DOUBT, DOUBT, 0.5 * DOUBT, DOUBT, DOUBT]))


def _ball(evidence: Evidence) -> tuple[Array, Prior]:
    points = evidence.points
    middle = points.mean(axis=0)
    toward = evidence.camera.position_world - middle
    toward = toward / np.linalg.norm(toward)
    off = points - middle
    off = off - (off @ toward)[:, None] * toward
    radius = max(float(np.quantile(np.linalg.norm(off, axis=1), 0.98)), 0.006)
    near = float(np.quantile(points @ toward, 0.95))
    start = np.array([*(middle + toward * (near - radius - float(middle @ toward))), radius])
    return start, Prior.about(start, np.array([DOUBT, DOUBT, DOUBT, 0.5 * DOUBT]))


def _surface(best: Fit, evidence: Evidence, covariance: Array) -> BlockSurface:
    """What was fitted, in the parameters of a box; the covariance is that of the model's own."""
    p = best.parameters
    if best.model.shape == BOX:
        turn = round(p[2] / (np.pi / 2))
        widths = (p[3], p[4]) if turn % 2 == 0 else (p[4], p[3])
        order = [0, 1, 2, 3, 4, 5, 6] if turn % 2 == 0 else [0, 1, 2, 4, 3, 5, 6]
        covariance = covariance[np.ix_(order, order)]
        values = np.array([p[0], p[1], p[2] - turn * np.pi / 2, *widths, p[5], p[6]])
    else:
        to_box = np.zeros((7, len(p)))
        to_box[[0, 1], [0, 1]] = 1.0
        if best.model.shape == CYLINDER:
            to_box[[3, 4, 5, 6], [2, 2, 3, 4]] = 2.0, 2.0, 1.0, 1.0
        else:
            to_box[[3, 4], 3] = 2.0
            to_box[[5, 6], 2] = 1.0
            to_box[[5, 6], 3] = -1.0, 1.0
        values, covariance = to_box @ p, to_box @ covariance @ to_box.T
    x, y, yaw, along, across, low, high = (float(value) for value in values)
    return BlockSurface(
        best.model.shape, (x, y), yaw, (along, across), low, high, covariance,
        _tilt(best, evidence) if best.model.shape == BOX else 0.0,
        seen_low=float(quantiles(evidence.points[:, 2], 0.02)[0]),
    )  # fmt: skip


def _tilt(best: Fit, evidence: Evidence) -> float:
    """Angle between the walls and the vertical, 0 where it is not more than noise [rad]."""
    low, high = best.parameters[5:7]
    points = evidence.points
    walls = points[:, 2] < high - 0.1 * (high - low)
    if np.count_nonzero(walls) < 8:
        return 0.0
    off = best.off[walls]
    up = points[walls, 2] - points[walls, 2].mean()
    away = np.abs(off - quantiles(off, 0.5)[0])
    inlier = away < 3.0 * quantiles(away, 0.5)[0] + 1e-6
    off, up = off[inlier] - off[inlier].mean(), up[inlier] - up[inlier].mean()
    spread = float(up @ up)
    if spread < 1e-9:
        return 0.0
    slope = float(off @ up) / spread
    doubt = float(np.sqrt(np.mean((off - slope * up) ** 2) / spread))
    return float(np.arctan(abs(slope))) if abs(slope) > 4.0 * doubt else 0.0
