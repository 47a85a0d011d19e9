# SPDX-License-Identifier: Apache-2.0
"""Blocks found in colour alone, by a network on the front view of the places."""

from __future__ import annotations

import functools
from dataclasses import dataclass, replace
from typing import TYPE_CHECKING, Final

import cv2
import numpy as np
from numpy.typing import NDArray

from perception_node.errors import BadImageError
from perception_node.masks import pixels_of
from perception_node.observation import Observation

from .background import stands_behind
from .front_view import FrontView
from .missed import may_be_missed, missed_sentence
from .segments import Segment, Segments, largest_part
from .volume import Volume

if TYPE_CHECKING:
    from .mask_network import MaskNetwork

Mask = NDArray[np.bool_]
Floats = NDArray[np.float32]

#: Edge of the cells in which pixels vote for the middles of their blocks [px].
CELL: Final = 2
#: Votes are smoothed by this, and two middles are no nearer to each other [cells].
SPREAD: Final = 1.3
APART: Final = 3
#: A block has at least so many pixels of the view: of one of 2.5 cm a quarter is seen.
LEAST: Final = 50
#: A pixel that points further than this beside all middles is of none [px].
ASTRAY: Final = 12.0
#: The least surety of a block is about 0.84, and it fills this part of its convex outline.
UNSURE: Final = 0.65
RAGGED: Final = 0.8
UNLIKELY: Final = 0.4
#: The upper and the lower part of a block's front, below its top, as parts of its pixels, and by
#: how much the channels' shares of their colours differ at most.
PARTS: Final = ((0.33, 0.48), (0.75, 1.0))
OTHER_HUE: Final = 0.08
SOURCE: Final = "what was found in camera/image_raw"


def find_in_rgb(observation: Observation, volume: Volume | None = None) -> Segments:
    """The blocks that colour shows over the places.

    Raises:
        BadImageError: if camera or places are unknown, or not seen from the front.
        WeightsError: if the network's weights cannot be read.
    """
    if observation.camera is None:
        raise BadImageError(
            "masks from colour alone need the camera's calibration; publish camera/camera_info and "
            "camera/extrinsics"
        )
    if volume is None:
        raise BadImageError(
            "masks from colour alone need to know where the places are; set stack_positions"
        )
    view = FrontView.of(observation.camera, volume)
    found = find_in_view(view, view.taken(observation.rgb), network())
    size = (observation.rgb.shape[0], observation.rgb.shape[1])
    labels = np.zeros(size, np.uint8)
    best = np.zeros(size, np.float32)
    for label, field in enumerate(found.fields, start=1):
        box, values = view.shown_part(field.values, field.box, size)
        larger = values > best[box]
        labels[box][larger] = label
        best[box][larger] = values[larger]
    hides = view.shown(found.hides.astype(np.uint8), size, nearest=True) > 0
    segments = Segments.from_labels(labels, SOURCE, hides)
    for item in segments:
        _check_one_color(observation.rgb, item)
    over = {
        index + 1: tuple(map(float, view.in_picture(np.array([pixel], np.float64))[0]))
        for index, pixel in found.missed.items()
    }
    if lost := over.keys() - {item.label for item in segments}:
        raise BadImageError(missed_sentence(*over[min(lost)]))
    blocks = tuple(
        replace(
            item,
            outline=view.in_picture(found.fields[item.label - 1].edge()),
            over=over.get(item.label),
        )
        for item in segments
    )
    return replace(segments, blocks=blocks)


def _check_one_color(rgb: NDArray[np.uint8], segment: Segment) -> None:
    """Raises BadImageError if the upper and the lower part of a front have other hues.

    The top of a block is lit by another light than its front, and may have a hue of its own.
    """
    rows, columns = pixels_of(segment.part)
    hues = []
    for first, last in np.quantile(rows, PARTS):
        part = (rows >= first) & (rows <= last)
        values = rgb[rows[part], columns[part]].astype(np.float64) + 1.0
        hues.append(np.median(values / values.sum(axis=1, keepdims=True), axis=0))
    if np.abs(hues[0] - hues[1]).max() > OTHER_HUE:
        raise BadImageError(
            f"what is seen at pixel ({np.median(columns):.0f}, {np.median(rows):.0f}) has one "
            "colour above and another one below, so it may be two blocks; give more light, or set "
            "mask_source to rgbd"
        )


@functools.cache
def network() -> MaskNetwork:
    """The network with the package's weights, read once; raises WeightsError."""
    from .mask_network import load_weights  # only what learnt needs torch

    return load_weights()


@dataclass(frozen=True, eq=False)
class Field:
    """How sure it is that pixels of a part of a view are of one block: positive where they are.

    Attributes:
        values: -1..1, shape of the box.
        box: rows and columns of the part.
        surety: that its pixels are of a block at all, their mean, -1..1.
    """

    values: Floats
    box: tuple[slice, slice]
    surety: float

    @property
    def is_vague(self) -> bool:
        """Whether it is hardly likely, and ragged, as no block is."""
        inside = self.values > 0.0
        if not inside.any():
            return True
        points = cv2.findNonZero(inside.astype(np.uint8))
        around = cv2.contourArea(cv2.convexHull(points)) + 1.0
        unsure = self.surety < UNSURE
        return bool(unsure and len(points) < RAGGED * around) or self.surety < UNLIKELY

    def mask(self, shape: tuple[int, ...]) -> Mask:
        """Its pixels in the view, whose height and width are given."""
        mask = np.zeros(shape, bool)
        mask[self.box] = self.values > 0.0
        return mask

    def edge(self) -> NDArray[np.float64]:
        """Where it is zero around its largest part, exact to parts of a pixel, (n, 2) [px]."""
        inside = self.values > 0.0
        part = cv2.dilate(largest_part(inside).astype(np.uint8), np.ones((3, 3), np.uint8)) > 0
        values = np.where(part, self.values, -1.0)
        points = []
        for axis in (0, 1):
            here = (slice(None),) * axis + (slice(None, -1),)
            next_one = (slice(None),) * axis + (slice(1, None),)
            crossing = (values[here] > 0.0) != (values[next_one] > 0.0)
            rows, columns = pixels_of(crossing)
            share = values[here][crossing] / (values[here][crossing] - values[next_one][crossing])
            along = np.stack([columns, rows], axis=-1).astype(np.float64)
            along[:, 1 - axis] += share
            points.append(along)
        return np.concatenate(points) + [self.box[1].start, self.box[0].start]


