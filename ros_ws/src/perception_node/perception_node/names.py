# SPDX-License-Identifier: Apache-2.0
"""Names blocks by what can be seen: ``red_box``, and ``red_box_2`` where there are two."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Final

import cv2
import numpy as np
from numpy.typing import NDArray

from scene_graph import UNKNOWN, object_name

from .light import MIN_MARGIN, ColorFit, explain_colors
from .name_sets import NameSets, possible_colors
from .quantiles import quantile_of_codes
from .segment import Segments

Array = NDArray[np.float64]

#: The table is what is below blocks in the picture, between these parts of its width away from
#: them, in at least so many pixels.
_BEFORE: Final = (0.012, 0.05)
_SOME: Final = 20
#: Where the counts of each channel's values begin.
_CHANNELS: Final = np.arange(0, 3 * 256, 256)
_EXCHANGED: Final = (
    "some colours have no name, but all have one with red and blue exchanged; "
    "is the picture's encoding (rgb8, bgr8) the one it is sent with?"
)


@dataclass(frozen=True)
class Names:
    """What the N blocks of a scene are called, in the order of their segments.

    Attributes:
        colors: names of ``scene_graph.COLORS``, ``UNKNOWN`` where none fits.
        names: unique.
        doubt: a sentence about the first block whose colour has no certain name; empty if all have.
        alternatives: the colours that each may have instead; empty where all are certain, or where
            what they may be is not known.
        distance, margin: the worst of all blocks, see :class:`ColorFit` [ΔE].
    """

    colors: tuple[str, ...]
    names: tuple[str, ...]
    doubt: str = ""
    distance: float = 0.0
    margin: float = np.inf
    alternatives: tuple[tuple[str, ...], ...] = ()


def name_blocks(
    rgb: NDArray[np.uint8],
    segments: Segments,
    shapes: Sequence[str],
    stacks: Sequence[Sequence[int]],
    sets: NameSets | None = None,
) -> Names:
    """Names every block by its colour and shape.

    Args:
        rgb: shape (height, width, 3).
        shapes, stacks: see :func:`unique_names`.
        sets: how colours in doubt become sets of colours; None: they do not.
    """
    parts = [segment.part for segment in segments]
    colors, table = mean_colors(rgb, parts), color_before(rgb, parts)
    fit = explain_colors(colors, table)
    known = tuple(name if sure else UNKNOWN for name, sure in zip(fit.names, fit.known))
    names = unique_names(known, shapes, stacks)
    doubt, possible = _doubt(fit, colors, table, names), None
    if doubt and doubt != _EXCHANGED and sets is not None:
        possible = possible_colors(fit, colors, table, sets.threshold)
    alternatives: tuple[tuple[str, ...], ...] = ()
    if possible is not None:
        alternatives = tuple(
            tuple(other for other in some if other != own) for some, own in zip(possible, known)
        )
        doubt = _choice(colors, names, possible)
    return Names(
        known,
        names,
        doubt,
        float(fit.distances.max(initial=0.0)),
        float(fit.margins.min(initial=np.inf)),
        alternatives,
    )


def _choice(colors: Array, names: Sequence[str], possible: Sequence[Sequence[str]]) -> str:
    """A sentence about the colours that blocks may have."""
    told = [
        f"the colour of {name}, {_code(color)}, may be {' or '.join(some)}"
        for name, color, some in zip(names, colors, possible)
        if len(some) > 1
    ]
    return f"{' and '.join(told)}; give it more light, or say which it is"


def _code(color: Array) -> str:
    red, green, blue = (round(255.0 * float(value)) for value in color)
    return f"({red}, {green}, {blue}) of 255"


def _doubt(fit: ColorFit, colors: Array, table: Array | None, names: Sequence[str]) -> str:
    """A sentence about the first colour without a certain name, or an empty string."""
    if not fit.known.all():
        exchanged = explain_colors(colors[:, ::-1], None if table is None else table[::-1])
        if exchanged.known.all() and (exchanged.margins >= MIN_MARGIN).all():
            return _EXCHANGED
    for index, name in enumerate(names):
        seen = f"the colour of {name}, {_code(colors[index])},"
        if not fit.known[index]:
            return f"{seen} is none that has a name; is the light very coloured or too bright?"
        if fit.margins[index] < MIN_MARGIN:
            return f"{seen} may be {fit.names[index]} or {fit.others[index]}; give it more light"
    return ""


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
        left, top, width, height = cv2.boundingRect(mask.view(np.uint8))
        box = np.s_[top : top + height, left : left + width]
        pixels = rgb[box][mask[box]]
        counts = np.bincount((pixels + _CHANNELS).ravel(), minlength=3 * 256).reshape(3, 256)
        medians.append((counts.cumsum(axis=1) <= len(pixels) // 2).sum(axis=1))
    return np.array(medians).reshape(-1, 3) / 255.0


def color_before(rgb: NDArray[np.uint8], masks: Sequence[NDArray[np.bool_]]) -> Array | None:
    """What the picture shows right below blocks, beside their shadow: the table before them.

    Args:
        rgb: shape (height, width, 3).
        masks: N masks of shape (height, width), none empty.

    Returns:
        sRGB in 0..1, shape (3,); None where too little of it is seen.
    """
    if not masks:
        return None
    taken = np.zeros(rgb.shape[:2], bool)
    for mask in masks:
        taken |= mask
    near, far = (round(part * rgb.shape[1]) for part in _BEFORE)
    strips = []
    for mask in masks:
        left, top, width, height = cv2.boundingRect(mask.view(np.uint8))
        strip = np.s_[top + height + near : top + height + far, left : left + width]
        strips.append(rgb[strip][~taken[strip]])
    pixels = np.concatenate(strips)
    if len(pixels) < _SOME:
        return None
    return np.array([quantile_of_codes(pixels[:, channel], 0.5) for channel in range(3)]) / 255.0


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
