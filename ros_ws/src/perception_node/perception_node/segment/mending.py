# SPDX-License-Identifier: Apache-2.0
"""Masks made those of whole blocks by colour alone, where there is no depth (goal images).

A block has one colour, brighter and darker on its faces, and blocks of a scene are seen about
equally large. So scattered labels are those of what surrounds them, two labels of one colour that
together are as large as one block are one, and a mask of two colours is cut where they meet.
"""

from __future__ import annotations

import itertools
from typing import Final, NamedTuple

import cv2
import numpy as np
from numpy.typing import NDArray

from perception_node.clustering import cluster_on_line
from perception_node.errors import BadImageError
from perception_node.masks import pixels_of

from .segments import MIN_AREA

Labels = NDArray[np.integer]
Mask = NDArray[np.bool_]
Array = NDArray[np.float64]

#: Masks with no more than this between them touch [px].
_TOUCHING: Final = 2
#: A block is less than this times as high, and as wide, as the others.
_ONE_BLOCK: Final = 1.42
#: and more than this; what is less high or wide than this part of the others is a piece of one.
_PIECE: Final = 0.6
#: A colour is the shares of its channels in their sum, and this times its natural logarithm: faces
#: of one block differ by less than half of it, black and grey by more than twice as much.
_LIGHT: Final = 0.05
#: Of one colour are faces that differ by less than this, and by this more for dark ones [1/255],
_SAME: Final = 0.03
_DARK: Final = 2.0
#: of two colours by more than this.
_TWO: Final = 0.06
#: Part of a mask that has another colour, where it is of two blocks.
_SHARE: Final = 0.15
#: Percentages of its pixels between which both colours are.
_RANGE: Final = (10, 90)
#: Of a mask so many pixels at the rim are mixtures, and about so many others are looked at.
_RIM: Final = 1
_PIXELS: Final = 300


class _Look(NamedTuple):
    """How a mask looks: its colour, and how high and wide it is [px]."""

    color: Array
    height: int
    width: int
    dark: float


def mended(labels: Labels, rgb: NDArray[np.uint8]) -> Labels:
    """The labels with those errors undone that colours tell; the same array where there are none.

    Args:
        labels: 0 = none, shape (height, width).
        rgb: shape (height, width, 3).

    Raises:
        BadImageError: if a mask is of two blocks, or two masks are of one, and it is not clear how.
    """
    labels = without_specks(labels)
    return _joined(_cut(labels, rgb), rgb)


def without_specks(labels: Labels) -> Labels:
    """Parts of masks, and of what has no label, that are too small for a block, made what most of
    their neighbours are."""
    values = np.unique(labels)
    least = MIN_AREA * labels.size
    speck = np.zeros(labels.shape, bool)
    for value in values:
        _, parts, stats, _ = cv2.connectedComponentsWithStats(
            (labels == value).astype(np.uint8), connectivity=4
        )
        small = stats[:, cv2.CC_STAT_AREA] < least
        small[0] = False
        if small.any():
            speck |= small[parts]
    if not speck.any() or speck.all():
        return labels
    out = labels.copy()
    while speck.any():
        rows, columns = pixels_of(speck)
        most = np.zeros(len(rows), np.float32)
        for value in values:
            around = cv2.boxFilter(
                ((out == value) & ~speck).astype(np.float32), -1, (3, 3), normalize=False
            )[rows, columns]
            better = around > most
            out[rows[better], columns[better]] = value
            most = np.maximum(most, around)
        speck[rows[most > 0.0], columns[most > 0.0]] = False
    return out


def _cut(labels: Labels, rgb: NDArray[np.uint8]) -> Labels:
    """Masks of two colours, each of them as large as a block, are two."""
    out = labels
    for value in _present(labels):
        mask = labels == value
        second = _second_color(mask, rgb)
        if second is None:
            continue
        others = [_look(labels == other, rgb) for other in _present(labels) if other != value]
        sizes = [_look(part, rgb) for part in (mask & ~second, second)]
        if _is_one(_look(mask, rgb), others) or any(_is_piece(size, others) for size in sizes):
            continue  # a lid that mirrors the room: what colours say of it is looked at later
        out = out.copy() if out is labels else out
        out[second] = int(out.max()) + 1
    return out


