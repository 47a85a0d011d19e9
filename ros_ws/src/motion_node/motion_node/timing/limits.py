# SPDX-License-Identifier: Apache-2.0
"""What the arm's joints may do."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

Array = NDArray[np.float64]


@dataclass(frozen=True)
class JointLimits:
    """Limits of the arm's joints, each of shape (n,) [rad/s, rad/s²]."""

    velocity: Array
    acceleration: Array
