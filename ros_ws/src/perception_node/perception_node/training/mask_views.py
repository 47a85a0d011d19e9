# SPDX-License-Identifier: Apache-2.0
"""Views to train the mask network on: read from shards, and repainted each time they are shown.

Only the shapes of the simulator's pictures are kept: every block gets a colour and a pattern of its
own, often that of another block or of what is behind it, and everything else other colours,
textures, light, blur and grain.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from pathlib import Path
from typing import Final

import cv2
import numpy as np
from numpy.typing import NDArray

from perception_node.errors import DatasetError
from perception_node.segment.mask_network import BEFORE, BLOCK, FREE, REACH
from scene_graph import COLORS

from .clutter import with_clutter

Floats = NDArray[np.float32]

#: Labels are less than this.
LABELS: Final = 32
#: So many views get more things behind the row.
CLUTTERED: Final = 0.4
#: So many are as from pictures of another resolution, which have so many times the pixels.
RESAMPLED: Final = 0.5
FINER: Final = (0.6, 1.8)
_PALETTE: Final = np.array(list(COLORS.values()), np.float32)


@dataclass(frozen=True)
class Views:
    """n views, see :class:`~perception_node.segment.front_view.FrontView`.

    Attributes:
        rgb: shape (n, h, w, 3).
        labels: shape (n, h, w).
        before: shape (n, h, w).
        feet, aside: shape (n, w) [px].
        steepness: shape (n,).
    """

    rgb: NDArray[np.uint8]
    labels: NDArray[np.uint8]
    before: NDArray[np.bool_]
    feet: Floats
    aside: Floats
    steepness: Floats

    def __len__(self) -> int:
        return len(self.rgb)


@dataclass(frozen=True)
class Shown:
    """One view as it is shown, and what is to be said of it.

    Attributes:
        rgb: in 0..1, shape (3, h, w).
        classes: shape (h, w).
        middles: of the pixel's block, from the pixel, right and down, shape (2, h, w) [REACH px].
        weight: of the pixel, shape (h, w).
        feet, aside: shape (w,) [px].
        steepness: as seen.
    """

    rgb: Floats
    classes: NDArray[np.int64]
    middles: Floats
    weight: Floats
    feet: Floats
    aside: Floats
    steepness: float


def shard_paths(folder: Path) -> list[Path]:
    """The shards of a folder; raises DatasetError if there are none."""
    paths = sorted(folder.glob("shard_????.npz"))
    if not paths:
        raise DatasetError(f"{folder} has no shards; render them with `make data-masks`")
    return paths


def read_views(folder: Path, on_shard: Callable[[], object] = lambda: None) -> Views:
    """All views of a folder of ``make data-masks``; raises DatasetError."""
    parts: dict[str, list[NDArray]] = {}
    for path in shard_paths(folder):
        try:
            with np.load(path, allow_pickle=False) as file:
                for name in Views.__dataclass_fields__:
                    parts.setdefault(name, []).append(file[name])
        except (OSError, ValueError, KeyError) as error:
            raise DatasetError(f"{path} cannot be read ({error}); delete it") from error
        on_shard()
    return Views(**{name: np.concatenate(values) for name, values in parts.items()})


def shown(views: Views, index: int, size: int, rng: np.random.Generator) -> Shown:
    """A part of a view as training shows it, mirrored or not.

    Args:
        size: of the part [px].
    """
    rgb, labels, before = views.rgb[index], views.labels[index], views.before[index]
    feet, aside = views.feet[index], views.aside[index]
    middles, classes = _middles(labels), np.where(before, BEFORE, FREE)
    classes = np.where(labels > 0, BLOCK, classes).astype(np.int64)
    top, left = _corner(labels, size, rng)
    box, columns = np.s_[top : top + size, left : left + size], np.s_[left : left + size]
    rgb, labels, classes, middles = rgb[box], labels[box], classes[box], middles[(..., *box)]
    feet, aside = feet[columns] - top, aside[columns]
    if rng.random() < 0.5:
        rgb, labels, classes = rgb[:, ::-1], labels[:, ::-1], classes[:, ::-1]
        middles = middles[..., ::-1] * np.array([-1.0, 1.0], np.float32)[:, None, None]
        feet, aside = feet[::-1], -aside[::-1]
    # Calibrations are not exact.
    feet = feet + np.float32(rng.normal(0.0, 1.5))
    aside = aside + np.float32(rng.normal(0.0, 1.5))
    painted = _repainted(rgb, labels, rng)
    if rng.random() < CLUTTERED:
        place = (feet, aside, float(views.steepness[index]))
        color = _colors_around(painted, labels, rng)
        painted = with_clutter(painted, labels, classes == BEFORE, place, color, rng)
    painted = _photographed(painted, rng)
    return Shown(
        np.ascontiguousarray(painted.transpose(2, 0, 1)),
        np.ascontiguousarray(classes),
        np.ascontiguousarray(middles),
        1.0 + 2.0 * _near_edges(labels),
        np.ascontiguousarray(feet),
        np.ascontiguousarray(aside),
        float(views.steepness[index]),
    )


def _corner(labels: NDArray[np.uint8], size: int, rng: np.random.Generator) -> tuple[int, int]:
    """Of the part that is shown: most of them have a block in them."""
    rows, columns = np.nonzero(labels)
    corner = [int(rng.integers(0, side - size + 1)) for side in labels.shape]
    if len(rows) and rng.random() < 0.9:
        at = int(rng.integers(len(rows)))
        for axis, place in enumerate((rows[at], columns[at])):
            first, last = max(0, place - size + 12), min(place - 12, labels.shape[axis] - size)
            if first < last:
                corner[axis] = int(rng.integers(first, last + 1))
    return corner[0], corner[1]


def _middles(labels: NDArray[np.uint8]) -> Floats:
    """From each pixel to the middle of the visible part of its block, (2, h, w) [REACH px]."""
    height, width = labels.shape
    flat = labels.ravel()
    counts = np.maximum(np.bincount(flat, minlength=LABELS), 1)
    columns = np.broadcast_to(np.arange(width, dtype=np.float32), labels.shape)
    rows = np.broadcast_to(np.arange(height, dtype=np.float32)[:, None], labels.shape)
    across, down = (
        np.bincount(flat, axis.ravel(), minlength=LABELS) / counts for axis in (columns, rows)
    )
    off = np.stack([across[labels] - columns, down[labels] - rows]) / REACH
    return (off * (labels > 0)).astype(np.float32)


def _near_edges(labels: NDArray[np.uint8]) -> Floats:
    """Where another label is a pixel away, 1; shape (h, w)."""
    square = np.ones((3, 3), np.uint8)
    return (cv2.dilate(labels, square) != cv2.erode(labels, square)).astype(np.float32)


def _repainted(
    rgb: NDArray[np.uint8], labels: NDArray[np.uint8], rng: np.random.Generator
) -> Floats:
    """In other colours, in 0..1, shape (h, w, 3)."""
    picture = rgb.astype(np.float32) / 255.0
    light = picture.max(axis=2)
    free = labels == 0
    if rng.random() < 0.85:
        picture = np.where(free[..., None], _another_room(picture, rng), picture)
    given: list[Floats] = []
    for label in np.unique(labels[labels > 0]):
        if rng.random() < 0.15:
            continue  # as the simulator paints it
        mine = labels == label
        shade = light / max(float(np.quantile(light[mine], 0.9)), 0.05)
        contrast = rng.uniform(0.5, 1.6)
        shade = np.clip(1.0 + contrast * (shade - 1.0), 0.1, 1.4)
        color = _color(given, picture, free, rng)
        given.append(color)
        paint = color * shade[..., None]
        if rng.random() < 0.3:
            strength = rng.uniform(0.02, 0.2)
            paint = paint * (1.0 + strength * _texture(labels.shape, rng)[..., None])
        picture = np.where(mine[..., None], paint, picture)
    return picture.astype(np.float32)


def _color(
    given: list[Floats], picture: Floats, free: NDArray[np.bool_], rng: np.random.Generator
) -> Floats:
    """Of a block: one that has a name, any, that of another block, or of what is around."""
    kind = rng.random()
    if kind < 0.15 and given:
        return given[int(rng.integers(len(given)))]
    if kind < 0.2 and free.any():
        rows, columns = np.nonzero(free)
        at = int(rng.integers(len(rows)))
        return picture[rows[at], columns[at]] * np.float32(rng.uniform(0.8, 1.2))
    if kind < 0.6:
        color = _PALETTE[int(rng.integers(len(_PALETTE)))]
        return np.clip(color * rng.uniform(0.5, 1.1) + rng.normal(0.0, 0.03, 3), 0.0, 1.0).astype(
            np.float32
        )
    return _any_color(rng)


def _colors_around(
    picture: Floats, labels: NDArray[np.uint8], rng: np.random.Generator
) -> Callable[[], Floats]:
    """What gives things colours, as blocks have them; some those of the blocks of a picture."""
    given = [picture[labels == label].mean(axis=0) for label in np.unique(labels[labels > 0])]
    return lambda: _color(given, picture, labels == 0, rng)


def _any_color(rng: np.random.Generator) -> Floats:
    saturation, value = rng.uniform(0.0, 1.0) ** 0.7, rng.uniform(0.15, 1.0)
    offsets = np.array([0.0, 2.0, 4.0])
    hue = np.clip(np.abs((6.0 * rng.random() + offsets) % 6.0 - 3.0) - 1.0, 0.0, 1.0)
    return np.asarray(value * (1.0 - saturation * (1.0 - hue)), np.float32)


def _another_room(picture: Floats, rng: np.random.Generator) -> Floats:
    """What is no block in other colours, with patterns or without."""
    mixed = picture[..., rng.permutation(3)] if rng.random() < 0.5 else picture
    gain = np.float32(rng.uniform(0.4, 1.4)) * rng.uniform(0.8, 1.2, 3).astype(np.float32)
    changed = mixed * gain
    if rng.random() < 0.6:
        # The largest surfaces, table and wall, each in a colour of its own.
        codes = np.round(picture * 12.0).astype(np.int32) @ np.array([1, 16, 256], np.int32)
        found, counts = np.unique(codes, return_counts=True)
        for code in found[np.argsort(-counts)[:3]]:
            if rng.random() < 0.6:
                changed = np.where((codes == code)[..., None], _any_color(rng), changed)
    if rng.random() < 0.5:
        texture = _texture(picture.shape[:2], rng)[..., None]
        changed = changed * (1.0 + rng.uniform(0.05, 0.4) * texture)
    if rng.random() < 0.25:
        texture = np.stack([_texture(picture.shape[:2], rng) for _ in range(3)], -1)
        share = np.float32(rng.uniform(0.2, 0.8))
        changed = changed * (1.0 - share) + share * (0.5 + 0.4 * texture)
    return np.asarray(changed, np.float32)


def _texture(shape: tuple[int, ...], rng: np.random.Generator) -> Floats:
    """A pattern of mean 0 and about ±1: clouds, grain of wood, stripes or squares, (h, w)."""
    height, width = shape[:2]
    kind = rng.integers(4)
    if kind < 2:
        total = np.zeros((height, width), np.float32)
        stretch = (1, 1) if kind == 0 else (int(rng.integers(2, 12)), 1)
        for octave in range(int(rng.integers(1, 5))):
            cells = 3 * 2**octave
            size = (max(2, cells // stretch[0]), cells)
            if rng.random() < 0.5:
                size = size[::-1]
            noise = rng.normal(0.0, 1.0, size).astype(np.float32)
            total += cv2.resize(noise, (width, height), interpolation=cv2.INTER_CUBIC) / 2**octave
        return np.asarray(np.clip(total / 1.5, -1.5, 1.5))
    angle, length = rng.uniform(0.0, np.pi), rng.uniform(6.0, 40.0)
    rows, columns = np.mgrid[:height, :width].astype(np.float32)
    along = np.sin((np.cos(angle) * columns + np.sin(angle) * rows) * (6.283 / length))
    if kind == 2:
        return np.asarray(np.sign(along) if rng.random() < 0.5 else along, np.float32)
    across = np.sin((np.cos(angle) * rows - np.sin(angle) * columns) * (6.283 / length))
    return np.asarray(np.sign(along * across), np.float32)


def _photographed(picture: Floats, rng: np.random.Generator) -> Floats:
    """As a camera takes it, of this resolution or another one: light, shadows, blur, grain."""
    height, width = picture.shape[:2]
    picture = picture * rng.uniform(0.85, 1.15, 3).astype(np.float32)
    picture = picture * np.float32(rng.uniform(0.5, 1.15))
    if rng.random() < 0.4:
        soft = rng.uniform(0.6, 1.3, (3, 4)).astype(np.float32)
        uneven = cv2.resize(soft, (width, height), interpolation=cv2.INTER_CUBIC)
        picture = picture * np.asarray(uneven, np.float32)[..., None]
    if rng.random() < RESAMPLED:
        finer = rng.uniform(*FINER)
        size = (round(finer * width), round(finer * height))
        taken = _with_grain(np.asarray(cv2.resize(picture, size), np.float32), rng)
        if finer > 1.0:
            taken = np.asarray(cv2.GaussianBlur(taken, (0, 0), 0.4 * finer), np.float32)
        picture = np.asarray(cv2.resize(taken, (width, height)), np.float32)
    else:
        picture = _with_grain(picture, rng)
    return np.clip(picture, 0.0, 1.0).astype(np.float32)


def _with_grain(picture: Floats, rng: np.random.Generator) -> Floats:
    """What lens, sensor and file do to a picture."""
    if rng.random() < 0.6:
        blurred = cv2.GaussianBlur(picture, (0, 0), rng.uniform(0.3, 1.2))
        picture = np.asarray(blurred, np.float32)
    picture = np.clip(picture, 0.0, 1.0)
    if rng.random() < 0.3:
        picture = picture ** np.float32(rng.uniform(0.7, 1.4))
    if rng.random() < 0.6:
        noise = rng.standard_normal(picture.shape, np.float32)
        picture = picture + np.float32(rng.uniform(0.0, 0.05)) * noise
    if rng.random() < 0.3:
        coded = np.clip(255.0 * picture, 0, 255).astype(np.uint8)
        quality = [cv2.IMWRITE_JPEG_QUALITY, int(rng.integers(50, 96))]
        read = cv2.imdecode(cv2.imencode(".jpg", coded, quality)[1], cv2.IMREAD_COLOR)
        picture = np.asarray(read, np.float32) / 255.0
    return picture
