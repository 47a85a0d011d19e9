# SPDX-License-Identifier: Apache-2.0
"""Names blocks by what can be seen: ``red_box``, and ``red_box_2`` where there are two."""

from __future__ import annotations

import functools
from collections.abc import Sequence
from dataclasses import dataclass, replace
from typing import Final

import cv2
import numpy as np
from numpy.typing import NDArray

from scene_graph import COLORS, UNKNOWN, object_name

from .segment import Segments

Array = NDArray[np.float64]

_NAMES: Final = tuple(COLORS)
#: Brightness that a surface may have, relative to the colour's own, in equal ratios.
_SHADES: Final = np.geomspace(0.3, 1.2, 18)
#: What a surface mirrors of the room, which is of no colour: of white light it is this part, and
#: the cost of it [ΔE²]. A few hundredths of what falls on it, whatever it is made of.
_MIRRORED: Final = np.array([0.0, 0.006, 0.014])
_MIRROR_COST: Final = np.array([0.0, 6.0, 12.0])
#: Cost of a block's shade that differs from the scene's, per squared logarithm [ΔE²].
_OWN_SHADE_COST: Final = 1600.0
#: Cost of a scene's shade that differs from the usual one, per squared logarithm [ΔE²].
_SCENE_SHADE_COST: Final = 100.0
_USUAL_SHADE: Final = 0.8
#: Colour of the light: gains of red and of blue over green, in equal ratios, and the cost of
#: one that is not 1, per squared logarithm [ΔE²].
_GAINS: Final = np.exp(np.linspace(-0.42, 0.42, 7))
#: And finer, about the best of those.
_FINER_GAINS: Final = np.exp(np.linspace(-0.14, 0.14, 7))
_GAIN_COST: Final = 600.0
#: White light that explains all colours to this [ΔE] is not asked further.
_WHITE_ENOUGH: Final = 5.0
#: if they are so many: of fewer, the light and the names can be mistaken for one another.
_ENOUGH: Final = 3
#: A block of no known colour says nothing of the light beyond this cost [ΔE²].
_MOST_COST: Final = 400.0
#: Light is about this power of its code in a picture.
_GAMMA: Final = 2.2
#: A colour is not named that is further than this from all names, or not nearer by this to its own
#: than to the next one [ΔE].
MAX_DISTANCE: Final = 6.0
#: but so many times as far as half of a scene's blocks are, of which the light may be uneven, up to
_UNEVEN: Final = 1.6
_MOST_DISTANCE: Final = 9.0
#: where the gains of the light's colours are within this of each other's (natural logarithm).
_PLAIN_LIGHT: Final = 0.25
MIN_MARGIN: Final = 5.0


@dataclass(frozen=True)
class ColorFit:
    """How the colours of N blocks are explained, all lit by one light.

    Attributes:
        names: the nearest of ``scene_graph.COLORS`` for each.
        others: the next nearest.
        distances: from the nearest, an own shade counting half, shape (N,) [ΔE].
        margins: by how much the next one is further away, in this light and in those by which all
            blocks together are explained about as well, shape (N,) [ΔE].
        light: its colour, gains of red, green and blue.
    """

    names: tuple[str, ...]
    others: tuple[str, ...]
    distances: Array
    margins: Array
    light: Array

    @property
    def known(self) -> NDArray[np.bool_]:
        """Which colours have a name, shape (N,)."""
        # In very coloured light all may be as far from the wrong names.
        plain = bool(np.abs(np.log(self.light)).max() < _PLAIN_LIGHT)
        usual = _UNEVEN * float(np.median(self.distances)) if plain and len(self.names) else 0.0
        return np.asarray(self.distances <= min(max(MAX_DISTANCE, usual), _MOST_DISTANCE))


@dataclass(frozen=True)
class Names:
    """What the N blocks of a scene are called, in the order of their segments.

    Attributes:
        colors: names of ``scene_graph.COLORS``, ``UNKNOWN`` where none fits.
        names: unique.
        doubt: a sentence about the first block whose colour has no certain name; empty if all have.
        distance, margin: the worst of all blocks, see :class:`ColorFit` [ΔE].
    """

    colors: tuple[str, ...]
    names: tuple[str, ...]
    doubt: str = ""
    distance: float = 0.0
    margin: float = np.inf


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
    colors = mean_colors(rgb, [segment.part for segment in segments])
    fit = explain_colors(colors)
    known = tuple(name if sure else UNKNOWN for name, sure in zip(fit.names, fit.known))
    names = unique_names(known, shapes, stacks)
    return Names(
        known,
        names,
        _doubt(fit, colors, names),
        float(fit.distances.max(initial=0.0)),
        float(fit.margins.min(initial=np.inf)),
    )


