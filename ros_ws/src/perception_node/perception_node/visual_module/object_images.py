# SPDX-License-Identifier: Apache-2.0
"""From scene image and segments to one image per object: u_i and u_i^def (5.2.1, A.2.6)."""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import Any, Final

import cv2
import numpy as np
from numpy.typing import NDArray

from perception_node.segment import Segments

#: Side of the square images that the visual module works on [px] (5.2.1).
IMAGE_SIZE: Final = 128
#: How long the longer side of an object is in its view [px].
BLOCK_SIDE: Final = 16
Mask = NDArray[np.bool_]


@dataclass(frozen=True)
class ObjectImages:
    """What the visual module sees of the N objects of one scene.

    Attributes:
        images: u_i, the scene with everything outside the object's mask zeroed, float32 in 0..1,
            shape (N, 3, size, size).
        coverage: how much of each pixel is the object, float32 in 0..1, shape (N, size, size).
        default_images: u_i^def, the object's own pixels at the bottom-left corner, as ``images``.
        default_coverage: the same for ``coverage``.
        crop_sizes: width and height of the object in ``default_images``, shape (N, 2) [px].
        origins: bottom-left corners of the images in the scene's picture, as parts of its longer
            side from its own bottom-left corner, shape (N, 2).
        sides: how long the images' sides are there, as parts of that side, shape (N,).
    """

    images: NDArray[np.float32]
    coverage: NDArray[np.float32]
    default_images: NDArray[np.float32]
    default_coverage: NDArray[np.float32]
    crop_sizes: NDArray[np.intp]
    origins: NDArray[np.float64]
    sides: NDArray[np.float64]

    def __len__(self) -> int:
        return len(self.images)

    def in_scene(self, points: NDArray[np.float64]) -> NDArray[np.float64]:
        """Points of the N images, parts of their side, as parts of the scene's longer side, (N, 2).

        Both from the bottom-left corner, (right, up).
        """
        return self.origins + points * self.sides[:, None]


