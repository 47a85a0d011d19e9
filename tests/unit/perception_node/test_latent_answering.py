# SPDX-License-Identifier: Apache-2.0
"""Answering questions about images: shared sight, eq. 4.2's settings, and resuming."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest
import torch

from perception_node.errors import WeightsError
from perception_node.latent.answering import (
    ANSWERERS,
    READ_PROGRAMS,
    SHIFTS,
    ManyViews,
    moved,
)
from perception_node.latent.qa_trainer import (
    SETTINGS,
    Asked,
    QaConfig,
    QaTrainer,
    ReaderConfig,
    ReaderTrainer,
)
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


WORDS, ANSWERS = ("", "is", "dark", "bright"), ("no", "yes")


def reader(**changes: object) -> ReaderTrainer:
    told = {"words": WORDS, "answers": ANSWERS, "answerer": "film", "batch": 2, "epochs": 1}
    return ReaderTrainer(asked(), ReaderConfig(**{**told, **changes}))  # type: ignore[arg-type]


def trainer_of(**changes: object) -> QaTrainer:
    read = reader()
    config = QaConfig(SMALL, reader=read.config, batch=2, **changes)  # type: ignore[arg-type]
    return QaTrainer(read.batches.asked, config, read.reader)


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
    trainer = trainer_of(setting=setting, epochs=1)
    before = [parameter.clone() for parameter in trainer.reader.parameters()]
    told: list[dict[str, float]] = []

    def on_step(_step: int, losses: dict[str, float]) -> bool:
        told.append(losses)
        return True

    assert trainer.run(on_step)
    assert trainer.step == 2 and len(told) == 2
    alpha, beta = SETTINGS[setting]
    assert (told[0].get("divergence", 0.0) > 0.0) == (beta > 0.0)
    moved = [
        p.grad is not None and bool(p.grad.any()) for p in trainer.encoder.decoder.parameters()
    ]
    assert any(moved) and alpha + beta > 0.0
    same = list(map(torch.equal, before, trainer.reader.parameters()))
    assert all(same) if beta == 0.0 else not all(same)


def test_a_setting_leaves_the_reader_of_the_others_as_it_is() -> None:
    read = reader()
    before = {name: item.clone() for name, item in read.reader.state_dict().items()}
    config = QaConfig(SMALL, "both", reader=read.config, batch=2, epochs=1)
    assert QaTrainer(read.batches.asked, config, read.reader).run(lambda *_: True)
    assert all(torch.equal(before[name], item) for name, item in read.reader.state_dict().items())


def test_all_views_are_held_equally_likely() -> None:
    torch.manual_seed(0)
    one = ANSWERERS["film"](WORDS, ANSWERS).eval()
    images, owners = torch.rand(2, 3, 128, 128), torch.tensor([0, 1])
    questions, swapped = torch.tensor([[1, 2], [1, 3]]), torch.tensor([[1, 3], [1, 2]])
    near = np.pad(images.numpy(), ((0, 0), (0, 0), (1, 1), (1, 1)), "edge")
    shifted = [
        torch.from_numpy(near[:, :, top : top + 128, left : left + 128].copy())
        for top in range(3)
        for left in range(3)
    ]
    plain = torch.stack([one(view, questions, owners).softmax(1) for view in shifted])
    turned = torch.stack([one(view.flip(3), swapped, owners).softmax(1) for view in shifted])
    all_views = ManyViews(one, WORDS, (("dark", "bright"),))(images, questions, owners)
    assert torch.allclose(all_views.exp(), (plain.mean(0) + turned.mean(0)) / 2.0, atol=1e-6)
    unmirrored = ManyViews(one, WORDS, ())(images, questions, owners)
    assert torch.allclose(unmirrored.exp(), plain.mean(0), atol=1e-6)


@pytest.mark.parametrize(("down", "right"), SHIFTS)
def test_what_an_image_shows_is_moved(down: int, right: int) -> None:
    image = torch.zeros(1, 1, 5, 6)
    image[0, 0, 2, 3] = 1.0
    assert moved(image, down, right).nonzero().tolist() == [[0, 0, 2 + down, 3 + right]]


def test_a_training_goes_on_from_its_checkpoint_as_if_it_had_not_stopped(tmp_path: Path) -> None:
    path = tmp_path / "checkpoint.pt"
    whole = trainer_of(epochs=2)
    assert whole.run(lambda *_: True)
    first = trainer_of(epochs=2)
    assert not first.run(lambda step, _: step < 2, path)
    second = trainer_of(epochs=2)
    second.resume(path)
    assert second.step == 2 and second.run(lambda *_: True)
    for one, other in zip(whole.encoder.parameters(), second.encoder.parameters()):
        assert torch.equal(one, other)
    for one, other in zip(whole.reader.parameters(), second.reader.parameters()):
        assert torch.equal(one, other)
    with pytest.raises(WeightsError, match="other hyper-parameters"):
        trainer_of(epochs=3).resume(path)


def test_an_answerer_goes_on_from_its_checkpoint_as_if_it_had_not_stopped(tmp_path: Path) -> None:
    path = tmp_path / "checkpoint.pt"
    whole = reader()
    assert whole.run(lambda *_: True)
    assert not reader().run(lambda step, _: step < 1, path)
    second = reader()
    second.resume(path)
    assert second.step == 1 and second.run(lambda *_: True)
    for one, other in zip(whole.answerer.parameters(), second.answerer.parameters()):
        assert torch.equal(one, other)


def test_images_are_asked_about_in_a_mirror_by_turns() -> None:
    read = reader(mirrored=(("dark", "bright"),))
    plain = reader()
    for step in range(2):
        images, questions, *_ = plain.batches.at(step)
        shown, told, *_ = read.batches.at(step)
        if step == 0:
            assert torch.equal(shown, images) and torch.equal(told, questions)
        else:
            assert torch.equal(shown, images.flip(3))
            swapped = torch.tensor([0, 1, 3, 2])[questions]
            assert torch.equal(told, swapped)
