# SPDX-License-Identifier: Apache-2.0
"""Bodies of unit size by their corners, and the numbers that tell one in the world."""

from __future__ import annotations

from typing import Final

import numpy as np
from numpy.typing import NDArray

from scene_graph import BOX, CYLINDER, SPHERE

Array = NDArray[np.float64]

#: Columns of a body's parameters: x and y of its axis, yaw, two widths, height, z of its lower end.
X, Y, TURN, WIDE, DEEP, HIGH, LOW = range(7)


def _unit(shape: str) -> Array:
    """Corners of a body of unit size about its middle, shape (n, 3)."""
    turns = np.linspace(0.0, 2.0 * np.pi, 16, endpoint=False)
    if shape == BOX:
        return np.array([[x, y, z] for x in (-0.5, 0.5) for y in (-0.5, 0.5) for z in (-0.5, 0.5)])
    if shape == CYLINDER:
        ring = 0.5 * np.stack([np.cos(turns), np.sin(turns)], -1)
        return np.concatenate([np.column_stack([ring, np.full(16, z)]) for z in (-0.5, 0.5)])
    heights = np.linspace(-0.5, 0.5, 9)
    return np.concatenate(
        [
            np.column_stack(
                [
                    np.sqrt(0.25 - z**2) * np.cos(turns),
                    np.sqrt(0.25 - z**2) * np.sin(turns),
                    np.full(16, z),
                ]
            )
            for z in heights
        ]
    )


#: Shape -> corners of a body of it about its middle, shape (n, 3).
UNITS: Final = {shape: _unit(shape) for shape in (BOX, CYLINDER, SPHERE)}
