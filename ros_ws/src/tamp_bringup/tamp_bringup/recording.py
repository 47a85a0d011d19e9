# SPDX-License-Identifier: Apache-2.0
"""Keeps camera images and writes them as an animation."""

from __future__ import annotations

from pathlib import Path

import numpy as np
from numpy.typing import NDArray
from PIL import Image


class Recording:
    """Camera images at a bounded rate of recorded time.

    Args:
        interval: least time between two kept images [s].
        limit: most images kept; beyond it every second one is dropped and the interval doubles.
    """

    def __init__(self, interval: float = 0.4, limit: int = 240) -> None:
        self._interval = interval
        self._limit = limit
        self._images: list[NDArray[np.uint8]] = []
        self._times: list[float] = []

    def add(self, image: NDArray[np.uint8], time: float) -> None:
        """Offers an image, (height, width, 3), taken at ``time`` [s]."""
        if self._times and time - self._times[-1] < self._interval:
            return
        self._images.append(image)
        self._times.append(time)
        if len(self._images) > self._limit:
            self._images, self._times = self._images[::2], self._times[::2]
            self._interval *= 2.0

    def write_gif(self, path: Path, frame_seconds: float = 0.1) -> bool:
        """Writes the animation; False if there is nothing to write."""
        if not self._images:
            return False
        first, *others = [
            Image.fromarray(image).quantize(colors=64, dither=Image.Dither.NONE)
            for image in self._images
        ]
        path.parent.mkdir(parents=True, exist_ok=True)
        first.save(
            path,
            save_all=True,
            append_images=others,
            duration=round(frame_seconds * 1000),
            loop=0,
            optimize=False,
        )
        return True
