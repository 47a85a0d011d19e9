# SPDX-License-Identifier: Apache-2.0
"""Training is self-supervised, learns, and goes on where it was stopped."""

import signal
import subprocess
import sys
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
import torch

from perception_node.errors import DatasetError, WeightsError
from perception_node.segment import Segments
from perception_node.training.augmentation import stretched, turned
from perception_node.training.dataset import place_crops, read_crops, read_scenes
from perception_node.training.train_visual import main
from perception_node.training.trainer import Trainer, TrainingConfig
from perception_node.visual_module.object_images import BLOCK_SIDE, object_images
from perception_node.visual_module.weights import load_weights, read_metadata, save_weights
from sim_node.data_sets import render_shard
from sim_node.world import World

TINY = TrainingConfig(steps=6, batch_scenes=2, checkpoint_every=3)


@pytest.fixture(scope="module")
def folder(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """Three scenes, rendered by the simulator."""
    path = tmp_path_factory.mktemp("scenes")
    layouts = [
        (("red_box", "blue_box"), ("green_box",), ()),
        ((), ("red_box", "green_box", "blue_box"), ()),
        (("green_box",), ("blue_box",), ("red_box",)),
    ]
    with World() as world:
        render_shard(world, enumerate(layouts), path / "shard_0000.npz")
    return path


def losses(trainer: Trainer, steps: int) -> list[float]:
    found: list[float] = []

    def note(step: int, loss: float) -> bool:
        found.append(loss)
        return step < steps

    trainer.run(note)
    return found


def test_the_simulators_data_sets_are_read(folder: Path) -> None:
    scenes = list(read_scenes(folder))
    assert scenes[1].layout == ((), ("red_box", "green_box", "blue_box"), ())
    assert set(scenes[0].label_names.values()) == {"red_box", "blue_box", "green_box"}
    assert scenes[0].depth is not None and scenes[0].depth.shape == (256, 256)


def test_crops_put_back_in_their_places_are_the_objects_images(folder: Path) -> None:
    crops = read_crops(folder)
    assert crops.scenes.tolist() == [0, 3, 6, 9]
    placed = place_crops(crops.pixels.float() / 255.0, crops.corners)
    scenes = list(read_scenes(folder))
    images = np.concatenate(
        [object_images(s.rgb, Segments.from_labels(s.labels)).images for s in scenes]
    )
    assert placed.numpy() == pytest.approx(images, abs=0.5 / 255 + 1e-6)


def test_turned_crops_have_the_outline_of_a_turned_box_and_the_same_extents() -> None:
    sizes = torch.tensor([[20, 24]] * 200)
    whole = place_crops(torch.ones(200, 3, 32, 32), torch.zeros(200, 2, dtype=torch.long), 32)
    whole[:, :, : 32 - 24] = 0.0
    whole[..., 20:] = 0.0
    rng = torch.Generator().manual_seed(0)
    assert torch.equal(turned(whole, sizes, 0.0, rng), whole)
    masks = turned(whole, sizes, 1.0, rng)[:, 0].numpy() > 0.05
    for mask in masks:
        rows, columns = np.nonzero(mask)
        assert (columns.min(), columns.max(), rows.max()) == (0, 19, 31) and rows.min() <= 9
        # Every row and column of a convex outline is one run.
        assert all(np.ptp(np.flatnonzero(line)) + 1 == line.sum() for line in mask if line.any())
        assert all(np.ptp(np.flatnonzero(line)) + 1 == line.sum() for line in mask.T if line.any())
    corner = masks[:, 31, 0]
    assert 0.05 < corner.mean() < 0.9


def test_objects_are_about_as_large_as_in_views_of_one_scale() -> None:
    sizes = torch.tensor([[9, 13]] * 500)
    pixels = torch.ones(500, 3, 32, 32)
    _, wanted = stretched(pixels, sizes, 2.4, torch.Generator().manual_seed(0), BLOCK_SIDE)
    longer = wanted.amax(1).float() / BLOCK_SIDE
    ratio = (wanted[:, 0] / wanted[:, 1]).log().abs()
    assert longer.min() >= 0.7 and longer.max() <= 1.45
    assert ratio.max() < 1.1 and 0.3 < ratio.mean() < 0.6


def test_training_needs_no_ground_truth(folder: Path, tmp_path: Path) -> None:
    with np.load(folder / "shard_0000.npz") as shard:
        np.savez(tmp_path / "shard_0000.npz", rgb=shard["rgb"], labels=shard["labels"])
    ours, theirs = read_crops(tmp_path), read_crops(folder)
    assert torch.equal(ours.pixels, theirs.pixels) and torch.equal(ours.corners, theirs.corners)
    assert len(losses(Trainer(ours, TINY), 2)) == 2


def test_the_loss_falls(folder: Path) -> None:
    config = TrainingConfig(steps=150, batch_scenes=2, damage_share=0.0, learning_rate=3e-3)
    found = losses(Trainer(read_crops(folder), config), 150)
    assert np.mean(found[-5:]) < 0.5 * np.mean(found[:5])


def test_a_resumed_run_is_the_same_as_one_that_was_not_stopped(
    folder: Path, tmp_path: Path
) -> None:
    crops, checkpoint = read_crops(folder), tmp_path / "checkpoint.pt"
    whole = Trainer(crops, TINY)
    expected = losses(whole, 6)
    first = Trainer(crops, TINY)
    found = losses(first, 3)
    first.save(checkpoint)
    second = Trainer(crops, TINY)
    second.resume(checkpoint)
    assert found + losses(second, 6) == pytest.approx(expected, rel=1e-5)
    for ours, theirs in zip(second.module.parameters(), whole.module.parameters()):
        assert torch.allclose(ours, theirs, atol=1e-6)


def test_a_run_can_begin_with_the_weights_of_another_one(folder: Path, tmp_path: Path) -> None:
    crops, path = read_crops(folder), tmp_path / "weights.safetensors"
    first = Trainer(crops, TINY)
    losses(first, 2)
    save_weights(first.module, path, {})
    begun = Trainer(crops, replace(TINY, start=str(path)))
    for ours, theirs in zip(begun.module.parameters(), first.module.parameters()):
        assert torch.equal(ours, theirs)
    with pytest.raises(WeightsError, match="does not exist"):
        Trainer(crops, replace(TINY, start=str(tmp_path / "none")))


def test_a_checkpoint_of_another_run_is_refused(folder: Path, tmp_path: Path) -> None:
    crops, checkpoint = read_crops(folder), tmp_path / "checkpoint.pt"
    Trainer(crops, TINY).save(checkpoint)
    other = Trainer(crops, TrainingConfig(steps=7))
    with pytest.raises(WeightsError, match="other hyper-parameters"):
        other.resume(checkpoint)
    checkpoint.write_bytes(b"not a checkpoint")
    with pytest.raises(WeightsError, match="damaged"):
        other.resume(checkpoint)


def test_the_command_trains_and_goes_on(
    folder: Path, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    arguments = ["--data", str(folder), "--run", str(tmp_path), "--threads", "1"]
    arguments += ["--steps", "2", "--batch-scenes", "2"]
    assert main(arguments) == 0
    weights = tmp_path / "visual_module.safetensors"
    assert load_weights(weights).backbone == "pointing"
    # The header's command repeats the run: given to the same folder, there is nothing left to do.
    command = read_metadata(weights)["command"].partition("train_visual ")[2].split()
    assert main([*command, "--run", str(tmp_path), "--threads", "1"]) == 0
    assert "going on from step 2 of 2" in capsys.readouterr().out


def test_ctrl_c_stops_after_a_whole_step_and_saves(folder: Path, tmp_path: Path) -> None:
    command = [sys.executable, "-m", "perception_node.training.train_visual", "--data", str(folder)]
    command += ["--run", str(tmp_path), "--threads", "1", "--no-bfloat16", "--steps", "100000"]
    process = subprocess.Popen(command, stderr=subprocess.PIPE, stdout=subprocess.PIPE, text=True)
    assert process.stderr is not None
    seen = ""
    while "loss=" not in seen:
        seen += process.stderr.read(1)
        assert process.poll() is None, seen
    process.send_signal(signal.SIGINT)
    output, errors = process.communicate(timeout=120)
    assert process.returncode == 130
    assert "the same command goes on from there" in output and "Traceback" not in errors
    trainer = Trainer(read_crops(folder), TrainingConfig(steps=100000))
    trainer.resume(tmp_path / "checkpoint.pt")
    assert trainer.step >= 1


def test_the_command_says_what_is_missing(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    assert main(["--data", str(tmp_path / "none"), "--run", str(tmp_path)]) == 2
    assert "render a data set" in capsys.readouterr().err


def test_a_damaged_shard_is_refused(tmp_path: Path) -> None:
    (tmp_path / "shard_0000.npz").write_bytes(b"PK\x03\x04 and nothing else")
    with pytest.raises(DatasetError, match="damaged"):
        read_crops(tmp_path)
    np.savez(tmp_path / "shard_0000.npz", rgb=np.zeros((1, 64, 64, 3), np.uint8))
    with pytest.raises(DatasetError, match="lacks labels"):
        read_crops(tmp_path)


def test_scenes_without_usable_objects_are_refused(tmp_path: Path) -> None:
    rgb, labels = np.zeros((1, 64, 64, 3), np.uint8), np.zeros((1, 64, 64), np.uint16)
    np.savez(tmp_path / "shard_0000.npz", rgb=rgb, labels=labels)
    with pytest.raises(DatasetError, match="no objects"):
        read_crops(tmp_path)
