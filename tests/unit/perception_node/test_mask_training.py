# SPDX-License-Identifier: Apache-2.0
"""Training of the network that finds blocks in colour: what it is shown, and that it goes on."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest
import torch

from perception_node.errors import DatasetError, WeightsError
from perception_node.segment.mask_network import BEFORE, BLOCK, FREE, REACH
from perception_node.training.mask_trainer import MaskTrainer, MaskTraining
from perception_node.training.mask_views import Views, read_views, shown
from perception_node.training.train_masks import main


def made_up_views(count: int = 2) -> Views:
    """Two blocks one on the other, and something before them."""
    rgb = np.full((count, 64, 80, 3), 180, np.uint8)
    labels = np.zeros((count, 64, 80), np.uint8)
    labels[:, 34:50, 30:46], labels[:, 18:34, 32:46] = 1, 2
    before = np.zeros(labels.shape, bool)
    before[:, 40:60, 60:70] = True
    rgb[labels == 1], rgb[labels == 2], rgb[before] = (200, 30, 30), (30, 30, 200), (90, 90, 90)
    rows = np.full((count, 80), 50, np.float32)
    aside = np.tile(np.arange(-40, 40, dtype=np.float32), (count, 1))
    return Views(rgb, labels, before, rows, aside, np.full(count, 0.26, np.float32))


def test_all_pixels_of_a_block_point_at_one_middle_however_it_is_shown() -> None:
    rng = np.random.default_rng(3)
    views = made_up_views()
    for _ in range(20):
        item = shown(views, 0, 48, rng)
        assert item.rgb.shape == (3, 48, 48) and 0.0 <= item.rgb.min() <= item.rgb.max() <= 1.0
        rows, columns = np.nonzero(item.classes == BLOCK)
        points = np.stack([columns, rows]) + REACH * item.middles[:, rows, columns]
        assert len(np.unique(np.round(points, 2), axis=1).T) <= 2
        # To the right of the middle of the place the way to it is to the left, mirrored or not.
        assert np.ptp(np.abs(np.diff(item.aside))) < 1e-3
        assert set(np.unique(item.classes)) <= {FREE, BLOCK, BEFORE}


def test_a_folder_without_shards_and_a_damaged_one_are_told(tmp_path: Path) -> None:
    with pytest.raises(DatasetError, match="make data-masks"):
        read_views(tmp_path)
    (tmp_path / "shard_0000.npz").write_bytes(b"no archive")
    with pytest.raises(DatasetError, match="delete it"):
        read_views(tmp_path)
    assert main(["--data", str(tmp_path)]) == 2


def test_a_run_that_was_stopped_goes_on_to_the_same_weights(tmp_path: Path) -> None:
    torch.set_num_threads(1)
    config = MaskTraining(steps=4, batch=2, size=48, bfloat16=False, checkpoint_every=2)
    whole = MaskTrainer(made_up_views(), config)
    assert whole.run(lambda *_: True)
    first = MaskTrainer(made_up_views(), config)
    path = tmp_path / "checkpoint.pt"
    assert not first.run(lambda step, _: step < 2, path)
    second = MaskTrainer(made_up_views(), config)
    second.resume(path)
    assert second.run(lambda *_: True)
    for one, other in zip(whole.network.parameters(), second.network.parameters()):
        assert torch.equal(one, other)
    other_run = MaskTrainer(made_up_views(), MaskTraining(steps=5, batch=2, size=48))
    with pytest.raises(WeightsError, match="other hyper-parameters"):
        other_run.resume(path)
