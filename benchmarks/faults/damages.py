# SPDX-License-Identifier: Apache-2.0
"""Damages to single messages, for :class:`faults.modes.Change`; each changes what it gets."""

from __future__ import annotations

import math
from collections.abc import Callable
from typing import Any

import numpy as np
from numpy.typing import NDArray
from scipy.spatial.transform import Rotation
from tamp_runtime.messages.images import array_from_image, image_from_array
from tamp_runtime.messages.stamps import duration_from_seconds, nanoseconds, stamp_from_nanoseconds

from faults.modes import Damage

Pixels = Callable[[NDArray[Any]], NDArray[Any]]

# Any message with a header


def stamped(shift_seconds: float) -> Damage:
    """Stamps of another clock."""

    def damage(message: Any) -> Any:
        stamp = nanoseconds(message.header.stamp) + round(shift_seconds * 1e9)
        message.header.stamp = stamp_from_nanoseconds(max(stamp, 0))
        return message

    return damage


def with_stamp(nanosecond: int) -> Damage:
    """The same stamp for all."""

    def damage(message: Any) -> Any:
        message.header.stamp = stamp_from_nanoseconds(nanosecond)
        return message

    return damage


def with_wavering_stamps() -> Damage:
    """Stamps that differ by some milliseconds from stream to stream, as of cameras without sync."""
    rng = np.random.default_rng(3)
    return lambda message: stamped(float(rng.uniform(0.001, 0.008)))(message)


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


# joint_trajectory


def cut_short(share: float) -> Damage:
    """Only the first part of a trajectory."""

    def damage(message: Any) -> Any:
        count = max(2, round(share * len(message.points)))
        message.points = message.points[:count]
        return message

    return damage


def stretched(factor: float) -> Damage:
    """A trajectory that takes longer by a factor."""

    def damage(message: Any) -> Any:
        for point in message.points:
            time = factor * 1e-9 * nanoseconds(point.time_from_start)
            point.time_from_start = duration_from_seconds(time)
            point.velocities = [value / factor for value in point.velocities]
        return message

    return damage


def nan_in_the_middle(message: Any) -> Any:
    """A position that is no number."""
    if message.points:
        point = message.points[len(message.points) // 2]
        point.positions = [math.nan, *point.positions[1:]]
    return message


def fingers_kept_at(metres: float) -> Damage:
    """The last two joints stay where they are told here [m]."""

    def damage(message: Any) -> Any:
        for point in message.points:
            point.positions = [*point.positions[:-2], metres, metres]
            point.velocities = [*point.velocities[:-2], 0.0, 0.0]
        return message

    return damage


# joint_states


def positions_nan(message: Any) -> Any:
    """No position is a number."""
    message.position = [math.nan] * len(message.position)
    return message


def without_last_joint(message: Any) -> Any:
    """A driver that leaves a finger out."""
    for name in ("name", "position", "velocity", "effort"):
        setattr(message, name, list(getattr(message, name))[:-1])
    return message


def joints_reversed(message: Any) -> Any:
    """The same joints in another order; nothing is wrong with that."""
    for name in ("name", "position", "velocity", "effort"):
        setattr(message, name, list(getattr(message, name))[::-1])
    return message


def shaken(radians: float) -> Damage:
    """Positions with noise."""
    rng = np.random.default_rng(5)

    def damage(message: Any) -> Any:
        grains = rng.normal(0.0, radians, len(message.position))
        message.position = (np.array(message.position) + grains).tolist()
        return message

    return damage


# motion_status, symbolic_plan, scene_graph, clock


def nonsense_state(message: Any) -> Any:
    """A state that the interface does not know."""
    message.state = 99
    return message


def nonsense_reason(message: Any) -> Any:
    """A reason that the interface does not know."""
    message.reason = 99
    return message


def of_another_plan(message: Any) -> Any:
    """A status that is about a plan of somebody else."""
    message.plan_id = "somebody-elses"
    return message


def moves_from_nowhere(message: Any) -> Any:
    """A plan for stacks that are not there."""
    for move in message.moves:
        move.source = 9
    return message


def blocks_unheard_of(message: Any) -> Any:
    """A plan for blocks that are not in its scene."""
    for move in message.moves:
        move.object_name = "golden_box"
    return message


def poses_off(metres: float) -> Damage:
    """A plan whose scene has every block beside itself."""

    def damage(message: Any) -> Any:
        for item in message.initial.objects:
            item.pose.position.y += metres
        return message

    return damage


def clock_shifted(seconds: float) -> Damage:
    """A clock that jumped."""

    def damage(message: Any) -> Any:
        shifted = nanoseconds(message.clock) + round(seconds * 1e9)
        message.clock = stamp_from_nanoseconds(max(shifted, 0))
        return message

    return damage