@dataclass(frozen=True)
class FoundInView:
    """What was found in a view.

    Attributes:
        fields: one for each block.
        hides: the places, and is no block, shape (h, w).
        missed: where blocks may be that were not found, column and row, by the index of the field
            right below.
    """

    fields: tuple[Field, ...]
    hides: Mask
    missed: dict[int, tuple[int, int]]


def find_in_view(view: FrontView, rgb: NDArray[np.uint8], network: MaskNetwork) -> FoundInView:
    """The blocks of a view, and what hides the places without being a block.

    Args:
        rgb: as :meth:`FrontView.taken`, shape (h, w, 3).
    """
    from .mask_network import BEFORE, BLOCK, predict

    classes, middles = predict(network, rgb, view.feet, view.aside, view.steepness)
    surety = classes[BLOCK] - np.maximum(*np.delete(classes, BLOCK, axis=0))
    found = instances(surety, middles)
    masks = {field: field.mask(surety.shape) for field in found}
    clear = [field for field in found if not field.is_vague]
    behind = stands_behind([masks[field] for field in clear], view, rgb, surety)
    blocks = tuple(field for field, away in zip(clear, behind) if not away)
    missed = may_be_missed(
        [masks[field] for field in blocks],
        [masks[field] for field in found if field not in clear],
        [masks[field] for field, away in zip(clear, behind) if away],
        classes[BLOCK],
    )
    return FoundInView(blocks, classes.argmax(axis=0) == BEFORE, missed)


def instances(surety: Floats, middles: Floats) -> tuple[Field, ...]:
    """Which block each pixel belongs to, by the middle that it points at.

    Args:
        surety: that a pixel is of a block rather than of anything else, -1..1, shape (h, w).
        middles: from each pixel, right and down, shape (2, h, w) [px].
    """
    rows, columns = pixels_of(surety > 0.0)
    if not len(rows):
        return ()
    votes = np.stack([columns, rows]) + middles[:, rows, columns]
    peaks = _peaks(votes, surety[rows, columns], surety.shape)
    if not len(peaks):
        return ()
    off = np.linalg.norm(votes[:, :, None] - peaks.T[:, None, :], axis=0)
    nearest = np.where(off.min(axis=1) > ASTRAY, -1, off.argmin(axis=1))
    kept = [index for index in range(len(peaks)) if np.count_nonzero(nearest == index) >= LEAST]
    return tuple(
        _field(surety, middles, peaks[kept], index, columns[nearest == peak], rows[nearest == peak])
        for index, peak in enumerate(kept)
    )


def _field(
    surety: Floats,
    middles: Floats,
    peaks: Floats,
    index: int,
    columns: NDArray[np.intp],
    rows: NDArray[np.intp],
) -> Field:
    """Of one of n blocks, around its own pixels.

    Args:
        peaks: middles of all blocks, shape (n, 2) [px].
    """
    height, width = surety.shape
    box = (
        slice(max(0, int(rows.min()) - 2), min(height, int(rows.max()) + 3)),
        slice(max(0, int(columns.min()) - 2), min(width, int(columns.max()) + 3)),
    )
    down, across = np.mgrid[box].astype(np.float32)
    votes = np.stack([across, down], -1) + middles[:, box[0], box[1]].transpose(1, 2, 0)
    off = np.linalg.norm(votes[:, :, None] - peaks, axis=-1)
    own = off[..., index]
    others = np.delete(off, index, axis=-1).min(axis=-1, initial=2.0 * ASTRAY)
    values = np.minimum(surety[box], np.minimum(others - own, ASTRAY - own) / ASTRAY)
    sure = float(surety[box][values > 0.0].mean()) if (values > 0.0).any() else -1.0
    return Field(np.ascontiguousarray(values, dtype=np.float32), box, sure)


def _peaks(votes: Floats, weights: Floats, shape: tuple[int, ...]) -> Floats:
    """Where most votes are, one for each block, shape (n, 2) [px]."""
    size = (shape[0] // CELL + 1, shape[1] // CELL + 1)
    cells = np.clip(
        np.round(votes / CELL).astype(int), 0, np.array([size[1], size[0]])[:, None] - 1
    )
    count = np.bincount(cells[1] * size[1] + cells[0], weights, size[0] * size[1])
    heat = cv2.GaussianBlur(count.reshape(size).astype(np.float32), (0, 0), SPREAD)
    window = cv2.getStructuringElement(cv2.MORPH_ELLIPSE, (2 * APART + 1,) * 2)
    top = (heat == cv2.dilate(heat, window)) & (heat > LEAST / (2.0 * np.pi * (2.0 * SPREAD) ** 2))
    rows, columns = pixels_of(top)
    return CELL * np.stack([columns, rows], axis=-1).astype(np.float32)
