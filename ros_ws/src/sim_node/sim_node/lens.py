# SPDX-License-Identifier: Apache-2.0
"""The picture that a lens with distortion makes of what a pinhole would show."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any, Final

import numpy as np
from numpy.typing import NDArray

from .frame import Frame
from .scene import CameraConfig
from .scene.distortion import undistorted

Array = NDArray[np.float64]

#: The pinhole's picture is so much finer than the lens's.
_FINER: Final = 1.25
#: Four neighbours are on one plane if their inverse depths are linear up to this share.
_PLANE: Final = 1e-5


@dataclass(frozen=True)
class Pinhole:
    """A picture without distortion.

    Attributes:
        width, height: its size [px].
        intrinsics: K, shape (3, 3) [px], of pixels whose centres have whole coordinates.
    """

    width: int
    height: int
    intrinsics: Array

    @classmethod
    def of(cls, config: CameraConfig) -> Pinhole:
        """The picture of a camera whose lens does not distort."""
        return cls(config.width, config.height, config.intrinsics)


class Lens:
    """Looks through a lens at the picture of a pinhole that shows all that the lens does.

    Colour is interpolated between four pixels; a label is that of the nearest one. So is depth,
    except where the four are on one plane: there it is interpolated, which is exact.

    Attributes:
        pinhole: the picture that :meth:`picture` needs; finer and larger than its own.
    """

    def __init__(self, config: CameraConfig) -> None:
        k = config.intrinsics
        columns, rows = np.meshgrid(np.arange(config.width), np.arange(config.height))
        seen = np.column_stack(
            [
                (columns.ravel() - k[0, 2]) / k[0, 0],
                (rows.ravel() - k[1, 2]) / k[1, 1],
            ]
        )
        points, scale = undistorted(seen, config.distortion)
        focal = _FINER * k[0, 0] * max(1.0, float(scale.max()))
        low, high = points.min(axis=0), points.max(axis=0)
        width, height = (np.ceil((high - low) * focal).astype(int) + 3).tolist()
        centre = 1.0 - low * focal
        intrinsics = np.array([[focal, 0.0, centre[0]], [0.0, focal, centre[1]], [0.0, 0.0, 1.0]])
        self.pinhole = Pinhole(width, height, intrinsics)
        self._shape = (config.height, config.width)
        places = points * focal + centre
        corner = np.floor(places).astype(np.int64)
        x, y = (places - corner).T
        first = corner[:, 1] * width + corner[:, 0]
        self._four = np.stack([first, first + 1, first + width, first + width + 1])
        self._weights = np.stack([(1 - x) * (1 - y), x * (1 - y), (1 - x) * y, x * y])
        self._nearest = self._four[self._weights.argmax(axis=0), np.arange(len(first))]

    def picture(self, frame: Frame) -> Frame:
        """What the lens shows, of the pinhole's frame."""
        weights = self._weights[..., None]
        colors = (frame.rgb.reshape(-1, 3)[self._four] * weights).sum(axis=0)
        rgb = np.rint(colors).astype(np.uint8)
        depths, labels = frame.depth.ravel(), frame.labels.ravel()
        nearest = depths[self._nearest].astype(np.float64)
        around = depths[self._four].astype(np.float64)
        with np.errstate(divide="ignore", invalid="ignore"):
            inverse = 1.0 / around
            bend = np.abs(inverse[0] - inverse[1] - inverse[2] + inverse[3])
            flat = (around > 0.0).all(axis=0) & (bend < _PLANE * inverse[0])
            flat &= (labels[self._four] == labels[self._nearest]).all(axis=0)
            depth = np.where(flat, 1.0 / (inverse * self._weights).sum(axis=0), nearest)
        shaped: Any = self._shape
        return Frame(
            rgb.reshape(*shaped, 3),
            depth.astype(np.float32).reshape(shaped),
            labels[self._nearest].reshape(shaped),
        )
