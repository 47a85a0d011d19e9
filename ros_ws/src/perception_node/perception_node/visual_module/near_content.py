# SPDX-License-Identifier: Apache-2.0
"""The pointing regressor of images that are zero but near their content: a quarter of its work.

Far from the content every layer is what it is of an empty image, which is known beforehand. So each
layer is computed where something differs from that only, which grows by its kernels' reach.
"""

from __future__ import annotations

from pathlib import Path
from typing import Any, Final

import numpy as np
import torch
from numpy.typing import NDArray
from tamp_runtime.machine_code import address, written
from torch import Tensor, nn
from torch.nn import functional

from .coordinate_regressor import PointingRegressor

Array = NDArray[np.float32]

#: Content may fill this part of an image's side; of more, all is computed.
MOST: Final = 0.4
#: Squares' sides are multiples of this [px]: torch keeps what it made ready for few sizes.
STEP: Final = 8
_FILE: Final = Path(__file__).with_suffix(".c")


class NearContent(nn.Module):
    """A pointing regressor π for inference; it gives the same φ."""

    def __init__(self, regressor: PointingRegressor, size: int) -> None:
        """``size``: side of the images whose content is looked for [px]."""
        super().__init__()
        self.regressor, self.size = regressor, size
        self._blocks: list[Any] = list(regressor.features)
        self._empty: list[Array] = []
        image = torch.zeros(1, 3, size, size)
        with torch.inference_mode():
            for block in self._blocks:
                padded = functional.pad(image, (block[0].padding[0],) * 4)
                self._empty.append(_by_pixels(padded)[0])
                image = block(image)
            self._heat = _by_pixels(regressor.heat(image))

    def forward(self, images: Tensor) -> Tensor:
        """u_i in 0..1, shape (n, 3, size, size) -> φ, shape (n, 2)."""
        found = images.numpy()
        start, side = _content(found)
        if found.shape[2:] != (self.size, self.size) or side > MOST * self.size:
            return self.regressor(images)
        patch = np.empty((len(found), side, side, 3), np.float32)
        for own, image, (row, column) in zip(patch, found, start):
            own[:] = image[:, row : row + side, column : column + side].transpose(1, 2, 0)
        for block, empty in zip(self._blocks, self._empty):
            convolution, rest = block[0], block[1:]
            stride, border = convolution.stride[0], convolution.padding[0]
            spread = convolution.dilation[0] * (convolution.kernel_size[0] - 1)
            outputs = (len(empty) - spread - 1) // stride + 1
            # The outputs that depend on the patch, and the inputs that those depend on.
            extent = min((side - 1 + spread) // stride + 1, outputs)
            begin = np.clip(-((spread - border - start) // stride), 0, outputs - extent)
            inputs = (extent - 1) * stride + spread + 1
            first = begin * stride
            around = _surrounded(patch, empty, first, inputs, start + border - first)
            seen = functional.conv2d(
                torch.from_numpy(around).permute(0, 3, 1, 2), convolution.weight,
                convolution.bias, stride, 0, convolution.dilation,
            )  # fmt: skip
            patch, start, side = _by_pixels(rest(seen)), begin, extent
        heat = self._heat.repeat(len(patch), axis=0)
        near = self.regressor.heat(torch.from_numpy(patch).permute(0, 3, 1, 2))
        _paste(heat, _by_pixels(near), start)
        return self.regressor.pointed(torch.from_numpy(heat).permute(0, 3, 1, 2))


def _by_pixels(maps: Tensor) -> Array:
    """(n, channels, rows, columns) -> (n, rows, columns, channels)."""
    return np.ascontiguousarray(maps.permute(0, 2, 3, 1).numpy())


def _surrounded(
    patch: Array, empty: Array, first: NDArray[np.intp], side: int, at: NDArray[np.intp]
) -> Array:
    """Squares with what is around them in an empty image.

    Args:
        patch: shape (n, s, s, channels).
        empty: what the image is like without content, shape (height, width, channels).
        first: where the larger squares begin in it, (row, column), shape (n, 2).
        side: theirs [px].
        at: where the patches begin in those, likewise.

    Returns:
        Shape (n, side, side, channels).
    """
    library = written(_FILE)
    around = np.empty((len(patch), side, side, empty.shape[2]), np.float32)
    if library is None:
        for own, (row, column) in zip(around, first):
            own[:] = empty[row : row + side, column : column + side]
        _paste(around, patch, at)
        return around
    begins = np.concatenate([first, at], axis=1).astype(np.intc)
    images = map(address, (patch, np.ascontiguousarray(empty), begins, around))
    library.surrounded(len(patch), patch.shape[1], side, *empty.shape[1:], *images)
    return around


def _paste(whole: Array, parts: Array, start: NDArray[np.intp]) -> None:
    """Puts squares into n maps, from (row, column) on, shape (n, 2)."""
    side = parts.shape[1]
    for own, part, (row, column) in zip(whole, parts, start):
        own[row : row + side, column : column + side] = part


def _content(images: Array) -> tuple[NDArray[np.intp], int]:
    """Squares of one side, one for each image, outside of which it is zero.

    Returns:
        Where they begin, (row, column), shape (n, 2), and their side [px].
    """
    library, (height, width) = written(_FILE), images.shape[2:]
    if library is None:
        first, last = ends_by_numpy(images)
    else:
        found, own = np.empty((2, len(images), 2), np.int64), np.ascontiguousarray(images)
        library.content(*images.shape, address(own), address(found[0]), address(found[1]))
        first, last = found
    side = -(-max(int((last - first).max(initial=1)), 1) // STEP) * STEP
    return np.clip(first, 0, np.array([height, width]) - side), side


def ends_by_numpy(images: Array) -> tuple[NDArray[np.intp], NDArray[np.intp]]:
    """First row and column of each image that is not zero, and those after the last, (n, 2) each.

    Of an empty image 0 and its sides.
    """
    used: Any = images.any(axis=1)
    ends = []
    for axis in (2, 1):
        lines: Any = used.any(axis=axis)
        ends.append((lines.argmax(axis=1), lines.shape[1] - lines[:, ::-1].argmax(axis=1)))
    first, last = (np.stack(end, axis=-1) for end in zip(*ends))
    return first, last
