# SPDX-License-Identifier: Apache-2.0
"""The shape of a block from its colours and outline, where there is no depth (goal images)."""

from __future__ import annotations

from typing import Final

import cv2
import numpy as np
from numpy.typing import NDArray

from perception_node.clustering import cluster_on_line, within_cluster_cost
from scene_graph import BOX, CYLINDER, SPHERE

#: A box shows at most this many faces, each of one brightness.
_FACES: Final = 3
#: Spread of brightness left within the faces, relative to the brightness, from which it is shading.
_SHADED: Final = 0.02
#: A row is full that is at least this part of the widest row.
_FULL: Final = 0.9
#: Share of full rows from which a round block is a cylinder; a ball has 0.44 of them.
_STRAIGHT: Final = 0.62
#: In blocks as dark as this so much of it is rounding, and where neighbours differ noise, up to
#: this [0..255].
_DARK: Final = 32.0
_ROUNDING: Final = 0.15
_NOISE: Final = 0.64
#: Pixels whose channels' shares of the sum differ by more from the block's are of something else.
_SAME_HUE: Final = 0.06
#: So many pixels at the rim are mixtures, where that leaves at least this part of the mask [px].
_RIM: Final = 1
_LEFT: Final = 0.5
#: Number of brightness values that are looked at.
_SAMPLES: Final = 48


def shape_from_outline(rgb: NDArray[np.uint8], mask: NDArray[np.bool_]) -> str:
    """``box``, ``cylinder`` or ``sphere``.

    The faces of a box have one brightness each, that of a round block changes steadily. Of the
    round ones the cylinder has straight sides.

    Args:
        rgb: shape (height, width, 3).
        mask: shape (height, width), not empty.
    """
    mask = _of_one_hue(rgb, mask)
    light = np.sort(rgb[mask].max(axis=-1).astype(np.float64))
    samples = light[np.linspace(0, len(light) - 1, min(_SAMPLES, len(light))).round().astype(int)]
    faces = cluster_on_line(samples, min(_FACES, len(samples)))
    spread = np.sqrt(within_cluster_cost(samples, faces) / len(samples))
    middle = float(np.median(light))
    grain = min(_ROUNDING + _grain(rgb, mask), _NOISE)
    if spread < (grain if middle < _DARK else _SHADED * middle):
        return BOX
    widths = mask.sum(axis=1)
    widths = widths[widths > 0]
    return CYLINDER if np.mean(widths >= _FULL * widths.max()) > _STRAIGHT else SPHERE


def _grain(rgb: NDArray[np.uint8], mask: NDArray[np.bool_]) -> float:
    """By how much the brightness of half of the neighbours in a row differs [0..255]."""
    left, top, width, height = cv2.boundingRect(mask.view(np.uint8))
    box = np.s_[top : top + height, left : left + width]
    light, inside = rgb[box].max(axis=-1).astype(np.float64), mask[box]
    both = inside[:, 1:] & inside[:, :-1]
    return float(np.median(np.abs(np.diff(light, axis=1))[both])) if both.any() else 0.0


def _of_one_hue(rgb: NDArray[np.uint8], mask: NDArray[np.bool_]) -> NDArray[np.bool_]:
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
