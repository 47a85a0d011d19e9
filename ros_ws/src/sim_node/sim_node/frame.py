# SPDX-License-Identifier: Apache-2.0
"""One picture of a camera."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray


@dataclass(frozen=True)
class Frame:
    """One picture.

    Attributes:
        rgb: uint8, shape (height, width, 3).
        depth: float32, shape (height, width), along the optical axis [m]; 0 where nothing is.
        labels: uint16, shape (height, width), instance labels of the blocks, 0 elsewhere.
    """

    rgb: NDArray[np.uint8]
    depth: NDArray[np.float32]
    labels: NDArray[np.uint16]
