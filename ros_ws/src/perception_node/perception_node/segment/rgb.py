# SPDX-License-Identifier: Apache-2.0
"""Blocks found in colour alone, by a network on the front view of the places."""

from __future__ import annotations

import functools
from typing import TYPE_CHECKING, Final

import cv2
import numpy as np
from numpy.typing import NDArray

from perception_node.errors import BadImageError
from perception_node.observation import Observation

from .front_view import FrontView
from .segments import Segments
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
LEAST: Final = 36
#: A pixel that points further than this beside all middles is of none [px].
ASTRAY: Final = 12.0
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
    labels, hides = find_in_view(view, view.taken(observation.rgb), network())
    size = (observation.rgb.shape[0], observation.rgb.shape[1])
    return Segments.from_labels(
        view.shown(labels, size, nearest=True), SOURCE, view.shown(hides, size, nearest=True) > 0
    )


@functools.cache
def network() -> MaskNetwork:
    """The network with the package's weights, read once; raises WeightsError."""
    from .mask_network import load_weights  # only what learnt needs torch

    return load_weights()


def find_in_view(
    view: FrontView, rgb: NDArray[np.uint8], network: MaskNetwork
) -> tuple[NDArray[np.int32], NDArray[np.uint8]]:
    """Labels of the blocks of a view, and what hides the places without being a block.

    Args:
        rgb: as :meth:`FrontView.taken`, shape (h, w, 3).

    Returns:
        Both of shape (h, w), 0 where nothing is.
    """
    from .mask_network import BEFORE, BLOCK, predict

    classes, middles = predict(network, rgb, view.feet, view.aside, view.steepness)
    kind = classes.argmax(axis=0)
    return instances(kind == BLOCK, classes[BLOCK], middles), (kind == BEFORE).astype(np.uint8)


def instances(block: Mask, share: Floats, middles: Floats) -> NDArray[np.int32]:
    """Which block each pixel belongs to, by the middle that it points at.

    Args:
        block: pixels of blocks, shape (h, w).
        share: their weights, shape (h, w).
        middles: from each pixel, right and down, shape (2, h, w) [px].

    Returns:
        Labels from 1, 0 where no block is, shape (h, w).
    """
    labels = np.zeros(block.shape, np.int32)
    rows, columns = np.nonzero(block)
    if not len(rows):
        return labels
    votes = np.stack([columns, rows]) + middles[:, rows, columns]
    peaks = _peaks(votes, share[rows, columns], block.shape)
    if not len(peaks):
        return labels
    off = np.linalg.norm(votes[:, :, None] - peaks.T[:, None, :], axis=0)
    nearest = off.argmin(axis=1)
    nearest[off.min(axis=1) > ASTRAY] = -1
    counts = np.bincount(nearest + 1, minlength=len(peaks) + 1)[1:]
    kept = np.flatnonzero(counts >= LEAST)
    number = np.zeros(len(peaks) + 1, np.int32)
    number[kept] = np.arange(1, len(kept) + 1)
    labels[rows, columns] = number[nearest]
    return labels


def _peaks(votes: Floats, weights: Floats, shape: tuple[int, ...]) -> Floats:
    """Where most votes are, one for each block, shape (n, 2) [px]."""
    size = (shape[0] // CELL + 1, shape[1] // CELL + 1)
    cells = np.clip(np.round(votes / CELL).astype(int), 0, np.array([size[1], size[0]])[:, None] - 1)
    count = np.bincount(cells[1] * size[1] + cells[0], weights, size[0] * size[1])
    heat = cv2.GaussianBlur(count.reshape(size).astype(np.float32), (0, 0), SPREAD)
    window = cv2.getStructuringElement(cv2.MORPH_ELLIPSE, (2 * APART + 1,) * 2)
    top = (heat == cv2.dilate(heat, window)) & (heat > LEAST / (2.0 * np.pi * (2.0 * SPREAD) ** 2))
    rows, columns = np.nonzero(top)
    return CELL * np.stack([columns, rows], axis=-1).astype(np.float32)
