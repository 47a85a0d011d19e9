# SPDX-License-Identifier: Apache-2.0
"""Gaps in depth, filled by what colour says of their pixels."""

from __future__ import annotations

import ctypes
from pathlib import Path
from typing import Final

import cv2
import numpy as np
from numpy.typing import NDArray
from tamp_runtime.machine_code import address, written

Array = NDArray[np.float32]

#: A pixel has the depth of a neighbour only if their channels differ by less than this altogether
#: [0..255].
FILL_LIKENESS: Final = 60.0

_FILE: Final = Path(__file__).with_suffix(".c")


def disk(reach: int) -> list[tuple[int, int]]:
    """Steps (down, right) to the pixels within a distance [px], the nearest ones first."""
    span = range(-reach, reach + 1)
    steps = [(i, j) for i in span for j in span if i * i + j * j <= (reach + 0.3) ** 2]
    return sorted(steps, key=lambda step: step[0] ** 2 + step[1] ** 2)


def fill(depth: Array, rgb: NDArray[np.uint8], reach: int) -> Array:
    """Gives pixels without depth that of the neighbour, near by, whose colour is most like theirs.

    Args:
        depth: NaN where it is unknown, shape (h, w) [m].
        rgb: shape (h, w, 3).
        reach: how far away the neighbour can be [px].
    """
    library = written(_FILE)
    if library is None:
        return fill_by_numpy(depth, rgb, reach)
    steps = np.array(disk(reach)[1:], np.intc)
    # Of two that look alike the nearer one.
    costs = (2.0 * np.hypot(steps[:, 0], steps[:, 1])).astype(np.float32)
    depth, rgb = np.ascontiguousarray(depth, np.float32), np.ascontiguousarray(rgb)
    known, around = (~np.isnan(depth)).view(np.uint8), np.ones((2 * reach + 1,) * 2, np.uint8)
    wanted, filled = cv2.bitwise_xor(cv2.dilate(known, around), known), np.empty_like(depth)
    library.fill(
        *depth.shape, address(depth), address(wanted), address(rgb), len(steps), address(steps),
        address(costs),
        ctypes.c_float(FILL_LIKENESS), address(filled),
    )  # fmt: skip
    return filled


def fill_by_numpy(depth: Array, rgb: NDArray[np.uint8], reach: int) -> Array:
    """As :func:`fill`."""
    unknown = np.isnan(depth)
    near = cv2.dilate((~unknown).view(np.uint8), np.ones((2 * reach + 1, 2 * reach + 1), np.uint8))
    at = np.flatnonzero(unknown & (near > 0))
    if len(at) == 0:
        return depth
    width = depth.shape[1]
    wide = width + 2 * reach
    at_wide = (at // width + reach) * wide + at % width + reach
    depths = np.pad(depth, reach, constant_values=np.nan).ravel()
    colors = [np.pad(channel.astype(np.int16), reach, "edge").ravel() for channel in cv2.split(rgb)]
    own = [channel[at_wide] for channel in colors]
    best: NDArray[np.float32] = np.full(len(at), np.nan, np.float32)
    least = np.full(len(at), FILL_LIKENESS, np.float32)
    for down, right in disk(reach)[1:]:
        there = at_wide + (down * wide + right)
        found = depths[there]
        # Of two that look alike the nearer one.
        difference = np.full(len(at), 2.0 * np.hypot(down, right), np.float32)
        for channel, mine in zip(colors, own):
            difference += np.abs(channel[there] - mine)
        better = (difference < least) & ~np.isnan(found)
        best[better], least[better] = found[better], difference[better]
    filled = depth.copy()
    filled.reshape(-1)[at] = best
    return filled
