# SPDX-License-Identifier: Apache-2.0
"""Names blocks by what can be seen: ``red_box``, and ``red_box_2`` where there are two."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Final

import cv2
import numpy as np
from numpy.typing import NDArray

from scene_graph import BASIC_COLORS, COLORS, object_name

from .segment import Segments

Array = NDArray[np.float64]

_NAMES: Final = BASIC_COLORS
#: Brightness that a surface may have, relative to the colour's own, in equal ratios.
_SHADES: Final = np.geomspace(0.3, 1.4, 24)
#: Cost of a block's shade that differs from the scene's, per squared logarithm [ΔE²].
_OWN_SHADE_COST: Final = 1600.0
#: Cost of a scene's shade that differs from the usual one, per squared logarithm [ΔE²].
_SCENE_SHADE_COST: Final = 100.0
_USUAL_SHADE: Final = 0.8


@dataclass(frozen=True)
class Names:
    """What the N blocks of a scene are called, in the order of their segments.

    Attributes:
        colors: names of ``scene_graph.BASIC_COLORS``.
        names: unique.
    """

    colors: tuple[str, ...]
    names: tuple[str, ...]


def name_blocks(
    rgb: NDArray[np.uint8],
    segments: Segments,
    shapes: Sequence[str],
    stacks: Sequence[Sequence[int]],
) -> Names:
    """Names every block by its colour and shape.

    Args:
        rgb: shape (height, width, 3).
        shapes, stacks: see :func:`unique_names`.
    """
    colors = color_names(mean_colors(rgb, [segment.part for segment in segments]))
    return Names(colors, unique_names(colors, shapes, stacks))


def mean_colors(rgb: NDArray[np.uint8], masks: Sequence[NDArray[np.bool_]]) -> Array:
    """The colour of the largest face of each block: the median over its pixels.

    Args:
        rgb: shape (height, width, 3).
        masks: N masks of shape (height, width), none empty.

    Returns:
        sRGB in 0..1, shape (N, 3).
    """
    medians = []
    for mask in masks:
        left, top, width, height = cv2.boundingRect(mask.astype(np.uint8))
        box = np.s_[top : top + height, left : left + width]
        pixels = rgb[box][mask[box]]
        medians.append(np.partition(pixels, len(pixels) // 2, axis=0)[len(pixels) // 2])
    return np.array(medians).reshape(-1, 3) / 255.0


def color_names(colors: Array) -> tuple[str, ...]:
    """The nearest of ``scene_graph.BASIC_COLORS`` for each colour, in CIE Lab, whatever the light.

    Light and shade scale a colour, which alone would turn orange into brown. The blocks of a scene
    are lit alike, so one shade is sought that explains all of them best; each may differ from it a
    little, at a cost.

    Args:
        colors: sRGB in 0..1, shape (N, 3).
    """
    if len(colors) == 0:
        return ()
    palette = np.array([COLORS[name] for name in _NAMES])
    shaded = np.clip(palette[None] * _SHADES[:, None, None], 0.0, 1.0)
    difference = _lab(shaded)[None] - _lab(colors)[:, None, None]
    distance = np.sum(difference**2, axis=-1)  # (N, shades of the block, names)
    ratio = np.log(_SHADES[:, None] / _SHADES[None])  # (shades of the block, shades of the scene)
    # (N, scene's shade, name): the block's own shade chosen freely
    cost = (distance[:, :, None] + _OWN_SHADE_COST * (ratio**2)[None, :, :, None]).min(axis=1)
    scene = cost.min(axis=2).sum(axis=0) + _SCENE_SHADE_COST * np.log(_SHADES / _USUAL_SHADE) ** 2
    best = cost[:, int(scene.argmin())].argmin(axis=1)
    return tuple(_NAMES[index] for index in best)


def _lab(rgb: Array) -> Array:
    """CIE Lab of sRGB in 0..1, shape (..., 3)."""
    image = np.ascontiguousarray(rgb, np.float32).reshape(1, -1, 3)
    return cv2.cvtColor(image, cv2.COLOR_RGB2LAB).astype(np.float64).reshape(rgb.shape)


def unique_names(
    colors: Sequence[str], shapes: Sequence[str], stacks: Sequence[Sequence[int]]
) -> tuple[str, ...]:
    """``color_shape`` for each object; equal ones are numbered from the left and the bottom.

    Args:
        colors, shapes: of all N objects.
        stacks: their indices from the bottom of each stack, from the left.
    """
    names = [""] * len(colors)
    seen: dict[str, int] = {}
    for stack in stacks:
        for index in stack:
            name = object_name(colors[index], shapes[index])
            seen[name] = seen.get(name, 0) + 1
            names[index] = name if seen[name] == 1 else f"{name}_{seen[name]}"
    return tuple(names)
