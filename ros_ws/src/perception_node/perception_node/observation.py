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
#: The brightest parts of a picture are brighter than this where colours can be told [0..255]: at a
#: quarter of its light the simulator's picture is, at a fifth its blocks get other names.
MIN_BRIGHTNESS: Final = 60
#: The darkest parts of a picture are darker than this in some channel [0..255].
MAX_BRIGHTNESS: Final = 250
#: No table is as far away: a depth like this is in millimetres [m].
MAX_DEPTH: Final = 50.0


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
        sure: where depth is as it was measured, and not near an edge, shape (height, width); None:
            wherever it is known.
        noise: standard deviation of the picture's channels, as far as it is known [0..255].
        edge_doubt: by how much more than the pixels' own size edges may be displaced, as a standard
            deviation [px].
    """

    rgb: NDArray[np.uint8]
    labels: NDArray[np.integer] | None = None
    depth: NDArray[np.floating] | None = None
    camera: PinholeCamera | None = None
    sure: NDArray[np.bool_] | None = None
    noise: float = 0.0
    edge_doubt: float = 0.0

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

    def check_values(self) -> None:
        """Raises BadImageError if nothing can be told by what is in the images."""
        if problem := _light_problem(self.rgb) or _unit_problem(self.depth):
            raise BadImageError(problem)


def _size(image: NDArray[Any]) -> str:
    return "x".join(str(side) for side in image.shape[1::-1])


def _light_problem(rgb: NDArray[np.uint8]) -> str:
    """What keeps colours from being told anywhere in the picture, or an empty string."""
    red, green, blue = np.moveaxis(rgb[::4, ::4], 2, 0)
    brightest = np.maximum(np.maximum(red, green), blue)
    few = brightest.size // 100
    if np.count_nonzero(brightest >= MIN_BRIGHTNESS) <= few:
        black = brightest.max() < MIN_BRIGHTNESS // 4
        looks = "black" if black else "too dark to tell colours"
        return f"the picture is {looks}; is the lens covered, or the light off?"
    darkest = np.minimum(np.minimum(red, green), blue)
    if np.count_nonzero(darkest <= MAX_BRIGHTNESS) <= few:
        return "the picture is white; is the camera overexposed?"
    return ""


def _unit_problem(depth: NDArray[np.floating] | None) -> str:
    """What shows that the depth is not in metres, or an empty string."""
    if depth is None:
        return ""
    with np.errstate(invalid="ignore"):
        some = depth[::4, ::4]
        known = some[np.isfinite(some) & (some > 0.0)]
    if known.size and (middle := float(np.median(known))) > MAX_DEPTH:
        return (
            f"the depth is {middle:.0f} in the middle, which cannot be metres; if it is in "
            "millimetres, publish it in metres (32FC1)"
        )
    return ""
