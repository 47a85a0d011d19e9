# SPDX-License-Identifier: Apache-2.0
"""What a picture says about one block: depths of its pixels, and where its outline is seen."""

from __future__ import annotations

import ctypes
from collections.abc import Collection
from dataclasses import dataclass
from pathlib import Path
from typing import Any, Final

import numpy as np
from numpy.typing import NDArray
from tamp_runtime.machine_code import address, written

from perception_node.camera import PinholeCamera
from perception_node.errors import BadImageError
from perception_node.masks import pixels_of
from perception_node.quantiles import quantiles
from perception_node.segment import Segment, Segments

Array = NDArray[np.float64]
Mask = NDArray[np.bool_]

#: Least share of a block's pixels that must have depth, and least number.
MIN_DEPTH_SHARE: Final = 0.3
MIN_PIXELS: Final = 12
#: Depths near edges are used where fewer others are known.
MIN_SURE: Final = 40
#: Standard deviation of a point of the outline: it is anywhere between two pixels [px].
OUTLINE_NOISE: Final = 0.3
#: An outline has about as many sides, each of which may be displaced as a whole.
SIDES: Final = 6.0
#: Of a block at most so many depths are used, spread over all of its pixels.
MAX_DEPTHS: Final = 200
#: A neighbour nearer than this much, beyond the noise, is in front of the block [m].
IN_FRONT: Final = 0.004
#: Where a neighbour has no depth, as often at edges, the next one with it counts, no further than
#: this [px].
REACH: Final = 3
#: A block that is higher than another one by this, and no further beside it than that, may stand on
#: it: between the medians of what is seen of both [m].
HIGHER: Final = 0.008
BESIDE: Final = 0.06

_FILE: Final = Path(__file__).with_suffix(".c")


@dataclass(frozen=True)
class Evidence:
    """What a picture says about one block.

    Attributes:
        points: of its surface as measured, shape (n, 3) [m].
        rays: directions of their pixels in world, shape (n, 3).
        noise: standard deviation of their depths, shape (n,) [m].
        outline: points where the block ends and nothing is before it, between two pixels, shape
            (o, 2) [px].
        camera: that took the picture.
        edge_noise: standard deviations of the points of the outline, as those of points of which
            none is like another, shape (o,) [px].
    """

    points: Array
    rays: Array
    noise: Array
    outline: Array
    camera: PinholeCamera
    edge_noise: Array


