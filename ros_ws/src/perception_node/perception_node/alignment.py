# SPDX-License-Identifier: Apache-2.0
"""Edges as they are, where a lens smears colours and depth is a pixel or two beside them.

No camera shows edges as steps: lens, sensor and compression smear them over a few pixels, and those
of depth are ragged and displaced against colour's. Everything after this relies on a pixel being of
one thing.
"""

from __future__ import annotations

import ctypes
import math
from collections.abc import Sequence
from dataclasses import replace
from pathlib import Path
from typing import Any, Final

import cv2
import numpy as np
from numpy.typing import NDArray
from tamp_runtime.machine_code import address, written

from .depth_gaps import disk, fill
from .noise import color_noise, depth_noise
from .observation import Observation

Array = NDArray[np.float32]
Mask = NDArray[np.bool_]

#: So far edges of colour are smeared, and depth and colour displaced against one another, in a
#: picture of this width; more in a wider one, see :func:`smear_of` [px].
SMEAR: Final = (1, 256)
#: A pixel without depth has that of the neighbour, as far as this beyond the smear [px], whose
#: colour is most like it,
FILL_REACH: Final = 1
#: for so many times,
FILLS: Final = 2
#: Noise that is less than this does not matter [0..255].
MIN_NOISE: Final = 0.5
#: Of pixels as far away as this [px] those are averaged that differ by less than a few times the
#: noise.
SMOOTH: Final = (3, 6.0)
#: Where inverse depths of neighbours bend by more than this share, or this often the noise, is an
#: edge of depth.
EDGE: Final = 0.02
EDGE_NOISE: Final = 11.0
#: Further than this from what its colour says, depth is that of the other side of an edge [m]; the
#: table may be half as far away a few pixels on.
STEP: Final = 0.05
#: What shows that edges are not exact to a fraction of a pixel: how mixed their colours are, and
#: the part of pixels whose depth is that of the other side; from so much on it adds so many pixels
#: for each unit to the standard deviation of an edge, and this at most [px].
MIXED: Final = (0.05, 4.0)
MOVED: Final = (0.15, 10.0)
MOST_DOUBT: Final = 0.6
#: Where colours are mixed, depth is beside them if more than this part of it is that of the other
#: side. Else it says better than they do what a pixel is of: a side that mirrors the table looks
#: like it.
BESIDE: Final = 0.05
#: The depth of what has none.
NOTHING: Final = np.float32(-1.0)
#: A pixel whose neighbourhood spans less than this in every channel, or less than so many standard
#: deviations of the noise, is no edge [0..255].
FLAT: Final = 14.0
FLAT_NOISE: Final = 6.0

_FILE: Final = Path(__file__).with_suffix(".c")


def aligned(observation: Observation, box: tuple[slice, slice]) -> Observation:
    """The observation with steps for edges of colour, and edges of depth where those of colour are.

    ``sure`` says where depth is as measured, and not near an edge.

    Args:
        box: the rows and columns that matter; the rest stays as it is.
    """
    noise = color_noise(observation.rgb)
    part = smoothed(np.ascontiguousarray(observation.rgb[box]), noise)
    smear = smear_of(observation.rgb.shape[1])
    sharp, mixed = sharpened(part, smear, noise)
    if mixed > MIXED[0]:  # else a thin line would be taken for an edge that is smeared
        part = sharp
    rgb = observation.rgb.copy()
    rgb[box] = part
    if observation.depth is None:
        return replace(observation, rgb=rgb, noise=noise)
    measured = observation.depth[box].astype(np.float32)
    measured[~(measured > 0.0) | np.isinf(measured)] = np.nan
    reach = smear + FILL_REACH
    filled, moved, inner = _moved_to_colour(measured, part, smear)
    depth, sure = observation.depth.astype(np.float32), np.ones(observation.depth.shape, bool)
    if moved <= (MOVED[0] if mixed <= MIXED[0] else BESIDE):
        depth[box] = fill(measured, part, reach)
        sure[box] = ~np.isnan(measured) if mixed <= MIXED[0] else inner
    else:
        depth[box] = fill(filled, part, reach)
        sure[box] = inner
    doubts = [
        min(slope * max(0.0, share - begin), MOST_DOUBT)
        for share, (begin, slope) in ((mixed, MIXED), (moved, MOVED))
    ]
    return replace(
        observation,
        rgb=rgb,
        depth=depth,
        sure=sure,
        noise=noise,
        edge_doubt=math.hypot(*doubts),
    )


