# SPDX-License-Identifier: Apache-2.0
"""What a colour camera makes of exact colours."""

from __future__ import annotations

from dataclasses import replace
from typing import TYPE_CHECKING, Final

import cv2
import numpy as np
from numpy.typing import NDArray
from scipy.special import ndtr

from .config import ColorConfig

if TYPE_CHECKING:
    from sim_node.frame import Frame

Rgb = NDArray[np.uint8]
Light = NDArray[np.float32]

#: Beyond so many standard deviations a Gaussian is cut off; 0.02 of 255 grey levels lie there.
_GAUSSIAN_REACH: Final = 4.0


def with_color_errors(frame: Frame, config: ColorConfig, rng: np.random.Generator) -> Frame:
    """A frame through a lens, in another light, on a sensor, and compressed.

    In the order in which they happen: light is blurred, it is multiplied by exposure and cast, the
    sensor saturates at 255 and adds its noise, and what is read out is compressed. Values are taken
    as they are, as if the camera had no gamma.
    """
    gains = np.float32(config.exposure) * np.array(config.cast, np.float32)
    light = blurred(frame.rgb.astype(np.float32), config.blur)
    values = np.minimum(light * gains, np.float32(255.0))
    if config.noise > 0.0:
        values += np.float32(config.noise) * rng.standard_normal(values.shape, np.float32)
    rgb = np.clip(np.rint(values), 0.0, 255.0).astype(np.uint8)
    return replace(frame, rgb=compressed(rgb, config.jpeg_quality))


def blurred(light: Light, sigma: float) -> Light:
    """Light under a Gaussian, shape (h, w, 3); its mean stays, as borders reflect.

    Every pixel is a square of even light, and its new value is what comes to its middle: of an edge
    between two pixels Φ(x/σ) is left, x from the edge to the middle, however small σ is.

    Args:
        light: shape (h, w, 3).
        sigma: standard deviation [px]; 0: light stays what it is.
    """
    if sigma == 0.0:
        return light
    reach = int(np.ceil(_GAUSSIAN_REACH * sigma))
    borders = ndtr((np.arange(2 * reach + 2) - reach - 0.5) / sigma)
    kernel = np.diff(borders) / (borders[-1] - borders[0])
    spread = cv2.sepFilter2D(light, cv2.CV_32F, kernel, kernel, borderType=cv2.BORDER_REFLECT)
    return np.asarray(spread, np.float32)


def compressed(rgb: Rgb, quality: int) -> Rgb:
    """A picture after JPEG by OpenCV, with half as many colours as pixels each way (4:2:0).

    Args:
        rgb: shape (h, w, 3).
        quality: 1..100; 0: the picture stays what it is.

    Raises:
        ValueError: OpenCV cannot compress such a picture.
    """
    if quality == 0:
        return rgb
    done, data = cv2.imencode(
        ".jpg", cv2.cvtColor(rgb, cv2.COLOR_RGB2BGR), [cv2.IMWRITE_JPEG_QUALITY, quality]
    )
    bgr = cv2.imdecode(data, cv2.IMREAD_COLOR) if done else None
    if bgr is None:
        raise ValueError(f"a picture of {rgb.shape[1]}x{rgb.shape[0]} cannot become a JPEG")
    return cv2.cvtColor(bgr, cv2.COLOR_BGR2RGB).astype(np.uint8)
