# SPDX-License-Identifier: Apache-2.0
"""Keeps a camera's pictures as training material: shards that ``train_visual`` reads.

A picture is kept when something stands elsewhere than in the one kept before, so that blocks which
are moved about before the camera, by a hand or by the arm, make a data set. Where the blocks are in
it is what the segmenter found; nothing is kept of what they are called or where they stand.
"""

from __future__ import annotations

from pathlib import Path
from typing import Any, Final

import numpy as np
from numpy.typing import NDArray

from perception_node.errors import DatasetError
from perception_node.observation import Observation
from perception_node.segment import Segments

#: Pictures in one file.
SHARD: Final = 20
#: Masks that share less than this part of their pixels show that something moved.
_SAME: Final = 0.9


class Recorder:
    """Writes ``shard_NNNN.npz`` with rgb, labels and depth, see :mod:`.dataset`.

    Args:
        folder: is made where it is missing; what it holds stays, new shards are added.

    Attributes:
        kept: pictures so far, those of this recorder only.

    Raises:
        DatasetError: the folder cannot be written to.
    """

    def __init__(self, folder: Path) -> None:
        self.folder, self.kept = folder, 0
        self._waiting: list[dict[str, NDArray[Any]]] = []
        self._last: NDArray[np.bool_] | None = None
        try:
            folder.mkdir(parents=True, exist_ok=True)
            numbers = [int(path.stem.removeprefix("shard_")) for path in
                       folder.glob("shard_[0-9]*.npz")]  # fmt: skip
        except (OSError, ValueError) as error:
            raise DatasetError(f"pictures cannot be kept in {folder}: {error}") from error
        self._next = max(numbers, default=-1) + 1

    def take(self, observation: Observation, segments: Segments | None) -> bool:
        """Keeps a picture if it shows blocks otherwise than the last one; whether it did.

        Raises:
            DatasetError: it cannot be written.
        """
        if segments is None or not len(segments):
            return False
        covered = segments.union()
        if not self._is_new(covered):
            return False
        arrays: dict[str, NDArray[Any]] = {
            "rgb": observation.rgb,
            "labels": segments.label_image.astype(np.uint16),
        }
        if observation.depth is not None:
            arrays["depth"] = observation.depth.astype(np.float32)
        if self._waiting and _shapes(self._waiting[0]) != _shapes(arrays):
            self.flush()
        self._waiting.append(arrays)
        self._last = covered
        self.kept += 1
        if len(self._waiting) >= SHARD:
            self.flush()
        return True

    def flush(self) -> None:
        """Writes what is not written yet, to a file that appears when it is whole."""
        if not self._waiting:
            return
        path = self.folder / f"shard_{self._next:04d}.npz"
        partial = self.folder / "part.npz"
        try:
            arrays: dict[str, Any] = {
                name: np.stack([picture[name] for picture in self._waiting])
                for name in self._waiting[0]
            }
            np.savez_compressed(partial, **arrays)
            partial.rename(path)
        except OSError as error:
            raise DatasetError(f"{path} cannot be written: {error}") from error
        self._next += 1
        self._waiting.clear()

    def _is_new(self, covered: NDArray[np.bool_]) -> bool:
        last = self._last
        if last is None or last.shape != covered.shape:
            return True
        return bool((last & covered).sum() < _SAME * (last | covered).sum())


def _shapes(arrays: dict[str, NDArray[Any]]) -> dict[str, tuple[int, ...]]:
    return {name: array.shape for name, array in arrays.items()}
