# SPDX-License-Identifier: Apache-2.0
"""Segmenters: which pixels show which block.

A segmenter is any function from an :class:`~perception_node.observation.Observation` and the
:class:`Volume` in which blocks can be to :class:`Segments`; a perception is given it by
``Perception(locator, segmenter=…)``, or by its name in ``PerceptionConfig.mask_source``.
"""

from collections.abc import Mapping
from typing import Final

from .checks import check_segments
from .labels import given_labels
from .rgb import find_in_rgb
from .rgbd import find_in_rgbd
from .segments import Segment, Segmenter, Segments, largest_part
from .volume import Volume

#: Names of the segmenters of this package, as the parameter ``mask_source`` has them.
RGBD: Final = "rgbd"
RGB: Final = "rgb"
SEGMENTATION_TOPIC: Final = "segmentation_topic"
SEGMENTERS: Final[Mapping[str, Segmenter]] = {
    RGBD: find_in_rgbd,
    RGB: find_in_rgb,
    SEGMENTATION_TOPIC: given_labels,
}

__all__ = [
    "RGB",
    "RGBD",
    "SEGMENTATION_TOPIC",
    "SEGMENTERS",
    "Segment",
    "Segmenter",
    "Segments",
    "Volume",
    "check_segments",
    "given_labels",
    "largest_part",
]
