# SPDX-License-Identifier: Apache-2.0
"""The picture that a lens with distortion makes of what a pinhole would show."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Final

import numpy as np
from numpy.typing import NDArray

from .frame import Frame
from .scene import CameraConfig
from .scene.distortion import undistorted

Array = NDArray[np.float64]

#: Inverse depths of neighbours that are linear up to this share are those of a plane.
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
    except where the four are amid a plane: there it is interpolated, which is exact.

    Attributes:
        pinhole: the picture that :meth:`picture` needs; larger than its own, and finer
            where the lens enlarges.
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
        focal = k[0, 0] * max(1.0, float(scale.max()))
        low, high = points.min(axis=0), points.max(axis=0)
        width, height = (np.ceil((high - low) * focal).astype(int) + 3).tolist()
        centre = 1.0 - low * focal
        intrinsics = np.array([[focal, 0.0, centre[0]], [0.0, focal, centre[1]], [0.0, 0.0, 1.0]])
        self.pinhole = Pinhole(width, height, intrinsics)
        self._shape = (config.height, config.width)
        places = points * focal + centre
        corner = np.floor(places).astype(np.int32)
        x, y = (places - corner).T
        first = corner[:, 1] * width + corner[:, 0]
        self._four = np.stack([first, first + 1, first + width, first + width + 1])
        self._weights = np.stack([(1 - x) * (1 - y), x * (1 - y), (1 - x) * y, x * y]).astype(
            np.float32
        )
        self._nearest = self._four[self._weights.argmax(axis=0), np.arange(len(first))]

    def picture(self, frame: Frame) -> Frame:
        """What the lens shows, of the pinhole's frame."""
        return Frame(
            self._colors(frame.rgb).reshape(*self._shape, 3),
            self._depth(frame.depth).reshape(self._shape),
            frame.labels.ravel()[self._nearest].reshape(self._shape),
        )

    def _colors(self, rgb: NDArray[np.uint8]) -> NDArray[np.uint8]:
        """Interpolated where the four differ, which is the lesser part of a picture."""
        padded = np.zeros((*rgb.shape[:2], 4), np.uint8)
        padded[..., :3] = rgb
        packed = padded.view(np.uint32)[..., 0]
        right, below = packed[:-1, :-1] == packed[:-1, 1:], packed[:-1, :-1] == packed[1:, :-1]
        equal = np.zeros(packed.shape, np.bool_)
        equal[:-1, :-1] = right & below & (packed[:-1, :-1] == packed[1:, 1:])
        flat = rgb.reshape(-1, 3)
        colors = padded.reshape(-1, 4).view(np.uint32)[self._nearest].view(np.uint8)[:, :3].copy()
        mixed = np.flatnonzero(~equal.ravel()[self._four[0]])
        weights = self._weights[:, mixed, None]
        colors[mixed] = np.rint((flat[self._four[:, mixed]] * weights).sum(axis=0))
        return colors

    def _depth(self, depth: NDArray[np.float32]) -> NDArray[np.float32]:
        """Interpolated where all four are amid a plane: 1 / depth is linear there."""
        inverse = np.divide(1.0, depth, out=np.zeros_like(depth), where=depth > 0.0)
        amid = np.zeros(depth.shape, np.bool_)
        centre = inverse[1:-1, 1:-1]
        bends = [
            np.abs(inverse[1:-1, :-2] - 2.0 * centre + inverse[1:-1, 2:]),
            np.abs(inverse[:-2, 1:-1] - 2.0 * centre + inverse[2:, 1:-1]),
        ]
        amid[1:-1, 1:-1] = np.maximum(*bends) < _PLANE * centre
        all_four = amid.copy()
        all_four[:-1, :-1] &= amid[:-1, 1:] & amid[1:, :-1] & amid[1:, 1:]
        plane = all_four.ravel()[self._four[0]]
        flat = inverse.ravel()
        weighted = np.zeros(len(plane), np.float32)
        for pixels, weights in zip(self._four, self._weights):
            weighted += flat[pixels] * weights
        seen = depth.ravel()[self._nearest]
        np.divide(1.0, weighted, out=seen, where=plane)
        return seen
