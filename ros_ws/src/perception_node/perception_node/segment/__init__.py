# SPDX-License-Identifier: Apache-2.0
"""Segmenters: which pixels show which block.

A segmenter is any function from an :class:`~perception_node.observation.Observation` to
:class:`Segments`; a perception is given it by ``Perception(locator, segmenter=…)``.
"""

from .checks import check_segments
from .labels import given_labels
from .segments import Segment, Segmenter, Segments, largest_part

__all__ = ["Segment", "Segmenter", "Segments", "check_segments", "given_labels", "largest_part"]
