# SPDX-License-Identifier: Apache-2.0
"""Rendered scenes on disk, and the objects in them as training material.

What ``ros2 run sim_node render_dataset`` writes: a folder of shards ``shard_0000.npz``, … (numpy,
read without pickle) with these arrays over its N scenes:

===============  =================  ======================================================
rgb              (N, h, w, 3) u8    what the camera sees
labels           (N, h, w) u16      instance labels, 0 = none
layouts          (N,) str           JSON: for each stack from the left, names from the bottom
names            (N,) str           JSON: name by label
depth            (N, h, w) f32      optional: depth [m]
===============  =================  ======================================================

``layouts`` and ``names`` are ground truth: evaluation reads them, training never.
"""

from __future__ import annotations

import json
from collections.abc import Callable, Iterator
from dataclasses import dataclass
from pathlib import Path
from typing import Any, Final
from zipfile import BadZipFile

import numpy as np
import torch
from numpy.typing import NDArray
from torch import Tensor

from perception_node.errors import DatasetError
from perception_node.segment import Segments
from perception_node.visual_module.object_images import IMAGE_SIZE, object_images

#: Crops are kept in squares of this side [px]; objects larger than that are not trained on.
CROP_SIZE: Final = 32


@dataclass(frozen=True)
class Scene:
    """One rendered scene with its ground truth; see the module's table."""

    rgb: NDArray[np.uint8]
    labels: NDArray[np.uint16]
    layout: tuple[tuple[str, ...], ...]
    label_names: dict[int, str]
    depth: NDArray[np.float32] | None


@dataclass(frozen=True)
class ObjectCrops:
    """All objects of a data set, cut out; what training sees.

    Attributes:
        pixels: masked colours, uint8, shape (objects, 3, CROP_SIZE, CROP_SIZE), the object at the
            bottom left.
        sizes: width and height of each object [px], shape (objects, 2).
        corners: column from the left and row from the bottom of each object in its 128x128 image
            [px], shape (objects, 2).
        scenes: index of the first object of each scene, and the total, shape (scenes + 1,).
    """

    pixels: Tensor
    sizes: Tensor
    corners: Tensor
    scenes: Tensor


def shard_paths(folder: Path) -> list[Path]:
    """The shards of a data set in order; raises DatasetError if there are none."""
    paths = sorted(folder.glob("shard_*.npz"))
    if not paths:
        raise DatasetError(f"{folder} holds no shards shard_*.npz; render a data set into it first")
    return paths


def read_scenes(folder: Path) -> Iterator[Scene]:
    """The scenes of a data set, shard by shard.

    Raises:
        DatasetError: if a shard is missing, damaged or lacks an array.
    """
    for path in shard_paths(folder):
        arrays = _read_shard(path, ("rgb", "labels", "layouts", "names"))
        for index in range(len(arrays["rgb"])):
            names = json.loads(str(arrays["names"][index]))
            yield Scene(
                rgb=arrays["rgb"][index],
                labels=arrays["labels"][index],
                layout=tuple(tuple(s) for s in json.loads(str(arrays["layouts"][index]))),
                label_names={int(label): name for label, name in names.items()},
                depth=arrays["depth"][index] if "depth" in arrays else None,
            )


def read_crops(folder: Path, on_shard: Callable[[], object] = lambda: None) -> ObjectCrops:
    """Cuts the objects out of every scene of a data set; reads no ground truth.

    Args:
        on_shard: called after each shard, to show progress.

    Raises:
        DatasetError: as :func:`read_scenes`, or if no usable object is in it.
    """
    pixels, sizes, corners, starts = [], [], [], [0]
    for path in shard_paths(folder):
        arrays = _read_shard(path, ("rgb", "labels"))
        for rgb, labels in zip(arrays["rgb"], arrays["labels"]):
            objects = object_images(rgb, Segments.from_labels(labels))
            fits = np.flatnonzero(objects.crop_sizes.max(axis=1) <= CROP_SIZE)
            pixels.append(objects.default_images[fits, :, -CROP_SIZE:, :CROP_SIZE])
            sizes.append(objects.crop_sizes[fits])
            corners.append(_corners(objects.coverage[fits]))
            starts.append(starts[-1] + len(fits))
        on_shard()
    if starts[-1] == 0:
        raise DatasetError(f"{folder} shows no objects of at most {CROP_SIZE} px")
    return ObjectCrops(
        pixels=torch.from_numpy((np.concatenate(pixels) * 255.0).round().astype(np.uint8)),
        sizes=torch.from_numpy(np.concatenate(sizes)),
        corners=torch.from_numpy(np.concatenate(corners)),
        scenes=torch.tensor(starts),
    )


def _corners(coverage: NDArray[np.float32]) -> NDArray[np.intp]:
    columns = np.any(coverage, axis=1).argmax(1)
    rows = np.flip(np.any(coverage, axis=2), axis=1).argmax(1)
    return np.stack([columns, rows], axis=1)


def place_crops(pixels: Tensor, corners: Tensor, size: int = IMAGE_SIZE) -> Tensor:
    """Images with each crop's bottom-left corner at the given pixel.

    Args:
        pixels: shape (n, channels, CROP_SIZE, CROP_SIZE), content at the bottom left.
        corners: columns from the left and rows from the bottom [px], shape (n, 2).

    Returns:
        Shape (n, channels, size, size); what would lie outside is cut off.
    """
    n, channels, side, _ = pixels.shape
    canvas = pixels.new_zeros((n, channels, size + 2 * side, size + 2 * side))
    steps = torch.arange(side)
    columns = (corners[:, :1] + steps + side).clamp(0, size + 2 * side - 1)
    rows = (size - corners[:, 1:] - side + steps + side).clamp(0, size + 2 * side - 1)
    index = torch.arange(n)[:, None, None]
    canvas[index, :, rows[:, :, None], columns[:, None, :]] = pixels.permute(0, 2, 3, 1)
    return canvas[:, :, side : side + size, side : side + size]


def _read_shard(path: Path, required: tuple[str, ...]) -> dict[str, NDArray[Any]]:
    try:
        with np.load(path, allow_pickle=False) as file:
            arrays = {name: file[name] for name in file.files}
    except (OSError, ValueError, BadZipFile, EOFError) as error:
        raise DatasetError(f"{path} is damaged ({error}); delete it and render it again") from error
    if missing := [name for name in required if name not in arrays]:
        raise DatasetError(f"{path} lacks {', '.join(missing)}; render the data set again")
    return arrays
