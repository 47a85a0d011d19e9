# SPDX-License-Identifier: Apache-2.0
"""How easily codes are read: what the best linear map names of the things where they stand.

The encoder stays as it is and the map is found in closed form, so every encoder's reader has the
same capacity and is trained to its end. Where a thing stands, and what it is like, is told by the
true graph: this measures codes and trains none.
"""

from __future__ import annotations

from typing import Final

import numpy as np
import torch
from numpy.typing import NDArray
from torch import Tensor, nn

from perception_node.latent.networks import IMAGE, MAP
from perception_node.latent.state_encoder import StateEncoder, values_of

from .clevr.dataset import CAMERA, ClevrSet
from .clevr.things import ATTRIBUTES, Scene

#: Edge of the square of places around a thing that is read; covers a large one.
_EDGE: Final = 3
_PENALTY: Final = 30.0
_BATCH: Final = 64


def words_named_right(
    encoder: StateEncoder, train: ClevrSet, test: ClevrSet
) -> tuple[NDArray[np.bool_], NDArray[np.int64]]:
    """Which words of which things of the test a linear reader of codes names right.

    Returns:
        For each thing and attribute, shape (k, 3), and the scene of each thing, (k,).
    """
    codes, words, _ = _things_of(encoder, train)
    seen, said, owners = _things_of(encoder, test)
    spread = codes.T @ codes + _PENALTY * torch.eye(codes.shape[1])
    right = []
    for column, known in enumerate(ATTRIBUTES.values()):
        told = nn.functional.one_hot(words[:, column], len(known)).float()
        named = (seen @ torch.linalg.solve(spread, codes.T @ told)).argmax(1)
        right.append((named == said[:, column]).numpy())
    return np.column_stack(right), owners


@torch.inference_mode()
def _things_of(encoder: StateEncoder, data: ClevrSet) -> tuple[Tensor, Tensor, NDArray[np.int64]]:
    """Codes around things and 1, (k, 9 o + 1); numbers of their words, (k, 3); scenes, (k,)."""
    encoder.eval()
    around, words = [], []
    for start in range(0, len(data.images), _BATCH):
        shown = values_of(data.images[start : start + _BATCH])
        codes = encoder.quantiser.embedded(encoder.quantiser(encoder.encoder(shown))[1])
        reach = _EDGE // 2
        wide = nn.functional.pad(codes, (reach,) * 4)
        for map_, scene in zip(wide, data.scenes[start : start + _BATCH]):
            for (column, row), thing in zip(places_of(scene), scene):
                around.append(map_[:, row : row + _EDGE, column : column + _EDGE].flatten())
                words.append(
                    [known.index(getattr(thing, name)) for name, known in ATTRIBUTES.items()]
                )
    read = torch.stack(around)
    owners = np.repeat(np.arange(len(data.scenes)), list(map(len, data.scenes)))
    return torch.cat([read, torch.ones(len(read), 1)], 1), torch.tensor(words), owners


def places_of(scene: Scene) -> NDArray[np.int64]:
    """Columns and rows of the places of codes that show the middles of things, shape (k, 2)."""
    middles = np.array([thing.position_world for thing in scene])
    pixels = CAMERA.pixels(middles)[:, :2] * (IMAGE / np.array([CAMERA.width, CAMERA.height]))
    return np.clip(pixels // (IMAGE // MAP), 0, MAP - 1).astype(np.int64)
