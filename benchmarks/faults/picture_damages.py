# SPDX-License-Identifier: Apache-2.0
"""Damages to what a camera, a detector and a calibration say; each changes what it gets."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

import numpy as np
from numpy.typing import NDArray
from scipy.spatial.transform import Rotation
from tamp_runtime.messages.images import array_from_image, image_from_array

from faults.modes import Damage

Pixels = Callable[[NDArray[Any]], NDArray[Any]]

# Images


def pixels(change: Pixels) -> Damage:
    """Other pixels; encoding and size stay."""

    def damage(message: Any) -> Any:
        encoding = message.encoding
        image = np.array(array_from_image(message, encoding))
        return image_from_array(np.asarray(change(image), image.dtype), encoding, message.header)

    return damage


def black(image: NDArray[Any]) -> NDArray[Any]:
    """Nothing but zeros."""
    return np.zeros_like(image)


def white(image: NDArray[Any]) -> NDArray[Any]:
    """Overexposed."""
    return np.full_like(image, 255)


def noise(image: NDArray[Any]) -> NDArray[Any]:
    """Nothing but noise."""
    return np.random.default_rng(0).integers(0, 256, image.shape).astype(image.dtype)


def grainy(image: NDArray[Any]) -> NDArray[Any]:
    """Noise of 20 grey levels."""
    grains = np.random.default_rng(1).normal(0.0, 20.0, image.shape)
    return np.clip(image + grains, 0, 255)


def red_and_blue_exchanged(image: NDArray[Any]) -> NDArray[Any]:
    """bgr8 that is called rgb8."""
    return image[..., ::-1]


def millimetres(depth: NDArray[Any]) -> NDArray[Any]:
    """Depth in millimetres that should be metres."""
    return depth * 1000.0


def nothing_but_nan(depth: NDArray[Any]) -> NDArray[Any]:
    """Depth without a single value."""
    return np.full_like(depth, np.nan)


def holes(depth: NDArray[Any]) -> NDArray[Any]:
    """Three of ten pixels without depth."""
    lost = np.random.default_rng(2).random(depth.shape) < 0.3
    return np.where(lost, np.nan, depth)


def nearer(metres: float) -> Pixels:
    """A depth camera with an offset."""
    return lambda depth: np.where(depth > 0, depth - metres, depth)


def mirrored(image: NDArray[Any]) -> NDArray[Any]:
    """Left and right exchanged."""
    return image[:, ::-1]


def labels_shuffled(labels: NDArray[Any]) -> NDArray[Any]:
    """Other numbers for the same blocks; nothing is wrong with that."""
    top = int(labels.max()) + 1
    return np.where(labels > 0, top - labels.astype(int), 0)


def labels_scattered(labels: NDArray[Any]) -> NDArray[Any]:
    """Every pixel of a block gets the label of some block."""
    known = np.unique(labels[labels > 0])
    if not len(known):
        return labels
    scattered = np.random.default_rng(4).choice(known, labels.shape)
    return np.where(labels > 0, scattered, 0)


def labels_merged(labels: NDArray[Any]) -> NDArray[Any]:
    """One label for all blocks."""
    return (labels > 0).astype(labels.dtype)


def lost_label(labels: NDArray[Any]) -> NDArray[Any]:
    """The detector overlooks one block."""
    known = np.unique(labels[labels > 0])
    return np.where(labels == known[-1], 0, labels) if len(known) else labels


def covered(value: float) -> Pixels:
    """Something stands in front of the left half of the picture."""

    def change(image: NDArray[Any]) -> NDArray[Any]:
        image[:, : image.shape[1] // 2] = value
        return image

    return change


def of_size(side: int) -> Damage:
    """An image of another size, cut from the middle."""

    def damage(message: Any) -> Any:
        image = array_from_image(message, message.encoding)
        top, left = (image.shape[0] - side) // 2, (image.shape[1] - side) // 2
        cut = image[top : top + side, left : left + side]
        return image_from_array(cut, message.encoding, message.header)

    return damage


def of_encoding(encoding: str) -> Damage:
    """An image that is called something else."""

    def damage(message: Any) -> Any:
        message.encoding = encoding
        return message

    return damage


def cut_off(message: Any) -> Any:
    """An image of which the last part is lost."""
    message.data = message.data[: len(message.data) // 2]
    return message


def without_intrinsics(message: Any) -> Any:
    """An uncalibrated camera."""
    message.k = [0.0] * 9
    return message


def distorted(message: Any) -> Any:
    """An image that was not rectified."""
    message.d = [0.1, -0.2, 0.0, 0.0, 0.0]
    return message


# camera/extrinsics


def moved_by(x: float = 0.0, y: float = 0.0, z: float = 0.0) -> Damage:
    """A calibration that is off by some centimetres [m]."""

    def damage(message: Any) -> Any:
        shift = message.transform.translation
        shift.x, shift.y, shift.z = shift.x + x, shift.y + y, shift.z + z
        return message

    return damage


def turned_by(degrees: float) -> Damage:
    """A calibration that is off by a turn about the vertical axis."""

    def damage(message: Any) -> Any:
        old = message.transform.rotation
        turn = Rotation.from_euler("z", degrees, degrees=True)
        new = turn * Rotation.from_quat([old.x, old.y, old.z, old.w])
        old.x, old.y, old.z, old.w = new.as_quat().tolist()
        return message

    return damage


def no_rotation(message: Any) -> Any:
    """A quaternion of zeros."""
    rotation = message.transform.rotation
    rotation.x = rotation.y = rotation.z = rotation.w = 0.0
    return message
