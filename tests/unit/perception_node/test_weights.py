# SPDX-License-Identifier: Apache-2.0
"""Weights files: what is wrong with one is said in a sentence, and nothing in it is executed."""

import os
import pickle
from pathlib import Path

import pytest
import torch
from safetensors.torch import save_file

from perception_node.errors import WeightsError
from perception_node.visual_module.coordinate_regressor import BACKBONES
from perception_node.visual_module.visual_module import VisualModule
from perception_node.visual_module.weights import (
    DEFAULT_WEIGHTS,
    load_weights,
    read_metadata,
    save_weights,
)


def test_the_weights_that_ship_are_small_and_say_how_they_were_made() -> None:
    assert DEFAULT_WEIGHTS.stat().st_size < 4 * 2**20
    metadata = read_metadata(DEFAULT_WEIGHTS)
    assert metadata["backbone"] in BACKBONES
    assert metadata["image_size"] == "128"
    assert "train_visual" in metadata["command"]
    assert metadata["commit"]


@pytest.mark.parametrize("backbone", ["pointing", "resnet18"])
def test_what_is_saved_is_loaded(tmp_path: Path, backbone: str) -> None:
    module = VisualModule(backbone, 1.6).eval()
    with torch.no_grad():
        for parameter in module.parameters():
            parameter.add_(0.01)
    path = tmp_path / "weights.safetensors"
    save_weights(module, path, {"command": "a test"})
    loaded = load_weights(path)
    assert loaded.translation_factor == 1.6 and not loaded.training
    assert read_metadata(path)["command"] == "a test"
    image, default = torch.rand(2, 3, 128, 128), torch.rand(2, 1, 128, 128)
    with torch.inference_mode():
        for ours, theirs in zip(module(image, default), loaded(image, default)):
            assert torch.allclose(ours, theirs, atol=1e-4)


def refused(path: Path) -> str:
    with pytest.raises(WeightsError) as caught:
        load_weights(path)
    assert caught.value.path == path
    sentence = str(caught.value)
    assert str(path) in sentence and "make train-visual" in sentence
    return sentence


def test_a_missing_file_is_refused(tmp_path: Path) -> None:
    assert "does not exist" in refused(tmp_path / "nowhere.safetensors")


def test_a_folder_is_refused(tmp_path: Path) -> None:
    refused(tmp_path)


@pytest.mark.parametrize("keep", [0, 4, 200, -1000])
def test_a_file_that_was_cut_off_is_refused(tmp_path: Path, keep: int) -> None:
    path = tmp_path / "cut.safetensors"
    path.write_bytes(DEFAULT_WEIGHTS.read_bytes()[:keep])
    assert "damaged" in refused(path)


def test_another_programs_safetensors_file_is_refused(tmp_path: Path) -> None:
    path = tmp_path / "foreign.safetensors"
    save_file({"weight": torch.zeros(3)}, path)
    assert "no weights of module G" in refused(path)


def test_a_pickle_is_refused_and_not_executed(tmp_path: Path) -> None:
    trap = tmp_path / "executed"

    class Payload:
        def __reduce__(self) -> tuple:
            return os.system, (f"touch {trap}",)

    path = tmp_path / "weights.safetensors"
    path.write_bytes(pickle.dumps(Payload()))
    assert "damaged" in refused(path)
    assert not trap.exists()


def test_tensors_of_another_network_are_refused(tmp_path: Path) -> None:
    path = tmp_path / "other.safetensors"
    save_file({"weight": torch.zeros(3)}, path, metadata=read_metadata(DEFAULT_WEIGHTS))
    assert "does not fit" in refused(path)


def test_weights_that_are_not_numbers_are_refused(tmp_path: Path) -> None:
    module = VisualModule()
    with torch.no_grad():
        next(iter(module.parameters())).fill_(float("nan"))
    path = tmp_path / "nan.safetensors"
    save_weights(module, path, {})
    assert "not finite" in refused(path)
