# SPDX-License-Identifier: Apache-2.0
"""The shape of a block from its colours and outline, where there is no depth (goal images)."""

from __future__ import annotations

from typing import Final

import numpy as np
from numpy.typing import NDArray

from scene_graph import BOX, CYLINDER, SPHERE

from .clustering import cluster_on_line, within_cluster_cost

#: Brightness steps that the faces of a box may make at most; what is left is shading.
_FACES: Final = 3
#: Share of the variance of brightness that shading must leave over to be seen.
_SHADED: Final = 3.0
#: The lowest rows of a ball are narrower than this part of its widest row.
_BALL_BASE: Final = 0.72


def shape_from_outline(rgb: NDArray[np.uint8], mask: NDArray[np.bool_]) -> str:
    """``box``, ``cylinder`` or ``sphere``.

    The faces of a box have one brightness each; the brightness of a round block changes steadily
    from column to column. Of the round ones the ball is narrow at its lower end.

    Args:
        rgb: shape (height, width, 3).
        mask: shape (height, width), not empty.
    """
    rows, columns = np.flatnonzero(mask.any(1)), np.flatnonzero(mask.any(0))
    crop = np.s_[rows[0] : rows[-1] + 1, columns[0] : columns[-1] + 1]
    part, light = mask[crop], rgb[crop].astype(np.float64).mean(-1)
    profile = np.array([np.median(light[part[:, i], i]) for i in range(part.shape[1])])
    count = min(_FACES, len(profile))
    if len(profile) < 2 * _FACES:
        return BOX
    faces = cluster_on_line(profile, count)
    shading = np.sqrt(within_cluster_cost(profile, faces) / len(profile))
    if shading < _SHADED:
        return BOX
    widths = part.sum(1)
    base = widths[-max(2, len(widths) // 8) :].mean() / widths.max()
    return SPHERE if base < _BALL_BASE else CYLINDER
