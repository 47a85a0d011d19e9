# SPDX-License-Identifier: Apache-2.0
"""What may be wrong with pictures beyond what a sensor's errors are: none of it was tuned for."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, replace
from typing import Final

import numpy as np
from numpy.typing import NDArray

from perception_node import Observation
from sim_node import Frame


@dataclass(frozen=True)
class Shot:
    """What a damage may look at beside the picture.

    Attributes:
        labels: the exact ones, shape (height, width).
        earlier: takes a picture of the same table in another state.
        rng: what it draws from.
    """

    labels: NDArray[np.uint16]
    earlier: Callable[[], Frame]
    rng: np.random.Generator


Damage = Callable[[Observation, Shot], Observation]


def no_depth(seen: Observation, _: Shot) -> Observation:
    """Only colour and masks."""
    return replace(seen, depth=None)


def black(seen: Observation, _: Shot) -> Observation:
    return replace(seen, rgb=0 * seen.rgb)


def white(seen: Observation, _: Shot) -> Observation:
    return replace(seen, rgb=0 * seen.rgb + np.uint8(255))


def one_color(seen: Observation, shot: Shot) -> Observation:
    """Every pixel alike."""
    return replace(seen, rgb=0 * seen.rgb + shot.rng.integers(0, 256, 3).astype(np.uint8))


def mirrored(seen: Observation, _: Shot) -> Observation:
    """All pictures, against their calibration."""
    return _everywhere(seen, lambda picture: picture[:, ::-1])


def upside_down(seen: Observation, _: Shot) -> Observation:
    """A camera that was mounted so, without a word of its calibration."""
    return _everywhere(seen, lambda picture: picture[::-1, ::-1])


def half_lost(seen: Observation, shot: Shot) -> Observation:
    """Of all pictures the left, right, upper or lower half is black and without depth."""
    half = _half(seen.rgb.shape[:2], shot.rng)
    depth = None if seen.depth is None else np.where(half, 0.0, seen.depth)
    labels = None if seen.labels is None else np.where(half, 0, seen.labels)
    return replace(seen, rgb=np.where(half[..., None], 0, seen.rgb), depth=depth, labels=labels)


def half_of_depth_lost(seen: Observation, shot: Shot) -> Observation:
    half = _half(seen.rgb.shape[:2], shot.rng)
    return replace(seen, depth=None if seen.depth is None else np.where(half, np.nan, seen.depth))


def channels_exchanged(seen: Observation, _: Shot) -> Observation:
    """bgr8 that is called rgb8."""
    return replace(seen, rgb=np.ascontiguousarray(seen.rgb[..., ::-1]))


def label_missing(seen: Observation, shot: Shot) -> Observation:
    """One block has none."""
    assert seen.labels is not None
    return replace(seen, labels=np.where(_one_block(shot), 0, seen.labels))


def block_without_depth(seen: Observation, shot: Shot) -> Observation:
    """One block, as where it is black or shines."""
    unknown = shot.rng.choice([0.0, np.nan])
    depth = None if seen.depth is None else np.where(_one_block(shot), unknown, seen.depth)
    return replace(seen, depth=depth)


def block_gone_from_both(seen: Observation, shot: Shot) -> Observation:
    """One block has neither label nor depth."""
    gone = _one_block(shot)
    depth = None if seen.depth is None else np.where(gone, np.nan, seen.depth)
    labels = None if seen.labels is None else np.where(gone, 0, seen.labels)
    return replace(seen, depth=depth, labels=labels)


def half_hidden(seen: Observation, shot: Shot) -> Observation:
    """The label of one block covers its left, right, upper or lower half only."""
    assert seen.labels is not None
    block = _one_block(shot)
    rows, columns = np.nonzero(block)
    along = (rows, columns)[int(shot.rng.integers(2))]
    side = along > np.median(along) if shot.rng.integers(2) else along < np.median(along)
    labels = seen.labels.copy()
    labels[rows[side], columns[side]] = 0
    return replace(seen, labels=labels)


def depth_frozen(seen: Observation, shot: Shot) -> Observation:
    """Depth of an earlier state of the table, colours of now."""
    return replace(seen, depth=shot.earlier().depth)


def color_frozen(seen: Observation, shot: Shot) -> Observation:
    return replace(seen, rgb=shot.earlier().rgb)


def labels_frozen(seen: Observation, shot: Shot) -> Observation:
    return replace(seen, labels=shot.earlier().labels)


#: Of all pictures; by the name of their set and what is said of them.
OF_PICTURES: Final[dict[str, tuple[str, Damage]]] = {
    "black": ("black picture", black),
    "white": ("white picture", white),
    "one_color": ("picture of one colour", one_color),
    "mirrored": ("all pictures mirrored", mirrored),
    "upside_down": ("camera upside down, its calibration not", upside_down),
    "half_lost": ("half of all pictures lost", half_lost),
    "half_depth_lost": ("half of depth lost", half_of_depth_lost),
    "channels_exchanged": ("red and blue exchanged", channels_exchanged),
    "block_without_depth": ("one block without depth", block_without_depth),
    "depth_frozen": ("depth frozen, colours not", depth_frozen),
    "color_frozen": ("colours frozen, depth not", color_frozen),
}
#: Of the labels that come with them.
OF_LABELS: Final[dict[str, tuple[str, Damage]]] = {
    "label_missing": ("given masks, one missing", label_missing),
    "block_gone": ("given masks, one missing and its depth as well", block_gone_from_both),
    "labels_frozen": ("given masks frozen, the rest not", labels_frozen),
}


def _everywhere(seen: Observation, change: Callable[[NDArray], NDArray]) -> Observation:
    labels, depth = (
        None if picture is None else np.ascontiguousarray(change(picture))
        for picture in (seen.labels, seen.depth)
    )
    return replace(seen, rgb=np.ascontiguousarray(change(seen.rgb)), labels=labels, depth=depth)


def _half(shape: tuple[int, ...], rng: np.random.Generator) -> NDArray[np.bool_]:
    half = np.zeros(shape, bool)
    axis, end = rng.integers(2, size=2)
    middle = shape[axis] // 2
    half[(slice(None),) * axis + (slice(middle, None) if end else slice(None, middle),)] = True
    return half


def _one_block(shot: Shot) -> NDArray[np.bool_]:
    """The pixels of a block that is seen."""
    return np.asarray(shot.labels == shot.rng.choice(np.unique(shot.labels[shot.labels > 0])))
