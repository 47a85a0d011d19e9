# SPDX-License-Identifier: Apache-2.0
"""Pictures of a camera at the size that the state encoder reads."""

from __future__ import annotations

import cv2
import numpy as np
from numpy.typing import NDArray

from perception_node.errors import BadImageError

from .networks import IMAGE


def reduced(rgb: NDArray[np.uint8]) -> NDArray[np.uint8]:
    """A square picture (h, h, 3), averaged to (128, 128, 3).

    Raises:
        BadImageError: it is smaller, or not square.
    """
    height, width = rgb.shape[:2]
    if height != width or height < IMAGE:
        raise BadImageError(
            f"a picture of {width}x{height} was given; the state encoder reads square ones of "
            f"{IMAGE}x{IMAGE} or more, as the simulator's first camera takes them"
        )
    if height == IMAGE:
        return np.ascontiguousarray(rgb)
    return np.asarray(cv2.resize(rgb, (IMAGE, IMAGE), interpolation=cv2.INTER_AREA), np.uint8)
