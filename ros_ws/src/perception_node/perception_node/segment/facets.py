# SPDX-License-Identifier: Apache-2.0
"""Facets: connected pixels of one colour on one surface, pieces that blocks are put together of.

What is done pixel by pixel is in C (``facets.c``) where that can be compiled, and else in numpy.
"""

from __future__ import annotations

import ctypes
from collections.abc import Callable, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any, Final, NamedTuple

import cv2
import numpy as np
from numpy.typing import NDArray
from tamp_runtime.machine_code import address, written

from perception_node.quantiles import quantile_of_codes

from .pieces import (
    Array,
    Ids,
    Mask,
    borders,
    connected,
    links_of,
    no_links,
    planes,
    sides,
)

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
#: Brightness below which a colour has no hue that can be told: as part of that of the picture's
#: brightest parts, and in standard deviations of the picture's noise.
DARK: Final = 0.05
DARK_NOISE: Final = 2.0

_FILE: Final = Path(__file__).with_suffix(".c")


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
        library, channels = written(_FILE), cv2.split(rgb)
        brightest = quantile_of_codes(
            np.maximum.reduce([channel[::2, ::2] for channel in channels]), 0.95
        )
        dark = np.float32(max(DARK * brightest, DARK_NOISE * noise, 1.0))
        if library is None:
            return cls(*look_by_numpy(rgb, dark))
        light = np.empty(rgb.shape[:2], np.float32)
        shares = np.empty((3, *light.shape), np.float32)
        library.look(
            light.size, *map(address, channels), ctypes.c_float(float(dark)), address(shares),
            address(light),
        )  # fmt: skip
        return cls(shares.transpose(1, 2, 0), light)

    def part(self, box: tuple[slice, slice]) -> Look:
        """That of some rows and columns."""
        return Look(self.chroma[box], self.light[box])


def look_by_numpy(rgb: NDArray[np.uint8], dark: np.float32) -> tuple[Array, Array]:
    """Chroma and light, see :class:`Look`, of which each channel is brighter by ``dark``."""
    # numpy is slow along an axis of three.
    channels = [channel + dark for channel in cv2.split(rgb)]
    total: Array = np.add(channels[0], channels[1]) + channels[2]
    chroma = np.asarray(cv2.merge([channel / total for channel in channels]), np.float32)
    return chroma, np.log(total)


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
        return links_of(self.ids)

    def thick(self, width: int) -> Mask:
        """Whether facets are anywhere wider and higher than so many pixels, shape (count + 1,)."""
        thick = np.zeros(self.count + 1, bool)
        thick[self.ids[uniform(self.ids, width + 1)]] = True
        return thick


def find_facets(candidates: Mask, links: Sequence[Mask]) -> Facets:
    """Splits the candidates where colour, brightness or depth jump.

    Args:
        candidates: the pixels that may be of blocks, shape (h, w).
        links: see :func:`on_one_facet`.
    """
    count, ids = connected(candidates, links)
    return Facets(ids, count - 1, borders(count, ids))


