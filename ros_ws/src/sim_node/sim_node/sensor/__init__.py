# SPDX-License-Identifier: Apache-2.0
"""A camera as real ones are: what its sensor, its segmenter and its driver make of exact pictures.

Read it in the order in which a picture passes: :mod:`.config` (what is wrong with the camera),
:mod:`.depth`, :mod:`.color`, :mod:`.segmentation` with the errors of :mod:`.outlines` and
:mod:`.confusions`, all of them brought together in :mod:`.sensor`, and :mod:`.delivery`. None of it
knows ROS but :mod:`.parameters`, and everything is off by default.
"""

from __future__ import annotations

from .config import ColorConfig, DeliveryConfig, DepthConfig, SegmentationConfig, SensorConfig
from .delivery import Delivery, is_lost
from .sensor import sense

__all__ = [
    "ColorConfig",
    "Delivery",
    "DeliveryConfig",
    "DepthConfig",
    "SegmentationConfig",
    "SensorConfig",
    "is_lost",
    "sense",
]
