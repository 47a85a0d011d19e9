# SPDX-License-Identifier: Apache-2.0
"""Blocks: their shapes, and where depth is known their poses and sizes."""

from .blocks import Blocks, centres, find_blocks, measure
from .pose import MeasuredBlock

__all__ = ["Blocks", "MeasuredBlock", "centres", "find_blocks", "measure"]