def smoothed(rgb: NDArray[np.uint8], noise: float) -> NDArray[np.uint8]:
    """The picture with less noise and the same edges.

    Args:
        rgb: shape (h, w, 3).
        noise: standard deviation of its channels [0..255].
    """
    if noise <= MIN_NOISE:
        return rgb
    reach, many = SMOOTH
    return np.asarray(cv2.bilateralFilter(rgb, 2 * reach + 1, many * noise, float(reach)), np.uint8)


def _moved_to_colour(
    measured: Array, rgb: NDArray[np.uint8], smear: int
) -> tuple[Array, float, Mask]:
    """Depth with its edges where those of colour are.

    Args:
        measured: NaN where depth is unknown, shape (h, w) [m].
        rgb: with steps for edges, shape (h, w, 3).
        smear: how far edges of both can be from one another [px].

    Returns:
        The depth; the part of pixels near its edges that were measured on their other side; which
        pixels are not near an edge.
    """
    inner = without_edges(measured, smear)
    # Of an area without depth a pixel may be, too; not of a gap at an edge.
    gap = np.ones((2 * (smear + FILL_REACH) + 1,) * 2, np.uint8)
    empty = cv2.erode(np.isnan(measured).view(np.uint8), gap)
    filled = np.where(cv2.dilate(empty, gap) > 0, NOTHING, inner)
    for _ in range(FILLS):
        filled = fill(filled, rgb, smear + FILL_REACH)
    moved = _settle(filled, measured, inner)
    return filled, moved, ~np.isnan(inner)


def _settle(filled: Array, measured: Array, inner: Array) -> float:
    """Gives back what was measured where depth did not move.

    Args:
        filled: what colours say, :data:`NOTHING` where nothing is, changed.
        measured: NaN where depth is unknown, shape (h, w) [m].
        inner: the same without that near edges.

    Returns:
        The part of pixels near edges that were measured on the other side.
    """
    library = written(_FILE)
    if library is None:
        return settle_by_numpy(filled, measured, inner)
    own = [np.ascontiguousarray(image) for image in (measured, inner)]
    found = np.zeros(2, np.int64)
    library.settle(
        filled.size, *map(ctypes.c_float, (STEP, EDGE, float(NOTHING))), address(filled),
        *map(address, own), address(found),
    )  # fmt: skip
    near, other = found.tolist()
    return other / near if near else 0.0


def settle_by_numpy(filled: Array, measured: Array, inner: Array) -> float:
    """As :func:`_settle`."""
    known = ~np.isnan(measured)
    both = np.isnan(inner) & known & ~np.isnan(filled)
    differ = np.abs(measured[both] - filled[both]) > STEP
    # A face so narrow that all of it is near an edge has nothing but what was measured there.
    rest = np.isnan(filled) | (both & (np.abs(measured - filled) <= EDGE))
    filled[rest] = measured[rest]
    filled[filled == NOTHING] = np.nan
    return float(differ.mean()) if len(differ) else 0.0


def smear_of(width: int) -> int:
    """How far edges are smeared in a picture of this width [px]."""
    pixels, usual = SMEAR
    return max(1, round(pixels * width / usual))


def sharpened(rgb: NDArray[np.uint8], reach: int, noise: float) -> tuple[NDArray[np.uint8], float]:
    """Gives pixels of an edge the colour of the side that they look like.

    Where a blurred edge is between two even colours, its pixels are mixtures: each becomes what the
    evenest pixel near by is that it resembles.

    Args:
        rgb: shape (h, w, 3).
        reach: how far an edge is smeared to each side [px].
        noise: standard deviation of the channels [0..255].

    Returns:
        The picture, and how mixed its edges were: the mean change of an edge's pixel, as part of
        the edge's height.
    """
    kernel = np.ones((3, 3), np.uint8)
    span = np.maximum.reduce(cv2.split(cv2.dilate(rgb, kernel) - cv2.erode(rgb, kernel)))
    at = np.flatnonzero(span > max(FLAT, FLAT_NOISE * noise))
    if len(at) == 0:
        return rgb, 0.0
    flat = rgb.reshape(-1, 3)
    best = _resembled(rgb, span, at, disk(reach))
    out = rgb.copy()
    out.reshape(-1, 3)[at] = flat[best]
    change = np.maximum.reduce(cv2.split(cv2.absdiff(flat[best], flat[at])[None]))[0]
    return out, float(np.mean(change / span.ravel()[at]))


