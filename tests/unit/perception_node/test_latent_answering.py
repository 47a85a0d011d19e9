# SPDX-License-Identifier: Apache-2.0
"""Answering questions about images: shared sight, eq. 4.2's settings, and resuming."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest
import torch

from perception_node.errors import WeightsError
from perception_node.latent.answering import ANSWERERS, READ_PROGRAMS
from perception_node.latent.qa_trainer import SETTINGS, Asked, QaConfig, QaTrainer
from perception_node.latent.state_encoder import EncoderConfig

SMALL = EncoderConfig(width=4)


def asked(images: int = 4) -> Asked:
    """Is it dark? of images that are, and are not; two words, of which the second one is 2 or 3."""
    rng = np.random.default_rng(0)
    dark = np.arange(images) % 2 == 0
    pictures = (
        rng.integers(0, 60, (images, 128, 128, 3)) + np.where(dark, 0, 190)[:, None, None, None]
    )
    owners = np.repeat(np.arange(images), 2)
    questions = np.tile(np.array([[1, 2, 0], [1, 3, 0]]), (images, 1))
    answers = np.where(dark[owners] == (questions[:, 1] == 2), 1, 0)
    return Asked(pictures.astype(np.uint8), questions, owners, answers)


def config(**changes: object) -> QaConfig:
    words, answers = ("", "is", "dark", "bright"), ("no", "yes")
    told = {"words": words, "answers": answers, "answerer": "film", "batch": 2, **changes}
    return QaConfig(SMALL, **told)  # type: ignore[arg-type]


@pytest.mark.parametrize("name", sorted(ANSWERERS.keys() - READ_PROGRAMS))
def test_a_question_is_answered_alike_whatever_is_asked_beside_it(name: str) -> None:
    torch.manual_seed(0)
    answerer = ANSWERERS[name](tuple("abcdef"), tuple("xyz")).eval()
    images = torch.rand(2, 3, 128, 128)
    questions = torch.tensor([[1, 2, 3], [4, 5, 0], [2, 0, 0]])
    together = answerer(images, questions, torch.tensor([0, 0, 1]))
    alone = answerer(images[1:], questions[2:, :1], torch.tensor([0]))
    assert together.shape == (3, 3)
    assert torch.allclose(together[2], alone[0], atol=1e-4)
    assert not torch.allclose(together[0], together[1], atol=1e-4)


@pytest.mark.parametrize("setting", SETTINGS)
def test_each_setting_trains_what_it_names(setting: str) -> None:
    trainer = QaTrainer(asked(), config(setting=setting, epochs=1))
    told: list[dict[str, float]] = []

    def on_step(_step: int, losses: dict[str, float]) -> bool:
        told.append(losses)
        return True

    assert trainer.run(on_step)
    assert trainer.step == 2 and len(told) == 2
    alpha, beta = SETTINGS[setting]
    assert (told[0]["divergence"] > 0.0) == (beta > 0.0)
    moved = [
        p.grad is not None and bool(p.grad.any()) for p in trainer.encoder.decoder.parameters()
    ]
    assert any(moved) and alpha + beta > 0.0


def test_a_training_goes_on_from_its_checkpoint_as_if_it_had_not_stopped(tmp_path: Path) -> None:
    path = tmp_path / "checkpoint.pt"
    whole = QaTrainer(asked(), config(epochs=2))
    assert whole.run(lambda *_: True)
    first = QaTrainer(asked(), config(epochs=2))
    assert not first.run(lambda step, _: step < 2, path)
    second = QaTrainer(asked(), config(epochs=2))
    second.resume(path)
    assert second.step == 2 and second.run(lambda *_: True)
    for one, other in zip(whole.answerer.parameters(), second.answerer.parameters()):
        assert torch.equal(one, other)
    with pytest.raises(WeightsError, match="other hyper-parameters"):
        QaTrainer(asked(), config(epochs=3)).resume(path)
