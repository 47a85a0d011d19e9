# SPDX-License-Identifier: Apache-2.0
"""``ros2 run perception_node train_masks``: trains the network that finds blocks in colour alone.

On the views of ``make data-masks``. Ctrl-C saves and stops; the same command goes on from there.
"""

from __future__ import annotations

import argparse
import sys
from dataclasses import asdict, fields
from pathlib import Path

import torch
from tqdm import tqdm

from perception_node.errors import PerceptionError
from perception_node.segment.mask_network import DEFAULT_WEIGHTS, save_weights

from .command import (
    CHECKPOINT,
    go_on,
    how_trained,
    install,
    parse_options,
    train_to_the_end,
)
from .mask_trainer import MaskTrainer, MaskTraining
from .mask_views import read_views, shard_paths

WEIGHTS = "mask_network.safetensors"


def main(arguments: list[str] | None = None) -> int:
    """Exit code 0 when done, 130 when stopped by Ctrl-C, 2 when it cannot start."""
    options = _parse(arguments)
    torch.set_num_threads(options.threads)
    checkpoint = options.run / CHECKPOINT
    try:
        trainer = _trainer(options, checkpoint)
    except (PerceptionError, OSError, ValueError) as error:
        print(f"cannot train: {error}", file=sys.stderr)
        return 2
    except KeyboardInterrupt:
        return 130
    done = train_to_the_end(trainer, checkpoint)
    path = options.run / WEIGHTS
    command = f"ros2 run perception_node train_masks --data {options.data}"
    save_weights(trainer.network, path, how_trained(command, asdict(trainer.config), trainer))
    if not done:
        print(f"stopped at step {trainer.step}; the same command goes on from there")
        return 130
    print(f"{path} written after {trainer.seconds:.0f} s of training")
    if options.install:
        install(path, DEFAULT_WEIGHTS)
    return 0


def _trainer(options: argparse.Namespace, checkpoint: Path) -> MaskTrainer:
    """A new run, or the one of the checkpoint."""
    settings = {field.name: getattr(options, field.name) for field in fields(MaskTraining)}
    config = MaskTraining(**settings)
    with tqdm(total=len(shard_paths(options.data)), desc="reading", unit="shard") as progress:
        views = read_views(options.data, on_shard=progress.update)
    trainer = MaskTrainer(views, config)
    go_on(trainer, checkpoint)
    return trainer


def _parse(arguments: list[str] | None) -> argparse.Namespace:
    settings = {field.name: field.default for field in fields(MaskTraining)}
    folders = ("data/masks", "runs/masks")
    return parse_options(arguments, "train_masks", __doc__ or "", folders, settings)


if __name__ == "__main__":
    sys.exit(main())
