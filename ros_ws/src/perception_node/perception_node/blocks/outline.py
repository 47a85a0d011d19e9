# SPDX-License-Identifier: Apache-2.0
"""The shape of a block from its colours and outline, where there is no depth (goal images)."""

from __future__ import annotations

from typing import Final

import cv2
import numpy as np
from numpy.typing import NDArray

from scene_graph import BOX, CYLINDER, SPHERE

Array = NDArray[np.float64]
Mask = NDArray[np.bool_]

#: By so much the brightness of a face differs from what is fitted to it, and increases at most from
#: its middle by half of the block's width, as standard deviations, as parts of the brightness.
_UNEVEN: Final = 0.01
_SLOPE: Final = 0.08
#: Where light may come from beside the direction of sight [rad].
_LIGHTS: Final = np.radians(np.arange(-165.0, 166.0, 15.0))
#: Sums of squares by which a round block explains the brightness better than a box does.
_ROUND: Final = 1.8
#: The part of each column that is looked at, from above: neither top nor lower edge.
_FRONT: Final = (0.45, 0.92)
#: So far from the middle columns are looked at, as a part of half of the width, and so many pixels
#: from the rim.
_ASIDE: Final = 0.92
_OUTER: Final = 1.5
#: What is next to an edge between two faces is a mixture: its weight.
_MIXED: Final = 0.1
#: Brightness is rounded by this, and so many times the median difference of neighbours is noise, as
#: standard deviations [0..255].
_ROUNDING: Final = 0.6
_NOISE: Final = 1.5
#: A row is full that is at least this part of the widest row.
_FULL: Final = 0.9
#: Share of full rows from which a round block is a cylinder; a ball has 0.44 of them.
_STRAIGHT: Final = 0.62
#: Pixels whose channels' shares of the sum differ by more from the block's are of something else.
_SAME_HUE: Final = 0.06
#: So many pixels at the rim are mixtures, where that leaves at least this part of the mask [px].
_RIM: Final = 1
_LEFT: Final = 0.5
#: Fewer columns say nothing.
_FEW: Final = 5
_TINY: Final = 1e-6


def shape_from_outline(rgb: NDArray[np.uint8], mask: Mask, better: float = _ROUND) -> str:
    """``box``, ``cylinder`` or ``sphere``.

    Seen from the front a box has one or two faces, each about evenly bright; the brightness of a
    round block at x, from -1 to 1 across it, is that of a surface whose normal turns with x, lit
    from an angle t: a + b max(0, x sin t + √(1 - x²) cos t). The better explanation decides. Of the
    round ones the cylinder has straight sides.

    Args:
        rgb: shape (height, width, 3).
        mask: shape (height, width), not empty.
        better: sums of squares by which a round block has to explain the brightness better.
    """
    x, light, weights = _across(rgb, mask)
    if len(x) < _FEW or _as_box(x, light, weights) - _as_round(x, light, weights) < better:
        return BOX
    widths = mask.sum(axis=1)
    widths = widths[widths > 0]
    return CYLINDER if np.mean(widths >= _FULL * widths.max()) > _STRAIGHT else SPHERE


def _across(rgb: NDArray[np.uint8], mask: Mask) -> tuple[Array, Array, Array]:
    """Where columns are, -1..1 across the block; their brightness, about 1; how sure that is."""
    left, top, wide, high = cv2.boundingRect(mask.astype(np.uint8))
    box = np.s_[top : top + high, left : left + wide]
    rgb, mask = rgb[box], mask[box]
    kept = _of_one_hue(rgb, mask)
    color = np.median(rgb[kept].astype(np.float64), axis=0)
    bright = rgb @ (color / max(float(color @ color), 1.0))
    doubt = max(_NOISE * _grain(rgb, kept), _ROUNDING) / max(float(color.max()), 1.0)
    rows = np.arange(high)[:, None]
    first, last = mask.argmax(axis=0), high - 1 - mask[::-1].argmax(axis=0)
    length = last - first + 1
    inside = (rows >= first + _FRONT[0] * length) & (rows <= first + _FRONT[1] * length)
    x = (2.0 * np.arange(wide) + 1.0) / wide - 1.0
    inside &= kept & (np.abs(x) < min(_ASIDE, 1.0 - 2.0 * (_OUTER + 0.5) / wide + _TINY))
    count = inside.sum(axis=0)
    some = count > 0
    light = (bright * inside).sum(axis=0)[some] / count[some]
    return x[some], light, 1.0 / (_UNEVEN**2 + doubt**2 / count[some])