def _resembled(
    rgb: NDArray[np.uint8],
    span: NDArray[np.uint8],
    at: NDArray[np.intp],
    steps: Sequence[tuple[int, int]],
) -> NDArray[np.intp]:
    """Of the evenest pixels near by those that n pixels resemble, as indices, shape (n,).

    Args:
        rgb: shape (h, w, 3).
        span: how uneven the neighbourhood of a pixel is, shape (h, w).
        at: the pixels, as indices of the flattened picture, shape (n,).
        steps: (down, right) to the pixels that are looked at.
    """
    library = written(_FILE)
    if library is None:
        return resembled_by_numpy(rgb, span, at, steps)
    (height, width), ways = span.shape, np.array(steps, np.intc)
    best = np.empty(len(at), np.int64)
    own: list[NDArray[Any]] = [
        np.ascontiguousarray(rgb), np.ascontiguousarray(span), at.astype(np.int64),
    ]  # fmt: skip
    library.resembled(
        height, width, address(own[0]), address(own[1]), len(at), address(own[2]), len(ways),
        address(ways),
        address(best),
    )  # fmt: skip
    return best


def resembled_by_numpy(
    rgb: NDArray[np.uint8],
    span: NDArray[np.uint8],
    at: NDArray[np.intp],
    steps: Sequence[tuple[int, int]],
) -> NDArray[np.intp]:
    """As :func:`_resembled`."""
    height, width = span.shape
    rows, columns = np.divmod(at, width)
    flat = rgb.reshape(-1, 3).astype(np.int16)
    uneven, own = span.ravel().astype(np.int16), flat[at]
    best, least = np.zeros(len(at), np.intp), np.full(len(at), 32_000, np.int16)
    for down, right in steps:
        below, beside = np.clip(rows + down, 0, height - 1), np.clip(columns + right, 0, width - 1)
        there = below * width + beside
        score = 2 * uneven[there] + np.abs(flat[there] - own).sum(axis=1, dtype=np.int16)
        better = score < least
        best[better], least[better] = there[better], score[better]
    return best


def without_edges(depth: Array, band: int) -> Array:
    """The depth without that near its edges, where it often is that of the other side.

    Args:
        depth: NaN where it is unknown, shape (h, w) [m].
        band: how far depth and colour can be displaced against one another [px].
    """
    edge = _bends(depth, max(EDGE, EDGE_NOISE * depth_noise(depth)))
    if band > 1:
        around = np.ones((2 * band - 1, 2 * band - 1), np.uint8)
        edge = np.asarray(cv2.dilate(edge, around), np.uint8)
    return np.where(edge > 0, np.float32(np.nan), depth)


def _bends(depth: Array, limit: float) -> NDArray[np.uint8]:
    """Where the inverse of depth bends by more than this share of it, shape (h, w).

    On a plane it is linear in the picture.
    """
    library = written(_FILE)
    if library is None:
        return bends_by_numpy(depth, limit)
    depth = np.ascontiguousarray(depth)
    edge = np.empty(depth.shape, np.uint8)
    if library.bends(*depth.shape, address(depth), ctypes.c_float(limit), address(edge)):
        raise MemoryError("no memory to find edges of depth")
    return edge


def bends_by_numpy(depth: Array, limit: float) -> NDArray[np.uint8]:
    """As :func:`_bends`."""
    inverse = np.nan_to_num(1.0 / depth)
    bend = np.zeros(depth.shape, np.float32)
    for part in (np.s_[:, :-2], np.s_[:, 1:-1], np.s_[:, 2:]), (np.s_[:-2], np.s_[1:-1], np.s_[2:]):
        before, at, after = part
        np.fmax(bend[at], np.abs(inverse[before] - 2.0 * inverse[at] + inverse[after]), bend[at])
    with np.errstate(invalid="ignore"):
        return (bend * depth > limit).view(np.uint8)
