# SPDX-License-Identifier: Apache-2.0
"""Facets that leak: at their rims they are linked with what is no part of the face."""

from __future__ import annotations

import ctypes
from pathlib import Path
from typing import Final

import cv2
import numpy as np
from numpy.typing import NDArray
from tamp_runtime.machine_code import address, written

from .facets import Facets, counts, uniform
from .pieces import Array, Ids, Mask, borders, connected, ends_by_number, spread

#: A facet leaks of which so many pixels are higher or lower than the face by more than this [m].
LEAK: Final = 0.01
LEAK_PIXELS: Final = 10

_FILE: Final = Path(__file__).with_suffix(".c")
_Ends = NDArray[np.float64]


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
    wide, same = _wide(facets, reach), facets.links()
    count, pieces = connected(wide, same)
    # The largest piece of each facet, and how many pixels are higher or lower than it.
    pixels, _ = counts(pieces, wide, count)
    largest = np.zeros(facets.count + 1, np.int32)
    order = np.argsort(pixels[1:], kind="stable") + 1
    largest[_owners(facets.ids, pieces, count)[order]] = order
    of_largest = _of_largest(facets.ids, pieces, largest)
    ends = ends_by_number(of_largest.ravel(), height.reshape(-1, 1), len(largest))
    low, high = (end[:, 0] for end in ends)
    leaks = _beyond(facets.ids, height, low - LEAK, high + LEAK) >= LEAK_PIXELS
    kept = _kept(facets.ids, wide, leaks)
    count, pieces = connected(kept, same)
    shared = pieces * wide
    spread(shared, facets.ids > 0, 2 * reach)
    return Facets(pieces, count - 1, borders(count, pieces, shared))


def _wide(facets: Facets, reach: int) -> Mask:
    """The pixels of facets that are not in their strips, shape (h, w)."""
    ids, around = facets.ids, np.ones((2 * reach + 1,) * 2, np.uint8)
    inner, none = uniform(ids, 2 * reach + 1), np.float32(facets.count + 1)
    library = written(_FILE)
    if library is None:
        values = ids.astype(np.float32)
        inner &= ids > 0
        grown = cv2.dilate(np.where(inner, values, 0.0).astype(np.float32), around)
        least = cv2.erode(np.where(inner, values, none).astype(np.float32), around)
        return np.asarray((ids > 0) & ((grown == values) | (least == values)))
    low, high, wide = np.empty(ids.shape, np.float32), np.empty(ids.shape, np.float32), inner
    library.part(ids.size, address(ids), address(inner), ctypes.c_float(float(none)), address(low),
                 address(high))  # fmt: skip
    grown, least = cv2.dilate(low, around), cv2.erode(high, around)
    library.wide(ids.size, address(ids), address(grown), address(least), address(wide))
    return wide


def _owners(ids: Ids, pieces: Ids, count: int) -> NDArray[np.int32]:
    """The facet of each of so many pieces."""
    owner, library = np.zeros(count, np.int32), written(_FILE)
    if library is None:
        owner[pieces.ravel()] = ids.ravel()
        owner[0] = 0
    else:
        library.owners(ids.size, address(ids), address(pieces), address(owner))
    return owner


def _of_largest(ids: Ids, pieces: Ids, largest: NDArray[np.int32]) -> Ids:
    """The facets of pixels in the largest piece of theirs, else 0; ``largest`` by facet."""
    library = written(_FILE)
    if library is None:
        return np.where((pieces > 0) & (largest[ids] == pieces), ids, 0)
    found = np.empty(ids.shape, np.int32)
    library.of_largest(ids.size, *map(address, (ids, pieces, largest, found)))
    return found


def _beyond(ids: Ids, height: Array, low: _Ends, high: _Ends) -> NDArray[np.int64]:
    """How many pixels of each facet are not between two heights; NaN is no bound."""
    library = written(_FILE)
    if library is None:
        with np.errstate(invalid="ignore"):
            beyond = (height < low[ids]) | (height > high[ids])
        return np.bincount(ids[beyond & (ids > 0)], minlength=len(low))
    found, height = np.zeros(len(low), np.int64), np.ascontiguousarray(height, np.float32)
    bounds = address(np.ascontiguousarray(low)), address(np.ascontiguousarray(high))
    library.beyond(ids.size, address(ids), address(height), *bounds, address(found))
    return found


def _kept(ids: Ids, wide: Mask, leaks: NDArray[np.bool_]) -> Mask:
    """The pixels of facets, without the strips of those that leak."""
    library = written(_FILE)
    if library is None:
        return np.asarray((ids > 0) & (wide | ~leaks[ids]))
    kept = np.empty(ids.shape, bool)
    library.kept(ids.size, address(ids), address(wide), address(leaks), address(kept))
    return kept