def _joined(labels: Labels, rgb: NDArray[np.uint8]) -> Labels:
    """Masks of one colour that touch and together are as large as one block are one."""
    values = _present(labels)
    looks = {value: _look(labels == value, rgb) for value in values}
    window = np.ones((2 * _TOUCHING + 1,) * 2, np.uint8)
    out = labels
    for first, second in itertools.combinations(values, 2):
        if not _same_color(looks[first], looks[second]):
            continue
        one, two = labels == first, labels == second
        if not (cv2.dilate(one.view(np.uint8), window).astype(bool) & two).any():
            continue
        both = _look(one | two, rgb)
        pair = [looks[first], looks[second]]
        others = [looks[value] for value in values if value not in (first, second)]
        if _is_one(both, others):
            out = out.copy() if out is labels else out
            out[out == second] = out[one][0]
        elif any(_is_piece(look, others or pair) for look in pair):
            raise BadImageError(
                f"labels {first} and {second} touch and have one colour, but are no two blocks; "
                "check camera/segmentation, or give depth"
            )
    return out


def _present(labels: Labels) -> list[int]:
    """Labels of more than specks, ascending."""
    counts = np.bincount(labels.ravel())
    counts[:1] = 0
    return [int(value) for value in np.flatnonzero(counts >= max(1.0, MIN_AREA * labels.size))]


def _second_color(mask: Mask, rgb: NDArray[np.uint8]) -> Mask | None:
    """The pixels of a mask that have the rarer of its two colours; None where it has one."""
    inner = cv2.erode(mask.view(np.uint8), np.ones((2 * _RIM + 1,) * 2, np.uint8)).astype(bool)
    seen = _colors(rgb[inner])
    if len(seen) < 8:
        return None
    some = seen[:: max(1, len(seen) // _PIXELS)]
    low, high = np.percentile(some, _RANGE, axis=0)
    if (high - low).max() < _TWO:
        return None
    _, _, axes = np.linalg.svd(some - some.mean(axis=0), full_matrices=False)
    along = some @ axes[0]
    one, two = (some[group] for group in cluster_on_line(along, 2))
    middles = np.median(one, axis=0), np.median(two, axis=0)
    rarer = min(len(one), len(two)) / len(some)
    if rarer < _SHARE or np.abs(middles[0] - middles[1]).max() < _TWO:
        return None
    all_of_it = _colors(rgb[mask])
    nearer = [np.linalg.norm(all_of_it - middle, axis=1) for middle in middles]
    found = np.zeros(mask.shape, bool)
    found[mask] = (nearer[1] < nearer[0]) == (len(two) <= len(one))
    # Pixels where the two meet are mixtures.
    clean = cv2.medianBlur(found.astype(np.uint8), 5).astype(bool) & mask
    _, parts, stats, _ = cv2.connectedComponentsWithStats(clean.astype(np.uint8))
    if len(stats) < 2:
        return None
    return np.asarray(parts == 1 + int(stats[1:, cv2.CC_STAT_AREA].argmax()))


def _look(mask: Mask, rgb: NDArray[np.uint8]) -> _Look:
    inner = cv2.erode(mask.view(np.uint8), np.ones((2 * _RIM + 1,) * 2, np.uint8)).astype(bool)
    pixels = rgb[inner if inner.any() else mask]
    _, _, width, height = cv2.boundingRect(mask.view(np.uint8))
    return _Look(
        np.median(_colors(pixels), axis=0), height, width, _DARK / (1.0 + float(pixels.mean()))
    )


def _colors(pixels: NDArray[np.uint8]) -> Array:
    """Shares of the channels and the brightness, see ``_LIGHT``, shape (n, 4)."""
    values = pixels.astype(np.float64) + 1.0
    total = values.sum(axis=1, keepdims=True)
    return np.concatenate([values / total, _LIGHT * np.log(total)], axis=1)


def _same_color(one: _Look, two: _Look) -> bool:
    limit = _SAME + min(one.dark, two.dark)
    return bool(np.abs(one.color - two.color).max() < limit)


def _is_one(both: _Look, others: list[_Look]) -> bool:
    """Whether what is seen is as large as one block."""
    if not others:
        return both.height < _ONE_BLOCK * both.width
    high, wide = _usual(others)
    return both.height < _ONE_BLOCK * high and both.width < _ONE_BLOCK * wide


def _is_piece(look: _Look, others: list[_Look]) -> bool:
    """Whether it is too small for a block."""
    if not others:
        return False
    high, wide = _usual(others)
    return look.height < _PIECE * high or look.width < _PIECE * wide


def _usual(looks: list[_Look]) -> tuple[float, float]:
    """Middle height and width [px]."""
    return (
        float(np.median([look.height for look in looks])),
        float(np.median([look.width for look in looks])),
    )
