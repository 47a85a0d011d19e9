# SPDX-License-Identifier: Apache-2.0
"""Blocks: their shapes, and where depth is known their poses and sizes."""

from .blocks import Blocks, centres, find_blocks, measure
from .measure import BlockSurface
from .pose import MeasuredBlock

__all__ = ["BlockSurface", "Blocks", "MeasuredBlock", "centres", "find_blocks", "measure"]
