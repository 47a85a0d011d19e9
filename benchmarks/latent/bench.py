# SPDX-License-Identifier: Apache-2.0
"""What all measurements of one seed share: its encoder, the sets, and the codes of all pictures."""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path
from typing import Final

import numpy as np
from numpy.typing import NDArray

from perception_node.latent.state_encoder import StateEncoder

from .blocks_world import BlocksWorld
from .trainings import cached_codes

#: Of all that measurements draw.
TEST_SEED: Final = 1000


@dataclass(frozen=True)
class Bench:
    """What all measurements of one seed share.

    Attributes:
        folder: of the trained weights.
        encoder: G.
        train, four, five: the sets that models are trained on, and the two unseen ones.
        codes: of the pictures of each set, by its name, shape (s, r, b).
        tasks: number of pairs to plan for.
    """

    folder: Path
    encoder: StateEncoder
    train: BlocksWorld
    four: BlocksWorld
    five: BlocksWorld
    codes: dict[str, NDArray[np.uint8]]
    tasks: int


def open_bench(
    folder: Path, encoder: StateEncoder, sets: dict[str, BlocksWorld], tasks: int
) -> Bench:
    """Encodes all pictures, unless that was done before."""
    codes = {name: cached_codes(folder, name, encoder, world) for name, world in sets.items()}
    return Bench(folder, encoder, sets["train_5"], sets["test_4"], sets["test_5"], codes, tasks)
