# SPDX-License-Identifier: Apache-2.0
"""Pieces of a picture: pixels that are linked with their neighbours, and what is said of each.

In C (``pieces.c``) where that can be compiled, and else in numpy and OpenCV.
"""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path
from typing import Any, Final, NamedTuple

import cv2
import numpy as np
from numpy.typing import NDArray
from tamp_runtime.machine_code import address, written

Array = NDArray[np.float32]
Mask = NDArray[np.bool_]
Ids = NDArray[np.int32]

#: Ends of a group of pixels, so that a few stray ones count for nothing [%].
STRAY: Final = (1.0, 99.0)

_FILE: Final = Path(__file__).with_suffix(".c")
_NO_MEMORY: Final = "no memory to find pieces of a picture"


class Heights(NamedTuple):
    """Which labels pixels may have, by their heights.

    Attributes:
        of_pixels: NaN where it is not known: those have none, shape (h, w) [m].
        low, high: between which those of a label are, by label [m].
    """

    of_pixels: Array
    low: NDArray[np.float64]
    high: NDArray[np.float64]


def connected(pixels: Mask, links: Sequence[Mask]) -> tuple[int, Ids]:
    """How many pieces linked pixels make, with that of no pixel, and the piece of each, from 1.

    Args:
        pixels: shape (h, w).
        links: by axis, which neighbours are linked, (h - 1, w), (h, w - 1).
    """
    library = written(_FILE)
    if library is None:
        return connected_by_opencv(pixels, links)
    own = [np.ascontiguousarray(array) for array in (pixels, *links)]
    ids = np.empty(pixels.shape, np.int32)
    count = library.connected(*pixels.shape, *map(address, own), address(ids))
    if count < 0:
        raise MemoryError(_NO_MEMORY)
    return count, ids


def connected_by_opencv(pixels: Mask, links: Sequence[Mask]) -> tuple[int, Ids]:
    """As :func:`connected`."""
    ids = np.zeros(pixels.shape, np.int32)
    left, top, width, height = cv2.boundingRect(pixels.view(np.uint8))
    if width == 0:
        return 1, ids
    box = np.s_[top : top + height, left : left + width]
    inner = pixels[box]
    # Pixels on even rows and columns, the links between neighbours on odd ones.
    lattice = np.zeros((2 * height - 1, 2 * width - 1), np.uint8)
    lattice[::2, ::2] = inner
    for axis, linked in enumerate(links):
        low, high = sides(axis)
        between = linked[top : top + height - (axis == 0), left : left + width - (axis == 1)]
        lattice[_between(axis)] = between & inner[low] & inner[high]
    count, numbers = cv2.connectedComponents(lattice, connectivity=4)
    ids[box] = numbers[::2, ::2]
    return count, ids


def borders(count: int, *numbered: Ids) -> NDArray[np.int64]:
    """Which pieces meet by any of some numberings of pixels, and where.

    Returns:
        Pairs of numbers, the less one first, and how many pairs of neighbouring pixels they have in
        common: shape (n, 3), in order.
    """
    library = written(_FILE)
    if library is None:
        return borders_by_numpy(count, *numbered)
    ids, most = np.ascontiguousarray(np.stack(numbered), np.int32), 4096
    while True:
        found = np.empty((most, 3), np.int64)
        pairs = library.borders(*ids.shape[1:], len(ids), address(ids), most, address(found))
        if pairs < 0:
            raise MemoryError(_NO_MEMORY)
        if pairs <= most:
            found = found[:pairs]
            return found[np.lexsort((found[:, 1], found[:, 0]))]
        most = pairs


