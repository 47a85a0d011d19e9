# SPDX-License-Identifier: Apache-2.0
"""Pictures to make errors in."""

from __future__ import annotations

import numpy as np

from sim_node.camera import Frame

#: Rows and columns of the blocks in the picture of :func:`table`, by label: 3 stands on 7.
BLOCKS = {3: np.s_[30:50, 20:40], 7: np.s_[50:70, 20:40], 5: np.s_[40:60, 80:100]}


def table() -> Frame:
    """A table seen from above one side, blocks 10 cm before it, and nothing at the top."""
    rows, columns = np.mgrid[:96, :128]
    depth = 1.0 / (0.4 + 0.008 * rows)
    labels = np.zeros(depth.shape, np.uint16)
    for label, region in BLOCKS.items():
        labels[region] = label
    depth[labels > 0] -= 0.1
    depth[:12] = 0.0
    rgb = np.stack([rows, columns, rows + columns], axis=-1).astype(np.uint8)
    return Frame(rgb, depth.astype(np.float32), labels)


def even(depth: float, value: int = 100, side: int = 300) -> Frame:
    """A wall of one colour and depth [m], without a block."""
    shape = (side, side)
    return Frame(
        np.full((*shape, 3), value, np.uint8),
        np.full(shape, depth, np.float32),
        np.zeros(shape, np.uint16),
    )
