# SPDX-License-Identifier: Apache-2.0
"""All that happens to a picture until it is on its way."""

from __future__ import annotations

from collections.abc import Sequence
from typing import TYPE_CHECKING, Final

import numpy as np

from .color import with_color_errors
from .config import SensorConfig
from .depth import with_depth_errors
from .segmentation import with_label_errors

if TYPE_CHECKING:
    from sim_node.frame import Frame

# Each stage draws by itself, so that one can be switched on without changing the others.
_SEGMENTATION: Final = 0
_DEPTH: Final = 1
_COLOR: Final = 2
DELIVERY: Final = 3


def stage_random(config: SensorConfig, picture: Sequence[int], stage: int) -> np.random.Generator:
    """What one stage draws from, for one picture.

    Args:
        picture: numbers from 0 that tell it from all others: of the scene's seed, of the camera,
            and of the picture since the scene was reset.
    """
    return np.random.default_rng([config.seed, *picture, stage])


def sense(frame: Frame, config: SensorConfig, picture: Sequence[int] = (0, 0, 0)) -> Frame:
    """What a camera makes of an exact frame; the very same one where it changes nothing.

    Args:
        picture: as for :func:`stage_random`; the same numbers give the same errors.
    """
    exact = frame
    if not config.segmentation.is_exact:
        random = stage_random(config, picture, _SEGMENTATION)
        frame = with_label_errors(exact, config.segmentation, random)
    if not config.depth.is_exact:
        frame = with_depth_errors(frame, config.depth, stage_random(config, picture, _DEPTH))
    if not config.color.is_exact:
        frame = with_color_errors(frame, config.color, stage_random(config, picture, _COLOR))
    return frame