def object_images(
    rgb: NDArray[np.uint8], segments: Segments, size: int = IMAGE_SIZE
) -> ObjectImages:
    """Splits a scene image into N images with one object each, in the order of the segments.

    The scene is scaled to fit a square of ``size``, in its bottom-left corner: the origin of φ.
    The default crop holds the largest connected part of the mask only.

    Args:
        rgb: shape (height, width, 3).
        segments: the objects' masks, shape (height, width).
        size: side of the images [px].
    """
    count = len(segments)
    source, target = _block_sides(max(rgb.shape[:2]), size)
    rgb = _whole_blocks(rgb, source)
    images = np.zeros((count, 3, size, size), np.float32)
    coverage = np.zeros((count, size, size), np.float32)
    default_images = np.zeros(images.shape, np.float32)
    default_coverage = np.zeros(coverage.shape, np.float32)
    crop_sizes = np.zeros((count, 2), np.intp)
    for index, segment in enumerate(segments):
        mask = _whole_blocks(segment.mask, source)
        top, bottom = _block_range(np.any(mask, axis=1), source)
        left, right = _block_range(np.any(mask, axis=0), source)
        crop = np.s_[top * source : bottom * source, left * source : right * source]
        scaled_size = ((right - left) * target, (bottom - top) * target)
        image, part = _scaled(rgb[crop], mask[crop], scaled_size)
        # Rows count from the lower edge, the origin of φ.
        low = size - (len(rgb) // source - bottom) * target
        box = np.s_[low - scaled_size[1] : low, left * target : left * target + scaled_size[0]]
        images[(index, slice(None), *box)], coverage[index][box] = image.transpose(2, 0, 1), part
        if segment.part is not segment.mask:
            image, part = _scaled(rgb[crop], _whole_blocks(segment.part, source)[crop], scaled_size)
        rows, columns = np.flatnonzero(part.any(1)), np.flatnonzero(part.any(0))
        width, height = columns[-1] - columns[0] + 1, rows[-1] - rows[0] + 1
        tight = np.s_[rows[0] : rows[-1] + 1, columns[0] : columns[-1] + 1]
        default_images[index, :, size - height :, :width] = image[tight].transpose(2, 0, 1)
        default_coverage[index, size - height :, :width] = part[tight]
        crop_sizes[index] = width, height
    return ObjectImages(
        images=images,
        coverage=coverage,
        default_images=default_images,
        default_coverage=default_coverage,
        crop_sizes=crop_sizes,
        origins=np.zeros((count, 2)),
        sides=np.ones(count),
    )


def object_views(
    rgb: NDArray[np.uint8], segments: Segments, size: int = IMAGE_SIZE, block: int = BLOCK_SIDE
) -> ObjectImages:
    """One image per object, in which it is as large as any other: G's input, free of scale.

    A window of the scene is scaled so that the object's longer side fills ``block`` pixels. Windows
    lie on a grid of a quarter of their side, so the object is somewhere in the middle of it.

    Args:
        rgb: shape (height, width, 3).
        segments: the objects' masks, shape (height, width).
        size: side of the images [px].
    """
    count, longer = len(segments), max(rgb.shape[:2])
    images = np.zeros((count, 3, size, size), np.float32)
    coverage = np.zeros((count, size, size), np.float32)
    default_images = np.zeros(images.shape, np.float32)
    default_coverage = np.zeros(coverage.shape, np.float32)
    crop_sizes, origins = np.zeros((count, 2), np.intp), np.zeros((count, 2))
    sides = np.zeros(count)
    for index, segment in enumerate(segments):
        left, top, width, height = segment.box
        side = max(4, round(max(width, height) * size / block))
        step = max(1, side // 4)
        first = tuple(
            (begin + extent // 2 - side // 2) // step * step
            for begin, extent in ((left, width), (top, height))
        )
        # Scaled is what there is of it in the window, in whole blocks.
        source, target = _block_sides(side, size)
        if segment.part is not segment.mask:
            left, top, width, height = cv2.boundingRect(segment.mask.view(np.uint8))
        columns, rows = (
            np.clip((begin // source, -(-end // source)), 0, side // source)
            for begin, end in (
                (left - first[0], left + width - first[0]),
                (top - first[1], top + height - first[1]),
            )
        )
        begin = (first[0] + source * columns[0], first[1] + source * rows[0])
        blocks = (int(columns[1] - columns[0]), int(rows[1] - rows[0]))
        shape, scaled_size = tuple(
            (unit * blocks[0], unit * blocks[1]) for unit in (source, target)
        )
        window, own = _window(rgb, begin, shape), _window(segment.mask, begin, shape)
        image, part = _scaled(window, own, scaled_size)
        box = np.s_[target * rows[0] : target * rows[1], target * columns[0] : target * columns[1]]
        images[(index, slice(None), *box)], coverage[index][box] = image.transpose(2, 0, 1), part
        if segment.part is not segment.mask:
            image, part = _scaled(window, _window(segment.part, begin, shape), scaled_size)
        rows, columns = np.flatnonzero(part.any(1)), np.flatnonzero(part.any(0))
        tight = np.s_[rows[0] : rows[-1] + 1, columns[0] : columns[-1] + 1]
        high, wide = part[tight].shape
        default_images[index, :, size - high :, :wide] = image[tight].transpose(2, 0, 1)
        default_coverage[index, size - high :, :wide] = part[tight]
        crop_sizes[index] = wide, high
        origins[index] = first[0] / longer, (rgb.shape[0] - first[1] - side) / longer
        sides[index] = side / longer
    return ObjectImages(
        images, coverage, default_images, default_coverage, crop_sizes, origins, sides
    )


def _window(image: NDArray[Any], first: tuple[int, ...], shape: tuple[int, ...]) -> NDArray[Any]:
    """A part of an image, so wide and high, from the pixel (column, row) on; zero beyond it."""
    width, height = shape
    out = np.zeros((height, width, *image.shape[2:]), image.dtype)
    left, top = max(first[0], 0), max(first[1], 0)
    part = image[top : max(first[1] + height, 0), left : max(first[0] + width, 0)]
    row, column = top - first[1], left - first[0]
    out[row : row + part.shape[0], column : column + part.shape[1]] = part
    return out


def _block_sides(longer: int, size: int) -> tuple[int, int]:
    """Sides of a block before and after scaling [px].

    Scaling a side, ``longer``, to ``size`` turns each block of ``source`` pixels into ``target``
    pixels, so parts of the image along block borders can be scaled on their own.

    Returns:
        source, target.
    """
    common = math.gcd(longer, size)
    return longer // common, size // common


def _whole_blocks(image: NDArray[Any], source: int) -> NDArray[Any]:
    """The image padded with zeros, above and right, to whole blocks; itself if it has them."""
    above, right = -image.shape[0] % source, -image.shape[1] % source
    if not (above or right):
        return image
    return np.pad(image, ((above, 0), (0, right), *((0, 0),) * (image.ndim - 2)))


def _block_range(used: Mask, source: int) -> tuple[int, int]:
    """First block with a pixel of the object, and the one after the last."""
    pixels = np.flatnonzero(used)
    return int(pixels[0]) // source, int(pixels[-1]) // source + 1


def _scaled(
    rgb: NDArray[np.uint8], mask: Mask, size: tuple[int, int]
) -> tuple[NDArray[np.float32], NDArray[np.float32]]:
    """Masked image and coverage in 0..1, scaled by area to (width, height)."""
    masked = cv2.bitwise_and(rgb, rgb, mask=mask.astype(np.uint8)).astype(np.float32)
    image = cv2.resize(masked, size, interpolation=cv2.INTER_AREA)
    part = cv2.resize(mask.astype(np.float32), size, interpolation=cv2.INTER_AREA)
    return np.divide(image, 255.0, dtype=np.float32), part.astype(np.float32, copy=False)
