# SPDX-License-Identifier: Apache-2.0
"""The trainings of Chapter 4 on blocks-world: state encoder, then action model on its codes.

Each takes up its checkpoint, and is not done again where its weights are there already.
"""

from __future__ import annotations

from dataclasses import asdict, dataclass
from pathlib import Path
from typing import Final

import numpy as np
from numpy.typing import NDArray
from results_file import source_commit

from perception_node.latent.objective import Parts
from perception_node.latent.state_encoder import StateEncoder
from perception_node.latent.trainer import EncoderTrainer, TrainingConfig
from perception_node.latent.weights import load_encoder, save_encoder
from planner_node.action_models.training import ActionTrainer, ActionTraining, Transitions
from planner_node.action_models.weights import load_action_model, save_action_model

from .blocks_world import MOVES, BlocksWorld
from .progress import progress

ENCODER: Final = "encoder.safetensors"
CHECKPOINT: Final = "checkpoint.pt"
#: Share of the transitions of 5 blocks that no action model sees.
HELD_OUT: Final = 0.2


class StoppedError(Exception):
    """Ctrl-C; the same command goes on."""


@dataclass(frozen=True)
class Split:
    """Transitions of a set by whether the action model sees them, as indices."""

    seen: NDArray[np.int64]
    held_out: NDArray[np.int64]


def split(world: BlocksWorld, seed: int = 0) -> Split:
    """The same for every training, so that what is held out is held out everywhere."""
    order = np.random.default_rng(seed).permutation(len(world.before))
    count = round(HELD_OUT * len(order))
    return Split(np.sort(order[count:]), np.sort(order[:count]))


def train_encoder(folder: Path, world: BlocksWorld, config: TrainingConfig) -> StateEncoder:
    """The state encoder of a folder, trained if it is not there yet.

    Raises:
        StoppedError: by Ctrl-C.
        WeightsError: the folder holds another run.
    """
    path = folder / ENCODER
    if path.exists():
        return load_encoder(path)
    trainer = EncoderTrainer(world.images, config)
    checkpoint = folder / CHECKPOINT
    if checkpoint.exists():
        trainer.resume(checkpoint)
    with progress("encoder", config.steps, trainer.step, folder / "log.txt") as shown:

        def on_step(step: int, parts: Parts) -> bool:
            return shown.show(
                step,
                {
                    "reconstruction": float(parts.reconstruction.detach()),
                    "agreement": float(parts.agreement.detach()),
                    "return": float(parts.return_.detach()),
                },
            )

        if not trainer.run(on_step, checkpoint):
            raise StoppedError
    trainer.encoder.learn_parts(world.images)
    metadata = {"commit": source_commit(), "training_seconds": f"{trainer.seconds:.0f}"}
    save_encoder(trainer.encoder, path, metadata | {"training": repr(asdict(config))})
    return load_encoder(path)


def codes_of(encoder: StateEncoder, world: BlocksWorld, snapped: bool = True) -> NDArray[np.uint8]:
    """Codes of all pictures of a set, shape (s, r, b)."""
    states, renders = world.images.shape[:2]
    codes = encoder.encode(world.images.reshape(-1, *world.images.shape[2:]), snapped)
    return codes.reshape(states, renders, -1)


def cached_codes(folder: Path, name: str, encoder: StateEncoder, world: BlocksWorld) -> NDArray:
    """As :func:`codes_of`, kept beside the encoder's weights."""
    path = folder / f"codes_{name}.npz"
    if path.exists() and path.stat().st_mtime > (folder / ENCODER).stat().st_mtime:
        with np.load(path) as file:
            return np.asarray(file["codes"])
    codes = codes_of(encoder, world)
    np.savez_compressed(path, codes=codes)
    return codes


def transitions_of(
    encoder: StateEncoder, codes: NDArray[np.uint8], world: BlocksWorld, seen: NDArray
) -> Transitions:
    """What an action model is trained on; which layout a state is, is not among it."""
    assert encoder.parts is not None
    parts = tuple(part.bits for part in encoder.parts.parts)
    possible = np.zeros((len(codes), len(MOVES)), np.bool_)
    possible[world.before, world.move] = True
    return Transitions(
        codes, world.before[seen], world.move[seen], world.after[seen], possible, parts
    )


def train_action_model(folder: Path, seen: Transitions, config: ActionTraining) -> Path:
    """The weights file of an action model, trained if it is not there yet.

    Raises:
        StoppedError: by Ctrl-C.
        CheckpointError: the folder holds another run.
    """
    path = folder / "action_model.safetensors"
    if path.exists():
        load_action_model(path)
        return path
    trainer = ActionTrainer(seen, config)
    checkpoint = folder / CHECKPOINT
    if checkpoint.exists():
        trainer.resume(checkpoint)
    title = f"action model ({config.objective})"
    with progress(title, config.steps, trainer.step, folder / "log.txt") as shown:
        if not trainer.run(shown.show, checkpoint):
            raise StoppedError
    metadata = {"commit": source_commit(), "training_seconds": f"{trainer.seconds:.0f}"}
    save_action_model(
        trainer.policy, trainer.discriminator, path, metadata | {"training": repr(asdict(config))}
    )
    return path
