# SPDX-License-Identifier: Apache-2.0
"""Goal images in files: a picture and its segmentation as messages."""

from __future__ import annotations

from pathlib import Path

import numpy as np
from PIL import Image as PngImage
from PIL import UnidentifiedImageError
from sensor_msgs.msg import Image
from std_msgs.msg import Header
from tamp_runtime.messages.images import image_from_array


class ImageFileError(ValueError):
    """A file that is not the image it should be; the sentence names it."""


def read_goal_image(colors: Path, labels: Path) -> tuple[Image, Image]:
    """The picture (rgb8) and its instance labels (16UC1).

    Raises:
        ImageFileError: a file cannot be read, or the labels are not one channel of 8 or 16 bits.
    """
    try:
        with PngImage.open(colors) as picture, PngImage.open(labels) as segmentation:
            pixels = np.asarray(picture.convert("RGB"))
            numbers = np.asarray(segmentation)
    except (OSError, UnidentifiedImageError) as error:
        raise ImageFileError(f"cannot read the goal image: {error}") from error
    if numbers.ndim != 2 or numbers.dtype.kind not in "ui" or numbers.max(initial=0) > 0xFFFF:
        raise ImageFileError(f"{labels} is not an image of labels: one channel of 8 or 16 bits")
    return (
        image_from_array(pixels, "rgb8", Header()),
        image_from_array(numbers.astype(np.uint16), "16UC1", Header()),
    )
