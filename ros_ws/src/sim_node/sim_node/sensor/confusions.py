# SPDX-License-Identifier: Apache-2.0
"""Errors of which pixels belong together: there are more masks than blocks, or fewer.

Each is an :data:`.segmentation.Error`, whose strength says how many blocks it happens to, or to all
if there are not as many. New masks get the next numbers that are free.
"""

from __future__ import annotations

import itertools
from typing import TYPE_CHECKING

import cv2
import numpy as np
from numpy.typing import NDArray

from .depth import depth_edges

if TYPE_CHECKING:
    from sim_node.frame import Frame

Labels = NDArray[np.uint16]

#: Masks with no more than this between them touch [px].
_TOUCHING = 2
#: At 1 m, jumps of depth that keep a surface from being one; see :func:`.depth.depth_edges` [m].
_EDGE_STEP = 0.015
#: A phantom's side where no block is seen whose form it could have: the picture's height by this.
_PHANTOM_PART = 10


def merged(frame: Frame, pairs: int, rng: np.random.Generator) -> Labels:
    """Labels in which so many pairs of blocks that touch in the picture have one label."""
    labels = frame.labels.copy()
    for _ in range(pairs):
        touching = touching_pairs(labels)
        if not touching:
            break
        first, second = touching[rng.integers(len(touching))]
        labels[labels == second] = first
    return labels


def touching_pairs(labels: Labels) -> list[tuple[int, int]]:
    """Pairs of labels, each ascending, whose masks touch, sorted."""
    window = np.ones((2 * _TOUCHING + 1, 2 * _TOUCHING + 1), np.uint8)
    present = _present(labels)
    near = {value: cv2.dilate((labels == value).astype(np.uint8), window) for value in present}
    return [
        (first, second)
        for first, second in itertools.combinations(present, 2)
        if np.any(near[first][labels == second])
    ]


def split(frame: Frame, blocks: int, rng: np.random.Generator) -> Labels:
    """Labels in which so many blocks have two, on the two sides of a line through their middle."""
    labels = frame.labels.copy()
    for value in _chosen(labels, blocks, rng):
        rows, columns = np.nonzero(frame.labels == value)
        angle = rng.uniform(0.0, np.pi)
        beyond = (rows - rows.mean()) * np.cos(angle) + (columns - columns.mean()) * np.sin(angle)
        half = beyond > 0.0
        labels[rows[half], columns[half]] = _free(labels)
    return labels


def missing(frame: Frame, blocks: int, rng: np.random.Generator) -> Labels:
    """Labels without so many of the blocks."""
    return np.where(
        np.isin(frame.labels, _chosen(frame.labels, blocks, rng)), np.uint16(0), frame.labels
    )


def phantom(frame: Frame, blocks: int, rng: np.random.Generator) -> Labels:
    """Labels with so many more: masks of the size of a block on the table.

    They lie where the picture shows one surface and no block, at most as many as find room.
    """
    labels = frame.labels.copy()
    blocked = (frame.depth <= 0.0) | depth_edges(frame.depth, _EDGE_STEP)
    for _ in range(blocks):
        height, width = _phantom_size(frame.labels, rng)
        fits = _corners((blocked | (labels > 0)), height, width)
        if len(fits) == 0:
            break
        top, left = fits[rng.integers(len(fits))]
        labels[top : top + height, left : left + width] = _free(labels)
    return labels


def _phantom_size(labels: Labels, rng: np.random.Generator) -> tuple[int, int]:
    """Height and width of the box around one of the blocks [px]."""
    chosen = _chosen(labels, 1, rng)
    if not chosen:
        return (max(1, labels.shape[0] // _PHANTOM_PART),) * 2
    rows, columns = np.nonzero(labels == chosen[0])
    return int(np.ptp(rows)) + 1, int(np.ptp(columns)) + 1


def _corners(blocked: NDArray[np.bool_], height: int, width: int) -> NDArray[np.int64]:
    """Upper left corners of the boxes in which nothing is blocked, shape (n, 2), rows first."""
    sums = cv2.integral(blocked.astype(np.uint8))
    inside = sums[height:, width:] - sums[:-height, width:]
    inside = inside - sums[height:, :-width] + sums[:-height, :-width]
    return np.argwhere(inside == 0)


def _present(labels: Labels) -> list[int]:
    """The labels of a picture, ascending."""
    return [int(value) for value in np.unique(labels) if value]


def _chosen(labels: Labels, count: int, rng: np.random.Generator) -> list[int]:
    present = _present(labels)
    return [int(value) for value in rng.permutation(present)[:count]] if present else []


def _free(labels: Labels) -> int:
    return int(labels.max()) + 1
