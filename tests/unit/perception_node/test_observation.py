# SPDX-License-Identifier: Apache-2.0
"""Images that do not fit together are refused with a sentence."""

from dataclasses import replace
from typing import Any

import numpy as np
import pytest
from perception_scenes import looking_camera

from perception_node.errors import BadImageError
from perception_node.observation import Observation

GOOD = Observation(
    np.zeros((256, 256, 3), np.uint8),
    np.zeros((256, 256), np.uint16),
    np.ones((256, 256), np.float32),
    looking_camera(),
)


def test_a_good_observation_stays_as_it_is() -> None:
    assert GOOD.checked().camera is GOOD.camera
    bare = Observation(GOOD.rgb)
    assert bare.checked() is bare


def test_the_camera_becomes_that_of_the_image() -> None:
    half = Observation(np.zeros((128, 128, 3), np.uint8), camera=GOOD.camera).checked()
    assert half.camera is not None
    assert (half.camera.width, half.camera.height) == (128, 128)


@pytest.mark.parametrize(
    ("damage", "sentence"),
    [
        ({"labels": np.zeros((100, 256), np.uint16)}, "segmentation is 256x100"),
        ({"depth": np.ones((256, 100))}, "depth is 100x256"),
        ({"rgb": np.zeros((256, 256), np.uint8)}, "expected 8-bit RGB"),
        ({"rgb": np.zeros((256, 256, 3))}, "expected 8-bit RGB"),
        ({"rgb": np.zeros((16, 256, 3), np.uint8)}, "256x16 is too small"),
        ({"camera": replace(looking_camera(), height=200)}, "ratio of sides"),
    ],
)
def test_images_that_cannot_be_used_are_refused(damage: dict[str, Any], sentence: str) -> None:
    with pytest.raises(BadImageError, match=sentence):
        replace(GOOD, **damage).checked()
