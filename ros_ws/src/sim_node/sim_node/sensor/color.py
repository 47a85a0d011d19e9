# SPDX-License-Identifier: Apache-2.0
"""What a colour camera makes of exact colours."""

from __future__ import annotations

from dataclasses import replace
from typing import TYPE_CHECKING

import numpy as np

from .config import ColorConfig

if TYPE_CHECKING:
    from sim_node.frame import Frame


def with_color_errors(frame: Frame, config: ColorConfig, rng: np.random.Generator) -> Frame:
    """A frame in another light: values times exposure and cast, saturated at 255, then noise.

    Values are taken as they are, as if the camera had no gamma.
    """
    gains = np.float32(config.exposure) * np.array(config.cast, np.float32)
    values = np.minimum(frame.rgb * gains, np.float32(255.0))
    if config.noise > 0.0:
        values += np.float32(config.noise) * rng.standard_normal(values.shape, np.float32)
    return replace(frame, rgb=np.clip(np.rint(values), 0.0, 255.0).astype(np.uint8))
