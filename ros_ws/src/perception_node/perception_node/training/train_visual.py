# SPDX-License-Identifier: Apache-2.0
"""``ros2 run perception_node train_visual``: trains the visual module G on rendered scenes.

Self-supervised: it reads images and masks, never what stands where. Ctrl-C saves and stops; the
same command goes on from there.
"""

from __future__ import annotations

import argparse
import sys
from dataclasses import asdict, fields
from pathlib import Path

import torch
from tqdm import tqdm

from perception_node.errors import PerceptionError
from perception_node.visual_module.coordinate_regressor import BACKBONES
from perception_node.visual_module.weights import DEFAULT_WEIGHTS, save_weights

from .command import (
    CHECKPOINT,
    go_on,
    how_trained,
    install,
    parse_options,
    train_to_the_end,
)
from .dataset import read_crops, shard_paths
from .trainer import Trainer, TrainingConfig, bfloat16_helps

WEIGHTS = "visual_module.safetensors"


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
    if not train_to_the_end(trainer, checkpoint):
        print(f"stopped at step {trainer.step}; the same command goes on from there")
        return 130
    path = options.run / WEIGHTS
    command = f"ros2 run perception_node train_visual --data {options.data}"
    save_weights(trainer.module, path, how_trained(command, asdict(trainer.config), trainer))
    print(f"{path} written after {trainer.seconds:.0f} s of training")
    if options.install:
        install(path, DEFAULT_WEIGHTS)
    else:
        print(
            f"use it with: ros2 run perception_node perception_node --ros-args -p weights:={path}"
        )
    return 0


def _trainer(options: argparse.Namespace, checkpoint: Path) -> Trainer:
    """A new run, or the one of the checkpoint."""
    settings = {field.name: getattr(options, field.name) for field in fields(TrainingConfig)}
    config = TrainingConfig(**settings)
    with tqdm(total=len(shard_paths(options.data)), desc="reading", unit="shard") as progress:
        crops = read_crops(options.data, on_shard=progress.update)
    trainer = Trainer(crops, config)
    go_on(trainer, checkpoint)
    return trainer


def _parse(arguments: list[str] | None) -> argparse.Namespace:
    settings = {field.name: field.default for field in fields(TrainingConfig)}
    settings["bfloat16"] = bfloat16_helps()
    return parse_options(
        *(arguments, "train_visual", __doc__ or "", ("data/states_5", "runs/visual")),
        *(settings, {"backbone": BACKBONES}),
    )


if __name__ == "__main__":
    sys.exit(main())