def uniform(ids: Ids, side: int) -> Mask:
    """Which pixels are in the middle of a square of one facet, or of what is of it in the picture.

    Args:
        side: of the square [px].
    """
    library = written(_FILE)
    if library is None:
        around, values = np.ones((side, side), np.uint8), ids.astype(np.float32)
        return np.asarray(
            (cv2.erode(values, around) == values) & (cv2.dilate(values, around) == values)
        )
    ids, inner = np.ascontiguousarray(ids, np.int32), np.empty(ids.shape, bool)
    if library.uniform(*ids.shape, address(ids), side // 2, side - 1 - side // 2, address(inner)):
        raise MemoryError("no memory to find what is amid facets")
    return inner


def on_one_body(points: Array, depth: Array) -> list[Mask]:
    """Which neighbours can be of one block, for each axis: no jump is between them.

    Of a lid that is seen at a flat angle one row is far behind the other, but as high.

    Args:
        points: in world, shape (h, w, 3) [m].
        depth: NaN where it is unknown, which is no jump, shape (h, w) [m].
    """
    library = written(_FILE)
    if library is None:
        return bodies_by_numpy(points, depth)
    return _linked(library.bodies, [points[..., 2], depth], [DEPTH_STEP, LID_STEP, LID_DEPTH])


def bodies_by_numpy(points: Array, depth: Array) -> list[Mask]:
    """As :func:`on_one_body`."""
    links = []
    with np.errstate(invalid="ignore"):
        for axis in (0, 1):
            low, high = sides(axis)
            jump = np.abs(depth[low] - depth[high])
            climb = np.abs(points[low][..., 2] - points[high][..., 2])
            links.append(~(jump > DEPTH_STEP) | ((climb < LID_STEP) & (jump < LID_DEPTH)))
    return links


def on_one_facet(look: Look, depth: Array) -> list[Mask]:
    """Which neighbours are of one facet, by axis: (h - 1, w), (h, w - 1).

    Args:
        depth: NaN where it is unknown, which is no jump, shape (h, w) [m].
    """
    library = written(_FILE)
    if library is None:
        return links_by_numpy(look, depth)
    images = [planes(look.chroma), look.light, depth]
    return _linked(library.links, images, [CHROMA_STEP**2, LIGHT_STEP, DEPTH_STEP])


def links_in(links: Sequence[Mask], box: tuple[slice, slice]) -> list[Mask]:
    """Those between pixels of some rows and columns."""
    rows, columns = box
    return [
        links[0][rows.start : rows.stop - 1, columns],
        links[1][rows, columns.start : columns.stop - 1],
    ]


def links_by_numpy(look: Look, depth: Array) -> list[Mask]:
    """As :func:`on_one_facet`."""
    links = []
    with np.errstate(invalid="ignore"):
        for low, high in map(sides, (0, 1)):
            jumps = np.abs(depth[low] - depth[high]) > DEPTH_STEP
            links.append(_same(look, low, high) & ~jumps)
    return links


def _linked(
    neighbours: Callable[..., Any], images: Sequence[Array], steps: Sequence[float]
) -> list[Mask]:
    """Which neighbours C finds linked in images, the last of which is (h, w), by axis."""
    height, width = images[-1].shape
    links = no_links(height, width)
    own = [np.ascontiguousarray(array, np.float32) for array in (*images, steps)]
    neighbours(height, width, *map(address, (*own, *links)))
    return links


class Sums(NamedTuple):
    """What is known of F facets, in the order of their numbers, from 1; row 0 is of no facet.

    Attributes:
        pixels: how many.
        sure: of how many the depth is sure.
        colors: means of chroma and of light, shape (F, 4).
        centres: means of the points, those whose depth is sure, unless it has fewer, (F, 3) [m].
        spreads: of the points about them: xx, xy, xz, yy, yz, zz, shape (F, 6) [m²].
    """

    pixels: NDArray[np.int64]
    sure: NDArray[np.int64]
    colors: NDArray[np.float64]
    centres: NDArray[np.float64]
    spreads: NDArray[np.float64]


def sums(facets: Facets, look: Look, points: Array, sure: Mask, few: int) -> Sums:
    """Sums over the pixels of each facet.

    Args:
        points: in world, shape (h, w, 3) [m].
        sure: where their depth is, shape (h, w).
        few: facets with fewer sure points have all of them counted.
    """
    library, count = written(_FILE), facets.count + 1
    if library is None:
        return sums_by_numpy(facets, look, points, sure, few)
    images = [points.transpose(2, 0, 1), look.chroma.transpose(2, 0, 1), look.light, sure]
    if any(image.strides[-1] != image.itemsize for image in images):
        images = [np.ascontiguousarray(image) for image in images]
    # How far rows and channels are from one another.
    apart = [np.array(image.strides) // image.itemsize for image in images]
    strides = np.concatenate([steps[:-1] for steps in apart]).astype(np.int64)
    found = Sums(
        np.zeros(count, np.int64),
        np.zeros(count, np.int64),
        np.zeros((count, 4)),
        np.zeros((count, 3)),
        np.zeros((count, 6)),
    )
    library.sums(
        *facets.ids.shape, count, *map(address, (facets.ids, *images, strides)), few,
        *map(address, found),
    )  # fmt: skip
    return found


def sums_by_numpy(facets: Facets, look: Look, points: Array, sure: Mask, few: int) -> Sums:
    """As :func:`sums`."""
    used = facets.ids > 0
    ids, count = facets.ids[used], facets.count + 1
    pixels = np.bincount(ids, minlength=count)
    many_sure = np.bincount(ids[sure[used]], minlength=count)
    counts = sure[used] | (many_sure < few)[ids]
    relied = np.where(many_sure < few, pixels, many_sure)

    def mean(values: NDArray[np.floating], of: Ids, total: NDArray[np.intp]) -> NDArray[np.float64]:
        columns = [np.bincount(of, column, minlength=count) for column in values.T]
        return np.stack(columns, axis=-1) / np.maximum(total, 1)[:, None]

    colors = np.concatenate([look.chroma[used], look.light[used][:, None]], axis=1)
    own, of = points[used][counts].astype(np.float64), ids[counts]
    centres = mean(own, of, relied)
    away = own - centres[of]
    products = away[:, [0, 0, 0, 1, 1, 2]] * away[:, [0, 1, 2, 1, 2, 2]]
    spreads = mean(products, of, relied)
    return Sums(pixels, many_sure, mean(colors, ids, pixels), centres, spreads)


def counts(ids: Ids, some: Mask, count: int) -> tuple[NDArray[np.int64], NDArray[np.int64]]:
    """How many pixels each facet has, and how many of some of them, shape (count,) each."""
    library = written(_FILE)
    if library is None:
        return np.bincount(ids.ravel(), minlength=count), np.bincount(ids[some], minlength=count)
    found = np.zeros((2, count), np.int64)
    own = map(address, map(np.ascontiguousarray, (ids, some)))
    library.counts(ids.size, *own, count, address(found))
    return found[0], found[1]


def mean_look(look: Look, ids: Ids, facet: int) -> tuple[NDArray[np.float32], np.float32]:
    """Chroma, shape (3,), and light of a facet."""
    mask = ids == facet
    light = look.light[mask]
    library = written(_FILE)
    if library is None:
        return np.ascontiguousarray(look.chroma[mask]).mean(axis=0), light.mean()
    total = np.zeros(3, np.float32)
    library.chromas(ids.size, address(mask), address(planes(look.chroma)), address(total))
    return np.asarray(total / np.float32(len(light))), light.mean()


def alike(look: Look, pixels: tuple[NDArray[np.intp], ...], step: tuple[int, int]) -> Mask:
    """Whether n pixels (rows, columns) look like those a step further, shape (n,)."""
    return _same(look, pixels, tuple(each + by for each, by in zip(pixels, step)))


def _same(look: Look, first: Any, second: Any) -> Mask:
    difference = look.chroma[first] - look.chroma[second]
    same_hue = np.einsum("...i,...i", difference, difference) < CHROMA_STEP**2
    return same_hue & (np.abs(look.light[first] - look.light[second]) < LIGHT_STEP)
