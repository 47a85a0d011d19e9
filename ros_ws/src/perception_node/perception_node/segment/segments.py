# SPDX-License-Identifier: Apache-2.0
"""Segments: the masks of a picture's blocks, and the interface of what finds them."""

from __future__ import annotations

import functools
from collections.abc import Collection, Iterator
from dataclasses import dataclass
from typing import Final, Protocol

import cv2
import numpy as np
from numpy.typing import NDArray

from perception_node.observation import Observation

from .volume import Volume

Mask = NDArray[np.bool_]

#: Labels with fewer pixels than this part of the image are specks, not blocks.
MIN_AREA: Final = 3e-4

_CRACK: Final = np.ones((3, 3), np.uint8)


@dataclass(frozen=True)
class Segment:
    """The pixels of one block.

    Attributes:
        label: its number in the label image.
        mask: all pixels with that label, shape (height, width).
        part: those of its largest connected part, without detached specks, shape (height, width);
            the same array where there is nothing to leave out.
        outline: points around the part, exact to parts of a pixel, shape (n, 2) [px]; None where
            nothing more exact is known than its pixels.
        over: where a block may stand on it that was not found, column and row [px]; None: nowhere.
    """

    label: int
    mask: Mask
    part: Mask
    outline: NDArray[np.float64] | None = None
    over: tuple[float, ...] | None = None

    @functools.cached_property
    def box(self) -> tuple[int, int, int, int]:
        """Left, top, width and height of the rectangle around the part [px]."""
        left, top, width, height = cv2.boundingRect(self.part.view(np.uint8))
        return left, top, width, height


@dataclass(frozen=True)
class Segments:
    """The N blocks that a segmenter found; iterates over them in the order of their labels.

    Attributes:
        label_image: the label of every pixel, also of specks; 0 = none, shape (height, width).
        blocks: those larger than a speck, labels ascending.
        source: what to check where they are wrong.
        hides: what is no block and hides the places, as far as colour tells, shape (height,
            width); None where the segmenter does not tell.
    """

    label_image: NDArray[np.integer]
    blocks: tuple[Segment, ...]
    source: str = "camera/segmentation"
    hides: Mask | None = None

    @classmethod
    def from_labels(
        cls,
        label_image: NDArray[np.integer],
        source: str = "camera/segmentation",
        hides: Mask | None = None,
    ) -> Segments:
        """The segments of an image of non-negative labels, shape (height, width)."""
        left, top, width, height = cv2.boundingRect((label_image > 0).view(np.uint8))
        # Labels are in a part of the picture only.
        box, blocks = np.s_[top : top + height, left : left + width], []
        counts = np.bincount(label_image[box].ravel(), minlength=1)
        counts[0] = 0
        for label in np.flatnonzero(counts >= max(1.0, MIN_AREA * label_image.size)):
            mask = np.zeros(label_image.shape, bool)
            mask[box] = label_image[box] == label
            blocks.append(Segment(int(label), mask, largest_part(mask)))
        return cls(label_image, tuple(blocks), source, hides)

    def __len__(self) -> int:
        return len(self.blocks)

    def __iter__(self) -> Iterator[Segment]:
        return iter(self.blocks)

    def without(self, left_out: Collection[int]) -> Segments:
        """The others, where some are none of the blocks; these are given by their indices."""
        if not left_out:
            return self
        labels = self.label_image.copy()
        for index in left_out:
            labels[self.blocks[index].mask] = 0
        kept = tuple(item for index, item in enumerate(self.blocks) if index not in left_out)
        return Segments(labels, kept, self.source, self.hides)

    def union(self) -> Mask:
        """Pixels of the largest part of any block, shape (height, width)."""
        together = np.zeros(self.label_image.shape, bool)
        for block in self.blocks:
            together |= block.part
        return together


class Segmenter(Protocol):
    """Whatever finds the blocks of a picture."""

    def __call__(self, observation: Observation, volume: Volume | None, /) -> Segments:
        """The segments of a checked observation, of its image's size.

        Args:
            volume: in which blocks can be; None where the places are unknown.

        Raises:
            PerceptionError: if the observation lacks what this segmenter needs.
        """
        ...


def largest_part(mask: Mask) -> Mask:
    """The mask without detached specks: its largest part, after one-pixel cracks are bridged.

    The same array where there is nothing to leave out.
    """
    left, top, width, height = cv2.boundingRect(mask.view(np.uint8))
    if width == 0:
        return mask
    box = np.s_[top : top + height, left : left + width]
    closed = cv2.morphologyEx(mask[box].astype(np.uint8), cv2.MORPH_CLOSE, _CRACK)
    count, parts, stats, _ = cv2.connectedComponentsWithStats(closed, connectivity=8)
    if count <= 2:
        return mask
    largest = 1 + int(np.argmax(stats[1:, cv2.CC_STAT_AREA]))
    part = np.zeros_like(mask)
    part[box] = mask[box] & (parts == largest)
    return part
