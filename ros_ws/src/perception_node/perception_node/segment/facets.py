# SPDX-License-Identifier: Apache-2.0
"""Facets: connected pixels of one colour on one surface, pieces that blocks are put together of."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any, Final

import cv2
import numpy as np
from numpy.typing import NDArray

Array = NDArray[np.float32]
Mask = NDArray[np.bool_]
Ids = NDArray[np.int32]

#: Neighbours whose hue and saturation differ by more than this are of two facets: the distance of
#: their shares of red, green and blue in the sum of the three.
CHROMA_STEP: Final = 0.03
#: Neighbours of which one is brighter by more than this are of two facets (natural logarithm).
LIGHT_STEP: Final = 0.16
#: Neighbours further apart than this along the optical axis are of two facets [m].
DEPTH_STEP: Final = 0.02
#: Brightness below which a colour has no hue that can be told: as part of that of the picture's
#: brightest parts, and in standard deviations of the picture's noise.
DARK: Final = 0.05
DARK_NOISE: Final = 2.0


@dataclass(frozen=True)
class Look:
    """The colour of every pixel of a picture, apart from how it is lit.

    Attributes:
        chroma: shares of red and green and blue in their sum, shape (h, w, 3).
        light: natural logarithm of the brightness, shape (h, w).
    """

    chroma: Array
    light: Array

    @classmethod
    def of(cls, rgb: NDArray[np.uint8], noise: float) -> Look:
        """The look of a picture, whatever its exposure.

        Args:
            rgb: shape (h, w, 3).
            noise: that its channels had, before it was smoothed [0..255].
        """
        values: NDArray[Any] = rgb.astype(np.float32)
        brightest = float(np.percentile(values.max(axis=-1), 95))
        values += np.float32(max(DARK * brightest, DARK_NOISE * noise, 1.0))
        total = values.sum(axis=-1)
        return cls(values / total[..., None], np.log(total))


@dataclass(frozen=True)
class Facets:
    """The facets of a picture, and which of them are neighbours.

    Attributes:
        ids: number of each pixel's facet, from 1; 0 where there is none, shape (h, w).
        count: of facets; their numbers are 1..count.
        borders: pairs of numbers of facets, and how many pairs of neighbouring pixels they have in
            common: shape (n, 3).
    """

    ids: Ids
    count: int
    borders: NDArray[np.int64]


def find_facets(candidates: Mask, look: Look, depth: Array) -> Facets:
    """Splits the candidates where colour, brightness or depth jump.

    Args:
        candidates: the pixels that may be of blocks, shape (h, w).
        look: the picture.
        depth: NaN where it is unknown, which is no jump, shape (h, w) [m].
    """
    height, width = candidates.shape
    # Pixels on even rows and columns, the links between neighbours on odd ones.
    lattice = np.zeros((2 * height - 1, 2 * width - 1), np.uint8)
    lattice[::2, ::2] = candidates
    links = []
    for axis in (0, 1):
        low, high = _sides(axis)
        both = candidates[low] & candidates[high]
        linked = both & _linked(look, depth, low, high)
        lattice[_between(axis)] = linked
        links.append(both & ~linked)
    count, numbers = cv2.connectedComponents(lattice, connectivity=4)
    ids = numbers[::2, ::2].astype(np.int32)
    pairs = []
    for axis, cut in enumerate(links):
        low, high = _sides(axis)
        first, second = ids[low][cut].astype(np.int64), ids[high][cut].astype(np.int64)
        pairs.append(np.stack([np.minimum(first, second), np.maximum(first, second)]))
    first, second = np.concatenate(pairs, axis=1)
    apart = first != second
    keys, lengths = np.unique(first[apart] * count + second[apart], return_counts=True)
    return Facets(ids, count - 1, np.column_stack([keys // count, keys % count, lengths]))


def _sides(axis: int) -> tuple[tuple[slice, ...], tuple[slice, ...]]:
    """The two pixels of each pair of neighbours along an axis."""
    before = (slice(None),) * axis
    return (*before, slice(None, -1)), (*before, slice(1, None))


def _between(axis: int) -> tuple[slice, slice]:
    """Where the lattice holds the links along an axis."""
    odd, even = slice(1, None, 2), slice(None, None, 2)
    return (odd, even) if axis == 0 else (even, odd)


def _linked(look: Look, depth: Array, low: tuple[slice, ...], high: tuple[slice, ...]) -> Mask:
    """Whether neighbours are of one facet."""
    with np.errstate(invalid="ignore"):
        jumps = np.abs(depth[low] - depth[high]) > DEPTH_STEP
    return _same(look, low, high) & ~jumps


def alike(look: Look, pixels: tuple[NDArray[np.intp], ...], step: tuple[int, int]) -> Mask:
    """Whether n pixels (rows, columns) look like those a step further, shape (n,)."""
    return _same(look, pixels, tuple(at + by for at, by in zip(pixels, step)))


def _same(look: Look, first: Any, second: Any) -> Mask:
    difference = look.chroma[first] - look.chroma[second]
    same_hue = np.einsum("...i,...i", difference, difference) < CHROMA_STEP**2
    return same_hue & (np.abs(look.light[first] - look.light[second]) < LIGHT_STEP)
