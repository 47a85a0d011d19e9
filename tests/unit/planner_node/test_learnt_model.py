# SPDX-License-Identifier: Apache-2.0
"""The learnt action model: what it copies, what it drops, and that its training is a function."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest
import torch
from numpy.typing import NDArray

from planner_node.action_models.effect_network import (
    Discriminator,
    EffectConfig,
    EffectNetwork,
)
from planner_node.action_models.learnt import LearntModel
from planner_node.action_models.training import (
    THESIS,
    ActionTrainer,
    ActionTraining,
    CheckpointError,
    Transitions,
)
from planner_node.action_models.weights import (
    ModelWeightsError,
    load_action_model,
    save_action_model,
)
from planner_node.latent_plans import LatentPlanner, Read, StrangePictureError
from planner_node.search.on_models import NoModelPlanError
from scene_graph import Move, all_moves

MOVES = all_moves(3)
CONFIG = EffectConfig(width=16, layers=1, heads=2, hidden=8)
#: Three places of 24 bits each, in a code of 160.
PARTS = tuple(np.arange(8 + 40 * place, 32 + 40 * place) for place in range(3))


def toy_transitions(renders: int = 1) -> Transitions:
    """Three moments: a mark in one of three places, that moves between them."""
    bits = np.zeros((3, renders, 160), np.uint8)
    for place in range(3):
        bits[place, :, PARTS[place]] = 1
    codes = np.packbits(bits, axis=2)
    before = np.array([move.source for move in MOVES])
    after = np.array([move.target for move in MOVES])
    possible = np.zeros((3, 6), np.bool_)
    possible[before, np.arange(6)] = True
    return Transitions(codes, before, np.arange(6), after, possible, PARTS)


def trained(steps: int = 150, **changes: object) -> ActionTrainer:
    config = ActionTraining(CONFIG, steps=steps, batch=16, learning_rate=1e-2, **changes)  # type: ignore[arg-type]
    trainer = ActionTrainer(toy_transitions(), config)
    trainer.run(lambda *_: True)
    return trainer


def test_bits_of_no_part_are_copied() -> None:
    trainer = ActionTrainer(toy_transitions(), ActionTraining(CONFIG))
    bits = torch.randint(2, (4, 160)).float()
    after = trainer.policy.after(bits, torch.zeros(4, dtype=torch.long))
    around = np.setdiff1d(np.arange(160), np.concatenate(PARTS))
    assert torch.equal(after[:, around], bits[:, around])


def test_what_no_action_touches_is_swapped_before_and_after_alike() -> None:
    """So that where two parts matter, what a third one holds is learnt not to."""
    trainer = ActionTrainer(toy_transitions(), ActionTraining(CONFIG, swaps=1.0))
    before, after = trainer._drawn(np.zeros(64, np.int64)), trainer._drawn(np.ones(64, np.int64))
    was, becomes = trainer._swapped(before, after)
    assert torch.equal(was[:, :48], before[:, :48]) and torch.equal(becomes[:, :48], after[:, :48])
    assert torch.equal(was[:, 48:], becomes[:, 48:])
    assert 0 < int(was[:, 48:].any(1).sum()) < 64


def test_transitions_are_learnt_from_codes_alone() -> None:
    trainer, seen = trained(), toy_transitions()
    model = LearntModel(trainer.policy, trainer.discriminator, MOVES)
    states = [code.tobytes() for code in seen.codes[:, 0]]
    for place, options in enumerate(model.successors(states)):
        assert options == [(m, states[m.target]) for m in MOVES if m.source == place]


def test_what_the_inverse_move_does_not_undo_is_dropped() -> None:
    trainer, seen = trained(), toy_transitions()
    states = [code.tobytes() for code in seen.codes[:, 0]]
    lost = seen.codes[1, 0]

    def snap(codes: NDArray[np.uint8]) -> tuple[NDArray[np.uint8], NDArray[np.bool_]]:
        """As if the third code were taken for the second one."""
        third = (codes == seen.codes[2, 0]).all(1)
        return np.where(third[:, None], lost, codes), np.ones(len(codes), np.bool_)

    believing = LearntModel(trainer.policy, trainer.discriminator, MOVES, snap, verify=False)
    checking = LearntModel(trainer.policy, trainer.discriminator, MOVES, snap)
    assert {move.target for move, _ in believing.successors(states[:1])[0]} == {1, 2}
    assert {move.target for move, _ in checking.successors(states[:1])[0]} == {1}


def test_the_objective_of_the_thesis_can_be_trained_on() -> None:
    trainer = ActionTrainer(toy_transitions(2), ActionTraining(CONFIG, THESIS, steps=30))
    losses: list[float] = []

    def on_step(_step: int, told: dict[str, float]) -> bool:
        losses.append(told["π"])
        return True

    trainer.run(on_step)
    assert np.mean(losses[-5:]) < np.mean(losses[:5])


def test_a_training_goes_on_from_its_checkpoint_as_if_it_had_not_stopped(tmp_path: Path) -> None:
    path = tmp_path / "checkpoint.pt"
    config = ActionTraining(CONFIG, steps=12, batch=4)
    whole = ActionTrainer(toy_transitions(2), config)
    assert whole.run(lambda *_: True)
    first = ActionTrainer(toy_transitions(2), config)
    assert not first.run(lambda step, *_: step < 5, path)
    second = ActionTrainer(toy_transitions(2), config)
    second.resume(path)
    assert second.step == 5 and second.run(lambda *_: True)
    for one, other in zip(whole.policy.parameters(), second.policy.parameters()):
        assert torch.equal(one, other)
    with pytest.raises(CheckpointError, match="other hyper-parameters"):
        ActionTrainer(toy_transitions(2), ActionTraining(CONFIG, steps=13, batch=4)).resume(path)
    path.write_bytes(b"no checkpoint")
    with pytest.raises(CheckpointError, match="damaged"):
        second.resume(path)


def test_weights_come_back_as_they_were(tmp_path: Path) -> None:
    path = tmp_path / "model.safetensors"
    policy, discriminator = EffectNetwork(CONFIG, PARTS), Discriminator(CONFIG, PARTS)
    save_action_model(policy, discriminator, path, {"commit": "none"})
    loaded, judge = load_action_model(path)
    values = torch.randint(2, (3, 72)).float()
    moves = torch.tensor([0, 3, 5])
    assert torch.equal(loaded(values, moves), policy.eval()(values, moves))
    assert torch.equal(judge(values), discriminator(values))


@pytest.mark.parametrize("content", [None, b"", b"nonsense" * 10])
def test_a_file_that_is_no_action_model_is_refused(tmp_path: Path, content: bytes | None) -> None:
    path = tmp_path / "model.safetensors"
    if content is not None:
        path.write_bytes(content)
    with pytest.raises(ModelWeightsError, match="train-latent"):
        load_action_model(path)


def test_a_plan_between_pictures_is_one_between_their_codes() -> None:
    trainer, seen = trained(), toy_transitions()
    model = LearntModel(trainer.policy, trainer.discriminator, MOVES)
    planner = LatentPlanner(
        lambda pictures: (seen.codes[pictures[:, 0, 0, 0], 0], pictures[:, 0, 0, 0] < 3), model
    )
    pictures = [np.full((128, 128, 3), number, np.uint8) for number in range(3)]
    plan = planner.plan(pictures[0], pictures[2])
    assert plan.moves == (Move(0, 2),) and plan.confidence == 1.0
    assert plan.codes == (seen.codes[0, 0].tobytes(), seen.codes[2, 0].tobytes())
    assert planner.plan(pictures[1], pictures[1]).moves == ()


def known(answer: tuple[NDArray[np.uint8], NDArray[np.bool_]]) -> Read:
    """An encoder that says the same of all pictures."""
    return lambda _pictures: answer


def test_a_picture_of_something_else_is_told_by_which_it_is() -> None:
    trainer, seen = trained(2), toy_transitions()
    model = LearntModel(trainer.policy, trainer.discriminator, MOVES)
    for strange in (0, 1):
        answer = (seen.codes[:2, 0], np.arange(2) != strange)
        planner = LatentPlanner(known(answer), model)
        with pytest.raises(StrangePictureError) as caught:
            planner.plan(np.zeros((128, 128, 3), np.uint8), np.zeros((128, 128, 3), np.uint8))
        assert caught.value.is_goal == bool(strange)


def test_pictures_between_which_there_is_no_way_are_told() -> None:
    trainer, seen = trained(), toy_transitions()
    model = LearntModel(trainer.policy, trainer.discriminator, MOVES)
    blank = np.zeros_like(seen.codes[0, 0])
    planner = LatentPlanner(
        lambda _pictures: (np.stack([seen.codes[0, 0], blank]), np.ones(2, np.bool_)), model
    )
    picture = np.zeros((128, 128, 3), np.uint8)
    with pytest.raises(NoModelPlanError):
        planner.plan(picture, picture)
