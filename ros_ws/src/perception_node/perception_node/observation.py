# SPDX-License-Identifier: Apache-2.0
"""Observations: what one camera delivers of one moment, the beginning of the pipeline."""

from __future__ import annotations

from dataclasses import dataclass, replace
from typing import Any, Final

import numpy as np
from numpy.typing import NDArray

from .camera import PinholeCamera
from .errors import BadImageError

#: Least side of an image [px].
MIN_SIDE: Final = 32


@dataclass(frozen=True)
class Observation:
    """The images of one moment, all of the same pixels.

    Attributes:
        rgb: uint8, shape (height, width, 3).
        labels: instance labels, 0 = none, shape (height, width); None where the segmenter needs
            none.
        depth: along the optical axis, shape (height, width) [m]; without it there are no poses, and
            nothing is said about hidden or unstable blocks.
        camera: without it there are neither poses nor places.
    """

    rgb: NDArray[np.uint8]
    labels: NDArray[np.integer] | None = None
    depth: NDArray[np.floating] | None = None
    camera: PinholeCamera | None = None

    def checked(self) -> Observation:
        """The same, with the camera as it is for images of this size.

        Raises:
            BadImageError: if an image cannot be used, or they do not fit together.
        """
        rgb, labels, depth = self.rgb, self.labels, self.depth
        if rgb.ndim != 3 or rgb.shape[2] != 3 or rgb.dtype != np.uint8:
            raise BadImageError(f"image is {rgb.dtype} of shape {rgb.shape}, expected 8-bit RGB")
        if min(rgb.shape[:2]) < MIN_SIDE:
            raise BadImageError(f"image of {_size(rgb)} is too small; send 128x128 or more")
        if labels is not None and labels.shape != rgb.shape[:2]:
            raise BadImageError(
                f"segmentation is {_size(labels)} but the image is {_size(rgb)}; "
                "both must show the same pixels"
            )
        if depth is not None and depth.shape != rgb.shape[:2]:
            raise BadImageError(
                f"depth is {_size(depth)} but the image is {_size(rgb)}; register depth to colour"
            )
        if self.camera is None:
            return self
        return replace(self, camera=self.camera.resized(rgb.shape[1], rgb.shape[0]))


def _size(image: NDArray[Any]) -> str:
    return "x".join(str(side) for side in image.shape[1::-1])