def _doubt(fit: ColorFit, colors: Array, names: Sequence[str]) -> str:
    """A sentence about the first colour without a certain name, or an empty string."""
    if not fit.known.all():
        exchanged = explain_colors(colors[:, ::-1])
        if exchanged.known.all() and (exchanged.margins >= MIN_MARGIN).all():
            return (
                "some colours have no name, but all have one with red and blue exchanged; "
                "is the picture's encoding (rgb8, bgr8) the one it is sent with?"
            )
    for index, name in enumerate(names):
        red, green, blue = (round(255.0 * float(value)) for value in colors[index])
        seen = f"the colour of {name}, ({red}, {green}, {blue}) of 255,"
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
        left, top, width, height = cv2.boundingRect(mask.astype(np.uint8))
        box = np.s_[top : top + height, left : left + width]
        pixels = rgb[box][mask[box]]
        medians.append(np.partition(pixels, len(pixels) // 2, axis=0)[len(pixels) // 2])
    return np.array(medians).reshape(-1, 3) / 255.0


def color_names(colors: Array) -> tuple[str, ...]:
    """The names of :func:`explain_colors`."""
    return explain_colors(colors).names


def explain_colors(colors: Array) -> ColorFit:
    """The nearest of ``scene_graph.COLORS`` for each colour, in CIE Lab, whatever the light.

    Light and shade scale a colour, which alone would turn orange into brown, and a coloured light
    scales its channels. The blocks of a scene are lit alike, so one shade and one light are sought
    that explain all of them best; each may differ from the shade a little, at a cost.

    Args:
        colors: sRGB in 0..1, shape (N, 3).
    """
    if len(colors) == 0:
        return ColorFit((), (), np.zeros(0), np.zeros(0), np.ones(3))
    white = _explain(colors, np.ones((1, 3)))
    enough = len(colors) >= _ENOUGH and white.distances.max() < _WHITE_ENOUGH
    if enough and white.margins.min() >= MIN_MARGIN:
        return white
    coarse = _explain(colors, _lights(_GAINS))
    fine = _explain(colors, coarse.light * _lights(_FINER_GAINS))
    # A light far from the best one may explain the blocks by other names.
    return replace(fine, margins=np.minimum(fine.margins, coarse.margins))


def _lights(gains: Array) -> Array:
    """Lights of all pairs of gains of red and of blue, shape (lights, 3)."""
    red, blue = (gain.ravel() for gain in np.meshgrid(gains, gains, indexing="ij"))
    return np.stack([red, np.ones_like(red), blue], axis=-1)


def _explain(colors: Array, gains: Array) -> ColorFit:
    """The same for lights of certain colours only, shape (lights, 3)."""
    shaded = _shaded_names(gains.tobytes())
    seen = _lab(np.clip(colors[None] / gains[:, None], 0.0, 1.0))  # (lights, N, 3)
    # |a - b|² by a product: (lights, N, shades of the block, names)
    distance = (seen**2).sum(-1)[..., None] + (shaded**2).sum(-1)[:, None]
    distance -= 2.0 * seen @ shaded.transpose(0, 2, 1)
    distance = distance.reshape(*seen.shape[:2], len(_MIRRORED), len(_SHADES), len(_NAMES))
    sheen = (distance + 0.25 * _MIRROR_COST[:, None, None]).min(axis=2)
    distance = (distance + _MIRROR_COST[:, None, None]).min(axis=2)
    ratio = np.log(_SHADES[:, None] / _SHADES[None]) ** 2  # (shades of the block, of the scene)
    unusual = _SCENE_SHADE_COST * np.log(_SHADES / _USUAL_SHADE) ** 2
    tint = _GAIN_COST * (np.log(gains) ** 2).sum(axis=1)
    best = half = np.zeros((len(colors), len(_NAMES)))
    by_name = np.full(best.shape, np.inf)
    least, found = np.inf, 0
    for scene in range(len(_SHADES)):
        # The block's own shade chosen freely: (lights, N, names)
        cost = (distance + _OWN_SHADE_COST * ratio[:, scene, None]).min(axis=2)
        bounded = np.minimum(cost, _MOST_COST)
        own_least = bounded.min(axis=2)
        total = own_least.sum(axis=1) + tint + unusual[scene]
        others = (total[:, None] - own_least)[..., None] + bounded
        by_name = np.minimum(by_name, others.min(axis=0))
        light = int(total.argmin())
        if total[light] < least:
            best, least, found = cost[light], float(total[light]), light
            own = 0.25 * _OWN_SHADE_COST * ratio[:, scene, None]
            half = (sheen[light] + own).min(axis=1)
    order = np.argsort(best, axis=1)[:, :2]
    near, next_one = np.sqrt(np.maximum(np.take_along_axis(best, order, axis=1), 0.0)).T
    of = np.arange(len(colors))
    apart = half[of, order[:, 0]]
    by_name[of, order[:, 0]] = np.inf
    risen = np.sqrt(np.maximum(by_name.min(axis=1) - least, 0.0))
    fit = ColorFit(
        tuple(_NAMES[index] for index in order[:, 0]),
        tuple(_NAMES[index] for index in order[:, 1]),
        np.sqrt(np.maximum(apart, 0.0)),
        np.minimum(next_one - near, risen),
        gains[found],
    )
    return fit


@functools.cache
def _shaded_names(gains: bytes) -> Array:
    """CIE Lab of every colour in every shade, and with what it mirrors of the room.

    As it is once the light is taken out of what a sensor that saturates saw.

    Args:
        gains: of the lights, the bytes of doubles of shape (lights, 3).

    Returns:
        Names fastest, then shades, shape (lights, mirrored · shades · names, 3).
    """
    light = np.frombuffer(gains).reshape(-1, 1, 1, 1, 3)
    palette = np.array([COLORS[name] for name in _NAMES])
    lit = palette * _SHADES[:, None, None]
    # Light adds up, codes of it in a picture do not.
    lit = (lit**_GAMMA + _MIRRORED[:, None, None, None]) ** (1.0 / _GAMMA)
    seen = np.minimum(lit * light, 1.0) / light
    return _lab(np.minimum(seen, 1.0)).reshape(len(light), -1, 3)


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
