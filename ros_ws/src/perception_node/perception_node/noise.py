# SPDX-License-Identifier: Apache-2.0
"""How noisy a picture is, by itself: what should be straight and bends is noise."""

from __future__ import annotations

from typing import Any, Final

import numpy as np
from numpy.typing import NDArray

from .quantiles import quantile_of_codes

#: Noise of depth is measured on pixels this far apart, further than neighbours share it [px].
DEPTH_STEP: Final = 4
#: The median over so many rows is known to one in a hundred.
ROWS: Final = 64


def color_noise(rgb: NDArray[np.uint8]) -> float:
    """Standard deviation of a picture's channels about what they should be [0..255].

    Colours of faces of blocks and of the table change steadily.

    Args:
        rgb: shape (h, w, 3).
    """
    return _noise(_some_rows(rgb).astype(np.int16), 1)


def depth_noise(depth: NDArray[np.floating]) -> float:
    """Standard deviation of a picture's depth at 1 m [m]; it grows with the square.

    Across a plane, of which a picture mostly consists, the inverse of depth is a linear function of
    the pixel; its noise is the same at all distances.

    Args:
        depth: anything but a positive number means unknown, shape (height, width) [m].
    """
    some = _some_rows(depth)
    known = (some > 0.0) & np.isfinite(some)
    inverse = np.divide(1.0, some, out=np.full(some.shape, np.nan), where=known)
    return _noise(inverse, DEPTH_STEP)


def _some_rows(picture: NDArray[Any]) -> NDArray[Any]:
    """As many rows, spread over a picture, as it takes to tell its noise."""
    return picture[:: max(2, len(picture) // ROWS)]


def _noise(rows: NDArray[Any], step: int) -> float:
    """Of rows of values that mostly change steadily, by three that are ``step`` pixels apart."""
    bends = np.abs(rows[:, : -2 * step] - 2 * rows[:, step:-step] + rows[:, 2 * step :])
    found = bends[np.isfinite(bends)] if bends.dtype.kind == "f" else bends
    if not found.size:
        return 0.0
    # From the median of normal errors' sizes; a bend's variance is 1 + 4 + 1 times that of a value.
    return (
        1.4826
        / np.sqrt(6.0)
        * (float(np.median(found)) if found.dtype.kind == "f" else quantile_of_codes(found, 0.5))
    )
