# SPDX-License-Identifier: Apache-2.0
"""Errors of where masks end: they say how many blocks there are, but not exactly where.

Each is an :data:`.segmentation.Error`; distances are those of a chessboard, in pixels.
"""

from __future__ import annotations

from typing import TYPE_CHECKING, Any, Final, TypeVar

import cv2
import numpy as np
from numpy.typing import NDArray
from scipy.special import ndtr

if TYPE_CHECKING:
    from sim_node.frame import Frame

Labels = NDArray[np.uint16]
Pixels = TypeVar("Pixels", bound=NDArray[Any])

_NEIGHBOURS: Final = np.ones((3, 3), np.uint8)


def eroded(frame: Frame, pixels: int, _rng: np.random.Generator) -> Labels:
    """Every mask without what is closer than ``pixels`` to another label or to none.

    The picture's borders take nothing away.
    """
    window = np.ones((2 * pixels + 1, 2 * pixels + 1), np.uint8)
    least, greatest = cv2.erode(frame.labels, window), cv2.dilate(frame.labels, window)
    return np.where(least == greatest, frame.labels, np.uint16(0))


def dilated(frame: Frame, pixels: int, _rng: np.random.Generator) -> Labels:
    """Every mask with what has no label and is up to ``pixels`` away; the nearest mask gets it."""
    labels = frame.labels
    for _ in range(pixels):
        labels = np.where(labels == 0, cv2.dilate(labels, _NEIGHBOURS), labels)
    return labels


def shifted(frame: Frame, pixels: int, rng: np.random.Generator) -> Labels:
    """All labels beside the picture, by ``pixels`` in a random direction; none come in."""
    along, across = pixels, int(rng.integers(-pixels, pixels + 1))
    along *= int(rng.choice((-1, 1)))
    return moved(frame.labels, *((along, across) if rng.integers(2) else (across, along)))


def moved(picture: Pixels, down: int, right: int) -> Pixels:
    """Labels, or any picture, moved by whole pixels; 0 where nothing comes from."""
    height, width = picture.shape[:2]
    result = np.zeros_like(picture)
    rows, columns = max(0, height - abs(down)), max(0, width - abs(right))
    top, left = max(down, 0), max(right, 0)
    source_top, source_left = max(-down, 0), max(-right, 0)
    result[top : top + rows, left : left + columns] = picture[
        source_top : source_top + rows, source_left : source_left + columns
    ]
    return result


def boundary(frame: Frame, pixels: int, rng: np.random.Generator) -> Labels:
    """Outlines that wobble in and out: each label is that of a pixel up to ``pixels`` away.

    How far down and how far right it is taken from are uniform over −pixels..pixels, and alike for
    pixels that are close together.
    """
    height, width = frame.labels.shape
    rows, columns = np.mgrid[:height, :width]
    down, right = (_wobble((height, width), pixels, rng) for _ in range(2))
    source_rows = np.clip(rows + down, 0, height - 1)
    return frame.labels[source_rows, np.clip(columns + right, 0, width - 1)]


def _wobble(shape: tuple[int, int], pixels: int, rng: np.random.Generator) -> NDArray[np.int64]:
    """Whole numbers, uniform over −pixels..pixels, smooth over the picture."""
    # Waves so long that outlines bend but do not fold over: noise under a Gaussian of this width.
    width = 2.0 + pixels
    margin = int(np.ceil(3.0 * width))
    kernel = cv2.getGaussianKernel(2 * margin + 1, width, cv2.CV_32F)
    wide = rng.standard_normal((shape[0] + 2 * margin, shape[1] + 2 * margin), np.float32)
    inner = cv2.sepFilter2D(wide, cv2.CV_32F, kernel, kernel)[margin:-margin, margin:-margin]
    uniform = ndtr(inner / float((kernel**2).sum()))
    return np.minimum((uniform * (2 * pixels + 1)).astype(np.int64), 2 * pixels) - pixels


def speckled(frame: Frame, percent: int, rng: np.random.Generator) -> Labels:
    """Labels of which ``percent`` of all pixels have another of the picture's labels, or none."""
    values = np.union1d(frame.labels, [0]).astype(np.uint16)
    if len(values) == 1:
        return frame.labels
    wrong = rng.random(frame.labels.shape, np.float32) < percent / 100.0
    # Another one: so many further round in the list of all.
    turns = rng.integers(1, len(values), frame.labels.shape)
    other = values[(np.searchsorted(values, frame.labels) + turns) % len(values)]
    return np.where(wrong, other, frame.labels)
