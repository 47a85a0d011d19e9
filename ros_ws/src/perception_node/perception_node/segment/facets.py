# SPDX-License-Identifier: Apache-2.0
"""Facets: connected pixels of one colour on one surface, pieces that blocks are put together of."""

from __future__ import annotations

from collections.abc import Callable, Sequence
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
#: of a lid, which is level to this [m], further than this.
LID_STEP: Final = 0.005
LID_DEPTH: Final = 0.1
#: A facet leaks of which so many pixels are higher or lower than the face by more than this [m].
LEAK: Final = 0.01
LEAK_PIXELS: Final = 10
#: Ends of a group of pixels, so that a few stray ones count for nothing [%].
STRAY: Final = (1.0, 99.0)
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
        # numpy is slow along an axis of three.
        brightness = np.maximum.reduce(cv2.split(rgb[::2, ::2]))
        brightest = float(np.percentile(brightness, 95))
        dark = np.float32(max(DARK * brightest, DARK_NOISE * noise, 1.0))
        channels = [channel + dark for channel in cv2.split(rgb)]
        total: Array = np.add(channels[0], channels[1]) + channels[2]
        chroma = np.asarray(cv2.merge([channel / total for channel in channels]), np.float32)
        return cls(chroma, np.log(total))


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

    def links(self) -> list[Mask]:
        """Which neighbours are of one facet, by axis: (h - 1, w), (h, w - 1)."""
        pairs = [(self.ids[low], self.ids[high]) for low, high in map(_sides, (0, 1))]
        return [(first == second) & (first > 0) for first, second in pairs]


def find_facets(candidates: Mask, look: Look, depth: Array) -> Facets:
    """Splits the candidates where colour, brightness or depth jump.

    Args:
        candidates: the pixels that may be of blocks, shape (h, w).
        look: the picture.
        depth: NaN where it is unknown, which is no jump, shape (h, w) [m].
    """
    linked = [_linked(look, depth, low, high) for low, high in map(_sides, (0, 1))]
    count, ids = _connected(candidates, linked)
    return Facets(ids, count - 1, _borders(count, ids))


def without_leaks(facets: Facets, height: Array, reach: int) -> Facets:
    """Facets without the narrow parts of those that leak, each piece that is left one of its own.

    The rim of a face, where it mirrors the room or mixes with what is behind it, looks like the
    rims of others, and so links faces that have nothing to do with one another. The strips of a
    face that are of the same block are as high as it is; of one that leaks they are not. Pieces
    border on each other across the strips between them.

    Args:
        height: over the table, NaN where it is not known, shape (h, w) [m].
        reach: strips are no wider than ``2 reach`` [px].
    """
    around = np.ones((2 * reach + 1,) * 2, np.uint8)
    ids = facets.ids.astype(np.float32)
    inner = (cv2.erode(ids, around) == ids) & (cv2.dilate(ids, around) == ids) & (ids > 0.0)
    grown = cv2.dilate(np.where(inner, ids, 0.0).astype(np.float32), around)
    none = np.float32(facets.count + 1)
    least = cv2.erode(np.where(inner, ids, none).astype(np.float32), around)
    wide = (facets.ids > 0) & ((grown == ids) | (least == ids))
    same = facets.links()
    count, pieces = _connected(wide, same)
    # The largest piece of each facet, and how many pixels are higher or lower than it.
    pixels = np.bincount(pieces.ravel(), minlength=count)
    largest = np.zeros(facets.count + 1, np.intp)
    order = np.argsort(pixels[1:], kind="stable") + 1
    owner = np.zeros(count, np.intp)
    owner[pieces[wide]] = facets.ids[wide]
    largest[owner[order]] = order
    low, high = np.full(facets.count + 1, -np.inf), np.full(facets.count + 1, np.inf)
    of_largest = wide & (largest[facets.ids] == pieces)
    for facet in np.flatnonzero(largest):
        known = height[of_largest & (facets.ids == facet)]
        known = known[np.isfinite(known)]
        if len(known):
            low[facet], high[facet] = np.percentile(known, STRAY)
    with np.errstate(invalid="ignore"):
        beyond = (height < low[facets.ids] - LEAK) | (height > high[facets.ids] + LEAK)
    beyond &= facets.ids > 0
    leaks = np.bincount(facets.ids[beyond], minlength=facets.count + 1) >= LEAK_PIXELS
    kept = (facets.ids > 0) & (wide | ~leaks[facets.ids])
    count, pieces = _connected(kept, same)
    shared = np.where(wide, pieces, 0)
    for _ in range(2 * reach):
        if not spread(shared, facets.ids > 0):
            break
    return Facets(pieces, count - 1, _borders(count, pieces, shared))


