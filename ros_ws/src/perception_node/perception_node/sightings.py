# SPDX-License-Identifier: Apache-2.0
"""Blocks as several cameras see them: which sightings are of one block, and what they say of it.

Measurements are normal distributions; those of one block are joined by their information,
C = (Σ Cᵢ⁻¹)⁻¹, x = C Σ Cᵢ⁻¹ xᵢ.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace
from itertools import combinations
from typing import Final

import numpy as np
from numpy.typing import NDArray
from scipy.optimize import linear_sum_assignment

from scene_graph import BOX, SceneObject

from .blocks import BlockSurface
from .errors import ContradictionError
from .pipeline import Perceived

Array = NDArray[np.float64]

#: Axes or upper ends of one block as two cameras measure them are no further apart [m], and up to
#: twice as far where that is within two standard deviations.
SAME_BLOCK: Final = 0.02
#: Where they are further apart than this and so many standard deviations, a calibration is wrong.
AGREES: Final = 0.006
DEVIATIONS: Final = 4.0
#: Two cameras may see all blocks so far from one another, as calibrations are not exact [m].
OFFSET: Final = 0.004
#: x, y and high among the parameters of a surface.
_SPOT: Final = [0, 1, 6]
#: x, y, low and high among them.
_WHERE: Final = [0, 1, 5, 6]


@dataclass(frozen=True)
class Sighting:
    """One block in one view.

    Attributes:
        camera: its name.
        index: of the block in the view.
        surface: as measured.
        item: of the view's own graph.
        covered: whether something before it covers a part.
    """

    camera: str
    index: int
    surface: BlockSurface
    item: SceneObject
    covered: bool

    @property
    def spot(self) -> Array:
        """x, y of the axis, z of the upper end: also known of a covered one, shape (3,) [m]."""
        return np.array([*self.surface.position, self.surface.high])

    @property
    def doubt(self) -> Array:
        """Standard deviations of the spot, shape (3,) [m]."""
        return np.asarray(np.sqrt(np.diag(self.surface.covariance)[_SPOT]))


#: All of one block, one a camera at most.
Sightings = tuple[Sighting, ...]


def sightings(camera: str, perceived: Perceived) -> list[Sighting]:
    """What a camera sees, in the order of its segments."""
    view, graph = perceived.view, perceived.graph
    assert view is not None
    if view.names is None:
        return []
    return [
        Sighting(camera, index, surface, graph.object(name), index in view.seen.partly)
        for index, (surface, name) in enumerate(zip(view.seen.surfaces, view.names.names))
    ]


def matched(found: Sequence[Sightings], seen: Sequence[Sighting]) -> list[Sightings]:
    """Blocks that are known, with one sighting more each where there is one, and new ones.

    One sighting belongs to one block at most: those whose distances are least in sum.
    """
    if not found or not seen:
        return [*found, *((one,) for one in seen)]
    spots = np.array([np.mean([one.spot for one in block], axis=0) for block in found])
    doubts = np.array([np.max([one.doubt for one in block], axis=0) for block in found])
    apart = np.abs(spots[:, None] - np.array([one.spot for one in seen]))
    doubt = np.hypot(doubts[:, None], np.array([one.doubt for one in seen]))
    apart = np.maximum(apart - np.minimum(2.0 * doubt, SAME_BLOCK), 0.0)
    far = np.maximum(np.hypot(apart[..., 0], apart[..., 1]), apart[..., 2])
    rows, columns = linear_sum_assignment(np.minimum(far, SAME_BLOCK))
    of = {int(i): seen[int(j)] for i, j in zip(rows, columns) if far[i, j] < SAME_BLOCK}
    more = [(one,) for one in seen if all(one is not other for other in of.values())]
    return [*(block + ((of[i],) if i in of else ()) for i, block in enumerate(found)), *more]


def fused(block: Sightings) -> BlockSurface:
    """The measurement of all views that see a block uncovered; of all where there is none.

    Where they differ by more than they say, its covariance is larger by as much: χ² / degrees.

    Raises:
        ContradictionError: if they differ by more than they can.
    """
    used = [one for one in block if not one.covered] or list(block)
    for one in used[1:]:
        _check_agreement(used[0], one)
    best = min(used, key=lambda one: float(np.trace(one.surface.covariance[:2, :2])))
    alike = [one for one in used if one.surface.shape == best.surface.shape]
    parts = [_turned_like(one.surface, best.surface) for one in alike]
    values = np.array([part for part, _ in parts])
    information = np.array([np.linalg.pinv(part, hermitian=True) for _, part in parts])
    covariance = np.linalg.pinv(information.sum(axis=0), hermitian=True)
    mean = covariance @ np.einsum("vij,vj->i", information, values)
    if len(alike) > 1:
        off = values - mean
        degrees = len(mean) * (len(alike) - 1)
        covariance *= max(1.0, np.einsum("vi,vij,vj->", off, information, off) / degrees)
    quarters = round(mean[2] / (0.5 * np.pi))
    mean, covariance = _turned(mean, covariance, -quarters)
    x, y, yaw, along, across, low, high = (float(value) for value in mean)
    others = {one.surface.shape for one in used} - {best.surface.shape}
    return replace(
        best.surface,
        position=(x, y),
        yaw=yaw,
        widths=(along, across),
        low=low,
        high=high,
        covariance=covariance,
        tilt=max(one.surface.tilt for one in used),
        rival=min(others) if others else best.surface.rival,
        seen_low=min(one.surface.seen_low for one in block),
        sharp=all(one.surface.sharp for one in used),
    )


def check_offset(found: Sequence[Sightings]) -> None:
    """Raises ContradictionError if one camera sees all blocks beside where another one does.

    The offset is that of least Σ (dᵢ - t)ᵀ Wᵢ (dᵢ - t), Wᵢ⁻¹ the covariance of a difference dᵢ, so
    that blocks of which each camera sees a part tell together what none of them does.
    """
    pairs: dict[tuple[str, str], list[tuple[Sighting, Sighting]]] = {}
    for block in found:
        for one, other in combinations(block, 2):
            pairs.setdefault((one.camera, other.camera), []).append((one, other))
    for (camera, another), both in pairs.items():
        apart = np.array([other.spot - one.spot for one, other in both])
        rows = np.ix_(_SPOT, _SPOT)
        weights = np.array(
            [
                np.linalg.inv(one.surface.covariance[rows] + other.surface.covariance[rows])
                for one, other in both
            ]
        )
        total = weights.sum(axis=0)
        offset = np.linalg.solve(total, np.einsum("bij,bj->i", weights, apart))
        far = float(np.linalg.norm(offset))
        if far > OFFSET and offset @ total @ offset > DEVIATIONS**2:
            names = ", ".join(sorted(one.item.name for one, _ in both))
            raise ContradictionError(
                f"{names} for {another} are {1000 * far:.0f} mm from where {camera} sees them; "
                f"check {camera}/extrinsics and {another}/extrinsics"
            )


def _turned_like(surface: BlockSurface, like: BlockSurface) -> tuple[Array, Array]:
    """Parameters and covariance, those of a box by the quarter turn that is nearest to another."""
    values = np.array([*surface.position, surface.yaw, *surface.widths, surface.low, surface.high])
    quarters = round((like.yaw - surface.yaw) / (0.5 * np.pi)) if surface.shape == BOX else 0
    return _turned(values, surface.covariance, quarters)


def _turned(values: Array, covariance: Array, quarters: int) -> tuple[Array, Array]:
    """The same box, so many quarter turns further."""
    order = [0, 1, 2, 4, 3, 5, 6] if quarters % 2 else [*range(7)]
    values = values + 0.5 * np.pi * quarters * (np.arange(7) == 2)
    return values[order], covariance[np.ix_(order, order)]


def _check_agreement(one: Sighting, other: Sighting) -> None:
    """Raises ContradictionError if two cameras see one block at two spots."""
    (here, doubt), (there, other_doubt) = (
        _turned_like(item.surface, one.surface) for item in (one, other)
    )
    apart = np.abs(here - there)[_WHERE]
    most = AGREES + DEVIATIONS * np.sqrt(np.diag(doubt + other_doubt))[_WHERE]
    if (apart > most).any():
        raise ContradictionError(
            f"{other.item.name} is {1000 * apart.max():.0f} mm from where {one.camera} sees it for "
            f"{other.camera}; check {one.camera}/extrinsics and {other.camera}/extrinsics, and "
            "that nothing moved between the pictures"
        )