def borders_by_numpy(count: int, *numbered: Ids) -> NDArray[np.int64]:
    """As :func:`borders`."""
    pairs = []
    for ids in numbered:
        for low, high in map(sides, (0, 1)):
            meet = (ids[low] > 0) & (ids[high] > 0) & (ids[low] != ids[high])
            first, second = ids[low][meet].astype(np.int64), ids[high][meet].astype(np.int64)
            pairs.append(np.stack([np.minimum(first, second), np.maximum(first, second)]))
    first, second = np.concatenate(pairs, axis=1)
    keys, lengths = np.unique(first * count + second, return_counts=True)
    return np.column_stack([keys // count, keys % count, lengths])


def spread(
    labels: NDArray[Any],
    free: Mask,
    times: int,
    links: Sequence[Mask] | None = None,
    heights: Heights | None = None,
) -> None:
    """Gives free pixels without a label that of a neighbour: the one below, else above, or beside.

    What is seen above a face is its lid or the ledge on which the next one stands.

    Args:
        labels: shape (h, w), changed.
        free: which may be given one.
        times: how many pixels far at most.
        links: by axis, which neighbours labels pass between, (h - 1, w), (h, w - 1); None: all.
        heights: which labels pixels may have; None: any.
    """
    library = written(_FILE)
    if library is None:
        spread_by_numpy(labels, free, times, links, heights)
        return
    own = np.ascontiguousarray(labels, np.int32)
    own = own.copy() if own is labels else own
    images = [np.ascontiguousarray(free), *(np.ascontiguousarray(link) for link in links or ())]
    bounds: list[NDArray[Any]] = []
    if heights is not None:
        bounds = [np.ascontiguousarray(heights.of_pixels, np.float32), heights.low, heights.high]
    first, *among = map(address, images)
    failed = library.spread(
        *labels.shape, address(own), first, times, *(among or (None, None)),
        *(map(address, bounds) if bounds else (None,) * 3),
    )  # fmt: skip
    if failed:
        raise MemoryError(_NO_MEMORY)
    labels[...] = own


def spread_by_numpy(
    labels: NDArray[Any],
    free: Mask,
    times: int,
    links: Sequence[Mask] | None = None,
    heights: Heights | None = None,
) -> None:
    """As :func:`spread`."""
    height, width = labels.shape
    # Only the pixels without a label are looked at, which are few; a frame of no label is around.
    todo = np.flatnonzero(free & (labels == 0))
    rows, columns = np.divmod(todo, width)
    framed = np.zeros((height + 2, width + 2), labels.dtype)
    framed[1:-1, 1:-1] = labels
    flat = framed.ravel()
    place = (rows + 1) * (width + 2) + columns + 1
    beside = place + np.array([[width + 2], [-width - 2], [1], [-1]])
    passes = np.ones(beside.shape, bool)
    if links is not None:
        for axis in (0, 1):
            linked = np.zeros((height + 1, width + 1), bool)
            linked[1:, 1:][sides(axis)[0]] = links[axis]
            passes[2 * axis] = linked[rows + 1, columns + 1]
            passes[2 * axis + 1] = linked[rows + axis, columns + 1 - axis]
    for _ in range(times):
        given = np.zeros(len(todo), labels.dtype)
        for sources, passing in zip(beside, passes):
            label = flat[sources]
            takes = passing & (label > 0) & (given == 0)
            if heights is not None:
                mine, given_to = heights.of_pixels.flat[todo[takes]], label[takes]
                with np.errstate(invalid="ignore"):
                    takes[takes] = (mine > heights.low[given_to]) & (mine < heights.high[given_to])
            given[takes] = label[takes]
        left = given == 0
        if left.all():
            break
        flat[place] = given
        todo, place, beside, passes = todo[left], place[left], beside[:, left], passes[:, left]
    labels[...] = framed[1:-1, 1:-1]


def ends_by_number(
    numbers: Ids, values: Array, count: int, percent: tuple[float, float] = STRAY
) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
    """Between what nearly all values of each number are, see :data:`STRAY`.

    Args:
        numbers: below ``count``, 0 for what is left out, shape (n,).
        values: NaN is left out, shape (n, k).
        percent: of the values that are less than either end [%].

    Returns:
        Low and high, NaN where there are none, shape (count, k) each.
    """
    library = written(_FILE)
    if library is None:
        return ends_by_numpy(numbers, values, count, percent)
    own = [np.ascontiguousarray(numbers, np.int32), np.ascontiguousarray(values.T, np.float32)]
    found, shares = np.full((2, count, values.shape[1]), np.nan), np.array(percent) / 100.0
    failed = library.quantiles(
        len(numbers), address(own[0]), values.shape[1], address(own[1]), count, len(shares),
        address(shares),
        address(found),
    )  # fmt: skip
    if failed:
        raise MemoryError(_NO_MEMORY)
    return found[0], found[1]


def ends_by_numpy(
    numbers: Ids, values: Array, count: int, percent: tuple[float, float] = STRAY
) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
    """As :func:`ends_by_number`."""
    found = np.full((2, count, values.shape[1]), np.nan)
    order = np.argsort(numbers, kind="stable")
    names, begins = np.unique(numbers[order], return_index=True)
    for name, own in zip(names.tolist(), np.split(values[order], begins[1:])):
        for axis, column in enumerate(own.T):
            known = column[~np.isnan(column)]
            if name and len(known):
                found[:, name, axis] = np.percentile(known, percent)
    return found[0], found[1]


def links_of(ids: Ids) -> list[Mask]:
    """Which neighbours have the same number, other than 0, by axis: (h - 1, w), (h, w - 1)."""
    library = written(_FILE)
    if library is None:
        pairs = [(ids[low], ids[high]) for low, high in map(sides, (0, 1))]
        return [(first == second) & (first > 0) for first, second in pairs]
    links = no_links(*ids.shape)
    library.of_one(*ids.shape, address(np.ascontiguousarray(ids, np.int32)), *map(address, links))
    return links


def no_links(height: int, width: int) -> list[Mask]:
    """Room for which neighbours are linked, by axis."""
    return [np.empty((height - 1, width), bool), np.empty((height, width - 1), bool)]


def planes(image: Array) -> Array:
    """The channels of an image one after another, (h, w, channels) -> (channels, h, w)."""
    return np.ascontiguousarray(image.transpose(2, 0, 1), np.float32)


def sides(axis: int) -> tuple[tuple[slice, ...], tuple[slice, ...]]:
    """The two pixels of each pair of neighbours along an axis."""
    before = (slice(None),) * axis
    return (*before, slice(None, -1)), (*before, slice(1, None))


def _between(axis: int) -> tuple[slice, slice]:
    """Where the lattice holds the links along an axis."""
    odd, even = slice(1, None, 2), slice(None, None, 2)
    return (odd, even) if axis == 0 else (even, odd)
