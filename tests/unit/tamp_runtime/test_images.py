# SPDX-License-Identifier: Apache-2.0
"""Image messages carry arrays unchanged, and malformed ones are refused with their reason."""

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from sensor_msgs.msg import Image
from std_msgs.msg import Header
from tamp_runtime.messages.images import ImageError, array_from_image, image_from_array

ARRAYS = {
    "rgb8": lambda rng, h, w: rng.integers(0, 256, (h, w, 3)).astype(np.uint8),
    "16UC1": lambda rng, h, w: rng.integers(0, 2**16, (h, w)).astype(np.uint16),
    "32FC1": lambda rng, h, w: rng.normal(size=(h, w)).astype(np.float32),
}


@given(
    st.sampled_from(sorted(ARRAYS)),
    st.integers(1, 9),
    st.integers(1, 9),
    st.integers(0, 2**31),
)
def test_there_and_back_changes_nothing(encoding: str, height: int, width: int, seed: int) -> None:
    pixels = ARRAYS[encoding](np.random.default_rng(seed), height, width)
    image = image_from_array(pixels, encoding, Header(frame_id="camera"))
    assert (image.height, image.width, image.header.frame_id) == (height, width, "camera")
    assert np.array_equal(array_from_image(image, encoding), pixels)


def test_rows_may_be_padded() -> None:
    data = [1, 2, 0, 0, 3, 4, 0, 0]
    image = Image(height=2, width=1, encoding="16UC1", step=4, data=bytes(data))
    assert array_from_image(image, "16UC1").tolist() == [[0x0201], [0x0403]]


def test_big_endian_is_understood() -> None:
    image = Image(height=1, width=1, encoding="16UC1", step=2, data=bytes([1, 2]), is_bigendian=1)
    assert array_from_image(image, "16UC1").tolist() == [[0x0102]]


@pytest.mark.parametrize(
    ("image", "reason"),
    [
        (Image(height=1, width=1, encoding="bgr8", step=3, data=bytes(3)), "'bgr8'"),
        (Image(encoding="rgb8"), "empty"),
        (Image(height=2, width=2, encoding="rgb8", step=6, data=bytes(11)), "11 bytes"),
        (Image(height=2, width=2, encoding="rgb8", step=5, data=bytes(10)), "step 5"),
    ],
)
def test_a_malformed_image_is_refused(image: Image, reason: str) -> None:
    with pytest.raises(ImageError, match=reason):
        array_from_image(image, "rgb8")


def test_an_array_that_does_not_fit_the_encoding_is_refused() -> None:
    with pytest.raises(ImageError, match="float64"):
        image_from_array(np.zeros((2, 2)), "32FC1", Header())
