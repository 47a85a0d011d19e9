# SPDX-License-Identifier: Apache-2.0
"""Pictures that are kept are those in which something moved, and training reads them."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

from perception_node.errors import DatasetError
from perception_node.observation import Observation
from perception_node.segment import Segments
from perception_node.training.dataset import read_crops
from perception_node.training.recording import SHARD, Recorder
from perception_node.training.trainer import Trainer, TrainingConfig


def shown(column: int, blocks: int = 2, side: int = 128) -> tuple[Observation, Segments]:
    """Blocks of 10 px on one another; their tower stands at a column."""
    rgb, labels = np.zeros((side, side, 3), np.uint8), np.zeros((side, side), np.uint16)
    for number in range(blocks):
        where = np.s_[100 - 10 * number : 110 - 10 * number, column : column + 10]
        rgb[where] = (200, 40 * number, 30)
        labels[where] = number + 1
    depth = np.ones((side, side), np.float32)
    return Observation(rgb, None, depth), Segments.from_labels(labels)


def test_a_picture_is_kept_when_something_moved(tmp_path: Path) -> None:
    recorder = Recorder(tmp_path / "new" / "folder")
    kept = [recorder.take(*shown(column)) for column in (10, 10, 11, 40, 40, 10)]
    assert kept == [True, False, True, True, False, True]
    assert not recorder.take(shown(60)[0], None)
    assert not recorder.take(*shown(60, blocks=0))
    assert recorder.kept == 4


def test_training_reads_what_was_kept(tmp_path: Path) -> None:
    recorder = Recorder(tmp_path)
    columns = [3 * number for number in range(SHARD + 3)]
    for column in columns:
        assert recorder.take(*shown(column))
    assert len(list(tmp_path.glob("shard_*.npz"))) == 1
    recorder.flush()
    recorder.flush()
    crops = read_crops(tmp_path)
    assert len(crops.scenes) - 1 == len(columns)
    assert crops.corners[::2, 0].tolist() == columns
    trainer = Trainer(crops, TrainingConfig(steps=1, batch_scenes=2))
    assert trainer.run(lambda *_: True)


def test_what_a_folder_holds_stays(tmp_path: Path) -> None:
    for column in (10, 50):
        recorder = Recorder(tmp_path)
        assert recorder.take(*shown(column))
        recorder.flush()
    assert read_crops(tmp_path).corners[::2, 0].tolist() == [10, 50]


def test_pictures_of_other_sizes_and_without_depth_go_to_files_of_their_own(tmp_path: Path) -> None:
    recorder = Recorder(tmp_path)
    small, large = shown(10), shown(10, side=256)
    for observation, segments in (small, large, (replace(large[0], depth=None), large[1]), small):
        recorder.take(observation, segments)
    recorder.flush()
    assert recorder.kept == 3
    assert len(list(tmp_path.glob("shard_*.npz"))) == 3


def test_most_scenes_decide_how_many_blocks_a_batch_has(tmp_path: Path) -> None:
    recorder = Recorder(tmp_path)
    for column, blocks in ((10, 2), (30, 2), (50, 2), (70, 5)):
        recorder.take(*shown(column, blocks))
    recorder.flush()
    trainer = Trainer(read_crops(tmp_path), TrainingConfig(steps=1, batch_scenes=3))
    _, target, _ = trainer._batch()
    assert target.shape[:2] == (3, 2)


def test_a_folder_that_cannot_be_written_is_told(tmp_path: Path) -> None:
    file = tmp_path / "file"
    file.write_text("")
    with pytest.raises(DatasetError, match=str(file)):
        Recorder(file / "folder")
