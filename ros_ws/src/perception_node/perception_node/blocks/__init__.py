# SPDX-License-Identifier: Apache-2.0
"""Blocks: their shapes, and where depth is known their poses and sizes."""

from .blocks import Blocks, find_blocks
from .pose import MeasuredBlock

__all__ = ["Blocks", "MeasuredBlock", "find_blocks"]
