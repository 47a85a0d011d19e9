# SPDX-License-Identifier: Apache-2.0
"""How far the masks of blocks reach in a picture, and over which place each is."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from typing import Final

import cv2
import numpy as np
from numpy.typing import NDArray

from perception_node.camera import PinholeCamera
from perception_node.errors import BadImageError
from perception_node.masks import pixels_of
from perception_node.segment import Segments

Array = NDArray[np.float64]
Mask = NDArray[np.bool_]

#: So many directions are looked at.
DIRECTIONS: Final = 32
#: A block stands no further than this beside the upright line over a place [m].
BESIDE: Final = 0.075
#: What is within this of an outline may cover it [m],
OUTSIDE: Final = 0.01
#: where it looks to the side on which that is: by at least this cosine.
FACING: Final = 0.25


@dataclass(frozen=True)
class Reach:
    """How far the masks of N blocks reach, in K directions.

    Attributes:
        directions: shape (K, 2).
        far: shape (N, K) [px].
        covered: where something else covers the edge, shape (N, K).
        scale: pixels for a metre at each block, shape (N,).
    """

    directions: Array
    far: Array
    covered: Mask
    scale: Array


def points_around(part: Mask, outline: Array | None) -> Array:
    """Points around a mask, of its pixels' corners where no finer ones are known, (n, 2) [px]."""
    if outline is not None:
        return outline
    rows, columns = pixels_of(part)
    around = np.array([[-0.5, -0.5], [-0.5, 0.5], [0.5, -0.5], [0.5, 0.5]])
    return (np.stack([columns, rows], -1)[:, None] + around).reshape(-1, 2)


def towers_over(outlines: Sequence[Array], camera: PinholeCamera, feet: Array) -> list[list[int]]:
    """For each place the blocks over it, from the bottom: as upright lines are seen in a picture.

    Raises:
        BadImageError: if a block is over none.
    """
    up = np.array([0.0, 0.0, 0.3])
    low, high = camera.project(feet), camera.project(feet + up)
    scale = scales(camera, feet)
    towers: list[list[tuple[float, int]]] = [[] for _ in feet]
    for index, points in enumerate(outlines):
        middle = 0.5 * (points.min(axis=0) + points.max(axis=0))
        along = (middle[1] - low[:, 1]) / (high[:, 1] - low[:, 1])
        off = np.abs(middle[0] - (low + along[:, None] * (high - low))[:, 0]) / scale
        place = int(off.argmin())
        if off[place] > BESIDE:
            raise BadImageError(
                f"what is seen at pixel ({middle[0]:.0f}, {middle[1]:.0f}) stands on no place: it "
                f"is {1000 * off[place]:.0f} mm beside the nearest; put every block on a place, or "
                "check the parameter stack_positions and camera/extrinsics"
            )
        towers[place].append((-float(middle[1]), index))
    return [[index for _, index in sorted(tower)] for tower in towers]


def scales(camera: PinholeCamera, points: Array) -> Array:
    """Pixels for a metre across, at points, shape (n,)."""
    forward = camera.world_from_optical[:3, 2]
    depth = (points - camera.position_world) @ forward
    return np.asarray(camera.intrinsics[0, 0] / np.maximum(depth, 1e-3))


def reach_of(
    segments: Segments,
    outlines: Sequence[Array],
    towers: Sequence[Sequence[int]],
    camera: PinholeCamera,
    feet: Array,
) -> Reach:
    """How far each mask reaches, and where something that is nearer to the camera covers its edge.

    Args:
        outlines: points around each block, shape (n, 2) [px].
        towers: for each place the blocks over it, from the bottom.
        feet: of the places, shape (m, 3) [m].
    """
    angles = np.linspace(0.0, 2.0 * np.pi, DIRECTIONS, endpoint=False)
    directions = np.stack([np.cos(angles), np.sin(angles)], -1)
    count = len(outlines)
    place, level = np.zeros(count, int), np.zeros(count, int)
    for number, tower in enumerate(towers):
        place[tower], level[tower] = number, range(len(tower))
    scale = scales(camera, feet)[place]
    near = -scales(camera, feet)[place]
    far, covered = np.zeros((count, DIRECTIONS)), np.zeros((count, DIRECTIONS), bool)
    marked = np.full(int(segments.label_image.max(initial=0)) + 1, -1)
    marked[[segment.label for segment in segments]] = range(count)
    numbers = marked[segments.label_image]
    if segments.hides is not None:
        numbers[segments.hides & (numbers < 0)] = count
    place, level = np.append(place, -1), np.append(level, 0)
    near = np.append(near, -np.inf)
    for index, (segment, points) in enumerate(zip(segments, outlines)):
        far[index] = (points @ directions.T).max(axis=0)
        gap = max(1, round(OUTSIDE * scale[index]))
        for other, contacts, normal in _contacts(segment.part, numbers, index, gap):
            # Of a tower the upper one is before the lower, seen from above; of two the nearer one.
            if place[other] == place[index]:
                before = level[other] > level[index]
            else:
                before = near[other] < near[index]
            if before:
                beyond = (contacts @ directions.T).max(axis=0) > far[index] - 0.3
                covered[index] |= beyond & (directions @ normal > FACING)
    return Reach(directions, far, covered, scale)


def _contacts(
    part: Mask, numbers: NDArray[np.intp], index: int, gap: int
) -> Iterator[tuple[int, Array, Array]]:
    """What is beside a block: its number, its pixels there, (n, 2) [px], and on which side.

    Args:
        part: of the block, shape (height, width).
        numbers: of what every pixel is of, -1 of nothing, shape (height, width).
        gap: how far beside it [px].
    """
    left, top, width, height = cv2.boundingRect(part.astype(np.uint8))
    box = np.s_[max(0, top - gap) : top + height + gap, max(0, left - gap) : left + width + gap]
    corner = np.array([box[1].start, box[0].start])
    mine = part[box]
    disc = cv2.getStructuringElement(cv2.MORPH_ELLIPSE, (2 * gap + 1,) * 2)
    around = np.where(cv2.dilate(mine.astype(np.uint8), disc) > 0, numbers[box], -1)
    rows, columns = pixels_of(mine)
    middle = corner + [columns.mean(), rows.mean()]
    for other in np.unique(around):
        if other in (-1, index):
            continue
        rows, columns = pixels_of(around == other)
        points = corner + np.stack([columns, rows], -1)
        aside = points.mean(axis=0) - middle
        yield int(other), points.astype(float), aside / max(float(np.hypot(*aside)), 1e-9)