def evidence_of(
    segment: Segment,
    segments: Segments,
    depth: NDArray[np.floating],
    camera: PinholeCamera,
    noise: float,
    covers: Collection[int] = (),
    sure: Mask | None = None,
    edge_doubt: float = 0.0,
) -> Evidence:
    """What a picture says about a block.

    Args:
        covers: labels of the blocks that may stand on it, see :func:`covering`: where they begin
            it does not end.
        depth: anything but a positive number means unknown, shape (height, width) [m].
        noise: of depth at 1 m; it grows with the square [m].
        sure: pixels whose depth may be used, as far as there are enough, shape (height, width).
        edge_doubt: by how much more than their size pixels of the outline may be displaced [px].

    Raises:
        BadImageError: if too little depth is known; the sentence goes on from the block's name.
    """
    part = segment.part
    rows, columns = np.flatnonzero(part.any(1)), np.flatnonzero(part.any(0))
    if len(rows) == 0:
        raise BadImageError("it has no pixels")
    top, left = rows[0], columns[0]
    # Some more pixels on every side; what is beyond the picture is unlike anything.
    wide = _padded(part, rows, columns, fill=False)
    labels = _padded(segments.label_image, rows, columns, fill=-1)
    near = _padded(depth, rows, columns, fill=np.nan).astype(np.float64)
    near[~(near > 0.0) | np.isinf(near)] = np.nan
    known = wide & np.isfinite(near)
    count, all_of_it = np.count_nonzero(known), np.count_nonzero(wide)
    if count < MIN_DEPTH_SHARE * all_of_it or count < MIN_PIXELS:
        raise BadImageError(f"only {count / all_of_it:.0%} of its pixels have depth")
    if sure is not None:
        reliable = known & _padded(sure, rows, columns, fill=False)
        if np.count_nonzero(reliable) >= MIN_SURE:
            known = reliable
    at = np.flatnonzero(known)
    at = at[:: -(-len(at) // MAX_DEPTHS)]
    inner = np.stack(
        [at % wide.shape[1] + left - REACH, at // wide.shape[1] + top - REACH], axis=-1
    )
    depths = near.ravel()[at]
    goes_on = labels == -1
    for label in covers:
        goes_on |= labels == label
    outline, shared = _ends(wide, goes_on, near, noise)
    rays = camera.rays_world(inner)
    return Evidence(
        points=camera.position_world + rays * depths[:, None],
        rays=rays,
        noise=np.maximum(noise * depths**2, 2e-4),
        outline=outline + (left - REACH, top - REACH),
        camera=camera,
        edge_noise=_edge_noise(shared, edge_doubt),
    )


def _edge_noise(shared: Array, doubt: float) -> Array:
    """Standard deviations of the points of an outline, shape (o,) [px].

    Args:
        shared: how many of them lie on one straight line along rows or columns, and so are off by
            the same fraction of a pixel, shape (o,).
        doubt: by how much a whole side may be displaced [px].
    """
    side = len(shared) / SIDES
    return np.hypot(OUTLINE_NOISE * np.sqrt(shared), doubt * np.sqrt(side))


def _padded(
    image: NDArray[Any], rows: NDArray[np.intp], columns: NDArray[np.intp], fill: float
) -> NDArray[Any]:
    """The part of an image from the first to the last row and column, and REACH pixels around."""
    top, bottom = rows[0] - REACH, rows[-1] + REACH + 1
    left, right = columns[0] - REACH, columns[-1] + REACH + 1
    height, width = image.shape
    # Labels have no negative numbers, but what is beyond the picture is like none of them.
    kind = np.int64 if np.issubdtype(image.dtype, np.integer) else image.dtype
    out = np.full((bottom - top, right - left), fill, kind)
    a, b, c, d = max(top, 0), min(bottom, height), max(left, 0), min(right, width)
    out[a - top : b - top, c - left : d - left] = image[a:b, c:d]
    return out


def covering(
    segments: Segments, depth: NDArray[np.floating], camera: PinholeCamera
) -> list[frozenset[int]]:
    """For each block the labels of those that may stand on it, directly or not."""
    middles = np.full((len(segments), 3), np.nan)
    for index, segment in enumerate(segments):
        left, top, width, height = segment.box
        rows, columns = pixels_of(segment.part[top : top + height, left : left + width])
        rows, columns = rows + top, columns + left
        found = depth[rows, columns]
        known = (found > 0.0) & np.isfinite(found)
        if known.any():
            rays = camera.rays_world(np.stack([columns[known], rows[known]], axis=-1))
            points = camera.position_world + rays * found[known, None]
            middles[index] = quantiles(points, 0.5)[0]
    apart = middles[None] - middles[:, None]
    with np.errstate(invalid="ignore"):
        on = (apart[..., 2] > HIGHER) & (np.hypot(apart[..., 0], apart[..., 1]) < BESIDE)
    labels = [segment.label for segment in segments]
    return [frozenset(label for label, above in zip(labels, row) if above) for row in on]


def _ends(mask: Mask, goes_on: Mask, depth: Array, noise: float) -> tuple[Array, Array]:
    """Points between a pixel of the block and one that is not, where the block is what ends.

    Args:
        goes_on: pixels behind which it may go on.

    Returns:
        Of all directions (column, row) in the padded part, shape (o, 2) [px], and how many share a
        line, shape (o,).
    """
    library = written(_FILE)
    if library is None:
        return ends_by_numpy(mask, goes_on, depth, noise)
    images = [np.ascontiguousarray(image) for image in (mask, goes_on, depth)]
    points, shared = np.empty((4 * mask.size, 2)), np.empty(4 * mask.size)
    pointers = map(address, (*images, points, shared))
    count = library.ends(
        *mask.shape, next(pointers), next(pointers), next(pointers),
        ctypes.c_double(IN_FRONT), ctypes.c_double(noise), REACH, next(pointers), next(pointers),
    )  # fmt: skip
    if count < 0:
        raise MemoryError("no memory to find where a block ends")
    return points[:count], shared[:count]


def ends_by_numpy(mask: Mask, goes_on: Mask, depth: Array, noise: float) -> tuple[Array, Array]:
    """As :func:`_ends`."""
    found = []
    for axis, step in ((0, -1), (0, 1), (1, -1), (1, 1)):
        mine = (slice(None),) * axis + (slice(1, None) if step < 0 else slice(None, -1),)
        other = (slice(None),) * axis + (slice(None, -1) if step < 0 else slice(1, None),)
        border = mask[mine] & ~mask[other] & ~goes_on[other]
        tolerance = IN_FRONT + 4.0 * noise * np.nan_to_num(depth[mine]) ** 2
        nearest, behind = _known_beside(mask, goes_on, depth, axis, step)
        with np.errstate(invalid="ignore"):
            hidden = depth[mine] - nearest[mine] > tolerance
        rows, columns = pixels_of(border & ~hidden & ~behind[mine])
        point = np.stack([columns, rows], axis=-1).astype(np.float64)
        # Row or column of the block's own pixel, and half a pixel towards the other one.
        point[:, 1 - axis] += (1.0 if step < 0 else 0.0) + 0.5 * step
        _, line, count = np.unique(point[:, 1 - axis], return_inverse=True, return_counts=True)
        found.append((point, count[line].astype(np.float64)))
    points, shared = zip(*found)
    return np.concatenate(points), np.concatenate(shared)


def _known_beside(
    mask: Mask, goes_on: Mask, depth: Array, axis: int, step: int
) -> tuple[Array, Mask]:
    """For each pixel the depth of the first one with it, and whether the block may go on behind it.

    Of the REACH pixels that follow in a direction; NaN where none has depth, or the first is of the
    block.
    """
    nearest, behind = np.full(depth.shape, np.nan), np.zeros(depth.shape, bool)
    count, sought = depth.shape[axis], np.ones(depth.shape, bool)
    for far in range(1, min(REACH, count - 1) + 1):
        mine = (slice(None),) * axis + ((slice(far, None) if step < 0 else slice(None, -far)),)
        other = (slice(None),) * axis + ((slice(None, -far) if step < 0 else slice(far, None)),)
        found = sought[mine] & np.isfinite(depth[other])
        usable = found & ~mask[other]
        nearest[mine] = np.where(usable, depth[other], nearest[mine])
        behind[mine] |= usable & goes_on[other]
        sought[mine] &= ~found
    return nearest, behind