def _as_box(x: Array, light: Array, weights: Array) -> float:
    """The least sum of squares of one face, or of two with the edge between any two columns."""
    count = len(x)
    edges = np.array([0, *range(2, count - 1)])[:, None]
    columns = np.arange(count)
    left = (columns < edges).astype(np.float64)
    right = 1.0 - left
    by_edge = (edges > 0) & ((columns == edges) | (columns == edges - 1))
    shares = weights * np.where(by_edge, _MIXED, 1.0)
    slopes = []
    for face in (left, right):
        middle = (face @ x) / np.maximum(face.sum(axis=1), 1.0)
        slopes.append(face * (x - middle[:, None]))
    terms = np.stack([left, right, *slopes], axis=-1)
    return _least(terms, light, shares, np.array([_TINY, _TINY, _SLOPE**-2, _SLOPE**-2]))


def _as_round(x: Array, light: Array, weights: Array) -> float:
    """The least sum of squares of an upright cylinder, lit from anywhere."""
    ahead = np.sqrt(np.maximum(1.0 - x**2, 0.0))
    lit = np.maximum(np.sin(_LIGHTS)[:, None] * x + np.cos(_LIGHTS)[:, None] * ahead, 0.0)
    terms = np.stack([np.ones_like(lit), lit], axis=-1)
    return _least(terms, light, np.broadcast_to(weights, lit.shape), np.full(2, _TINY), True)


def _least(
    terms: Array, light: Array, weights: Array, known: Array, brighter: bool = False
) -> float:
    """The least sum of squares of k fits of m terms to n values.

    Args:
        terms: shape (k, n, m).
        weights: shape (k, n).
        known: weights of the factors themselves, which are about 0, shape (m,).
        brighter: whether the last factor is not negative.
    """
    weighted = weights[..., None] * terms
    normal = np.einsum("kni,knj->kij", weighted, terms) + np.diag(known)
    right = np.einsum("kni,n->ki", weighted, light)
    factors = np.linalg.solve(normal, right[..., None])[..., 0]
    off = np.einsum("kni,ki->kn", terms, factors) - light
    sums = (weights * off**2).sum(axis=1) + (known * factors**2).sum(axis=1)
    if brighter:
        sums = np.where(factors[:, -1] >= 0.0, sums, np.inf)
    return float(sums.min())


def _grain(rgb: NDArray[np.uint8], mask: Mask) -> float:
    """By how much the brightness of half of the neighbours in a row differs [0..255]."""
    light = rgb.max(axis=-1).astype(np.float64)
    both = mask[:, 1:] & mask[:, :-1]
    return float(np.median(np.abs(np.diff(light, axis=1))[both])) if both.any() else 0.0


def _of_one_hue(rgb: NDArray[np.uint8], mask: Mask) -> Mask:
    """The mask without what has another hue than most of it: what is beside an inexact one."""
    values = rgb[mask].astype(np.float64) + 1.0
    shares = values / values.sum(axis=1, keepdims=True)
    same = np.abs(shares - np.median(shares, axis=0)).max(axis=1) < _SAME_HUE
    kept = np.zeros_like(mask)
    kept[mask] = same
    inner = cv2.erode(kept.astype(np.uint8), np.ones((2 * _RIM + 1,) * 2, np.uint8)).astype(bool)
    enough = _LEFT * np.count_nonzero(mask)
    if np.count_nonzero(kept) < enough:
        return mask
    return inner if np.count_nonzero(inner) >= enough else kept