def _connected(pixels: Mask, links: Sequence[Mask]) -> tuple[int, Ids]:
    """How many pieces linked pixels make, with that of no pixel, and the piece of each, from 1."""
    height, width = pixels.shape
    # Pixels on even rows and columns, the links between neighbours on odd ones.
    lattice = np.zeros((2 * height - 1, 2 * width - 1), np.uint8)
    lattice[::2, ::2] = pixels
    for axis, linked in enumerate(links):
        low, high = _sides(axis)
        lattice[_between(axis)] = linked & pixels[low] & pixels[high]
    count, numbers = cv2.connectedComponents(lattice, connectivity=4)
    return count, numbers[::2, ::2].astype(np.int32)


def spread(
    labels: NDArray[Any],
    free: Mask,
    links: Sequence[Mask] | None = None,
    may: Callable[[NDArray[Any], tuple[slice, ...]], Mask] | None = None,
) -> bool:
    """Gives free pixels without a label that of a neighbour: the one below, else beside, or above.

    What is seen above a face is its lid or the ledge on which the next one stands.

    Args:
        labels: shape (h, w), changed.
        free: which may be given one.
        links: by axis, which neighbours labels pass between, (h - 1, w), (h, w - 1); None: all.
        may: whether pixels, given as slices, may have such labels; None: they may.

    Returns:
        Whether any was given one.
    """
    found, given = labels.copy(), False
    for axis in (0, 1):
        low, high = _sides(axis)
        for to, source in ((low, high), (high, low)):
            takes = free[to] & (found[to] == 0) & (labels[source] > 0)
            if links is not None:
                takes &= links[axis]
            if not takes.any():
                continue
            if may is not None:
                takes &= may(labels[source], to)
            found[to][takes] = labels[source][takes]
            given = given or bool(takes.any())
    labels[...] = found
    return given


def on_one_body(points: Array, depth: Array) -> list[Mask]:
    """Which neighbours can be of one block, for each axis: no jump is between them.

    Of a lid that is seen at a flat angle one row is far behind the other, but as high.

    Args:
        points: in world, shape (h, w, 3) [m].
        depth: NaN where it is unknown, which is no jump, shape (h, w) [m].
    """
    links = []
    with np.errstate(invalid="ignore"):
        for axis in (0, 1):
            low, high = _sides(axis)
            jump = np.abs(depth[low] - depth[high])
            climb = np.abs(points[low][..., 2] - points[high][..., 2])
            links.append(~(jump > DEPTH_STEP) | ((climb < LID_STEP) & (jump < LID_DEPTH)))
    return links


def _borders(count: int, *numbered: Ids) -> NDArray[np.int64]:
    """Which facets meet by any of some numberings of pixels, and where: see :class:`Facets`."""
    pairs = []
    for ids in numbered:
        for low, high in map(_sides, (0, 1)):
            meet = (ids[low] > 0) & (ids[high] > 0) & (ids[low] != ids[high])
            first, second = ids[low][meet].astype(np.int64), ids[high][meet].astype(np.int64)
            pairs.append(np.stack([np.minimum(first, second), np.maximum(first, second)]))
    first, second = np.concatenate(pairs, axis=1)
    keys, lengths = np.unique(first * count + second, return_counts=True)
    return np.column_stack([keys // count, keys % count, lengths])


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
