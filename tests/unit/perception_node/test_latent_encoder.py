# SPDX-License-Identifier: Apache-2.0
"""The state encoder: codes of bits, what settles, and a training that goes on where it stopped."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest
import torch

from perception_node.errors import BadImageError, WeightsError
from perception_node.latent.objective import turned
from perception_node.latent.quantiser import QUANTISERS, quantiser_named
from perception_node.latent.state_encoder import EncoderConfig, StateEncoder, pack
from perception_node.latent.trainer import EncoderTrainer, TrainingConfig
from perception_node.latent.weights import load_encoder, save_encoder

SMALL = EncoderConfig(width=4)


def pictures(states: int = 3, renders: int = 2) -> np.ndarray:
    rng = np.random.default_rng(0)
    return rng.integers(0, 256, (states, renders, 128, 128, 3), dtype=np.uint8)


@pytest.mark.parametrize("name", QUANTISERS)
def test_bits_tell_all_that_the_decoder_gets(name: str) -> None:
    torch.manual_seed(0)
    quantiser = quantiser_named(name, 8)
    features = torch.randn(2, 8, 32, 32)
    quantiser.train()
    quantiser(features)
    quantiser.eval()
    quantised, bits, own = quantiser(features)
    assert set(bits.unique().tolist()) <= {0.0, 1.0}
    assert bits.shape == (2, quantiser.bits, 32, 32) and own.ndim == 0
    assert torch.allclose(quantiser.embedded(bits), quantised, atol=1e-5)


@pytest.mark.parametrize("name", QUANTISERS)
def test_gradients_pass_through_a_quantiser(name: str) -> None:
    torch.manual_seed(0)
    quantiser = quantiser_named(name, 8).train()
    features = torch.randn(2, 8, 32, 32, requires_grad=True)
    quantised, _, own = quantiser(features)
    (quantised.square().sum() + own).backward()
    assert features.grad is not None and float(features.grad.abs().sum()) > 0.0


def test_an_unknown_quantiser_is_refused_with_those_there_are() -> None:
    with pytest.raises(ValueError, match="binary, fsq, vq"):
        quantiser_named("teapot", 8)


def test_bits_agree_best_with_features_that_give_them_with_a_margin() -> None:
    quantiser = quantiser_named("binary", 8)
    bits = torch.randint(2, (1, 8, 32, 32)).float()
    signs = 2.0 * bits - 1.0
    levels = [float(quantiser.disagreement(scale * signs, bits)) for scale in (-1.0, 0.1, 1.0, 5.0)]
    assert levels == sorted(levels, reverse=True)


def test_a_code_is_packed_and_unpacked_as_it_is() -> None:
    encoder = StateEncoder(SMALL)
    codes = np.random.default_rng(1).integers(0, 256, (5, encoder.bits // 8), dtype=np.uint8)
    assert np.array_equal(pack(encoder.unpack(codes)), codes)


def test_a_code_that_stays_what_it_is_is_told_from_one_that_does_not() -> None:
    torch.manual_seed(3)
    encoder = StateEncoder(SMALL).eval()
    codes = encoder.encode(pictures()[:, 0], snapped=False)
    settled, stable = encoder.settle(codes)
    again = encoder.encode(encoder.decode(settled), snapped=False)
    # Decoded pictures are rounded to 255 levels here, which codes near a threshold may feel.
    assert settled.shape == codes.shape and stable.shape == (3,)
    twice, still = encoder.settle(settled[stable])
    assert np.array_equal(twice, settled[stable]) and still.all()
    assert again.shape == codes.shape


@pytest.mark.parametrize("shape", [(1, 64, 64, 3), (1, 128, 128), (1, 128, 128, 4)])
def test_pictures_of_another_size_are_refused(shape: tuple[int, ...]) -> None:
    with pytest.raises(BadImageError, match="128, 128, 3"):
        StateEncoder(SMALL).encode(np.zeros(shape, np.uint8))


def test_about_as_many_bits_are_turned_as_asked() -> None:
    bits = torch.zeros(20, 8, 32, 32)
    share = float(turned(bits, 0.02, torch.Generator().manual_seed(0)).mean())
    assert 0.01 < share < 0.03
    assert torch.equal(turned(bits, 0.0, torch.Generator().manual_seed(0)), bits)


def test_a_training_goes_on_from_its_checkpoint_as_if_it_had_not_stopped(tmp_path: Path) -> None:
    path = tmp_path / "checkpoint.pt"
    config = TrainingConfig(SMALL, steps=4, batch=2)
    whole = EncoderTrainer(pictures(), config)
    assert whole.run(lambda *_: True)
    first = EncoderTrainer(pictures(), config)
    assert not first.run(lambda step, _: step < 2, path)
    second = EncoderTrainer(pictures(), config)
    second.resume(path)
    assert second.step == 2 and second.run(lambda *_: True)
    for one, other in zip(whole.encoder.parameters(), second.encoder.parameters()):
        assert torch.equal(one, other)
    with pytest.raises(WeightsError, match="other hyper-parameters"):
        EncoderTrainer(pictures(), TrainingConfig(SMALL, steps=5, batch=2)).resume(path)
    path.write_bytes(b"no checkpoint")
    with pytest.raises(WeightsError, match="damaged"):
        second.resume(path)


def test_weights_come_back_as_they_were(tmp_path: Path) -> None:
    path = tmp_path / "encoder.safetensors"
    encoder = StateEncoder(SMALL).eval()
    save_encoder(encoder, path, {"commit": "none"})
    images = pictures()[:, 0]
    assert np.array_equal(load_encoder(path).encode(images), encoder.encode(images))


@pytest.mark.parametrize("content", [None, b"", b"nonsense" * 10])
def test_a_file_that_is_no_encoder_is_refused(tmp_path: Path, content: bytes | None) -> None:
    path = tmp_path / "encoder.safetensors"
    if content is not None:
        path.write_bytes(content)
    with pytest.raises(WeightsError, match="train-latent"):
        load_encoder(path)
