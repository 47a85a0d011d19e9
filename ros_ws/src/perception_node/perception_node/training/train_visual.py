# SPDX-License-Identifier: Apache-2.0
"""``ros2 run perception_node train_visual``: trains the visual module G on rendered scenes.

Self-supervised: it reads images and masks, never what stands where. Ctrl-C saves and stops; the
same command goes on from there.
"""

from __future__ import annotations

import argparse
import shutil
import sys
from dataclasses import asdict, fields
from pathlib import Path
from typing import Any

import torch
from tqdm import tqdm

from perception_node.errors import PerceptionError
from perception_node.visual_module.coordinate_regressor import BACKBONES
from perception_node.visual_module.weights import DEFAULT_WEIGHTS, save_weights

from .command import how_trained, train_to_the_end
from .dataset import read_crops, shard_paths
from .trainer import Trainer, TrainingConfig, bfloat16_helps

CHECKPOINT = "checkpoint.pt"
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
        shutil.copyfile(path, DEFAULT_WEIGHTS)
        print(f"installed as the package's default: {DEFAULT_WEIGHTS}")
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
    if checkpoint.exists():
        trainer.resume(checkpoint)
        print(f"going on from step {trainer.step} of {config.steps} ({checkpoint})")
    return trainer


def _parse(arguments: list[str] | None) -> argparse.Namespace:
    parser = argparse.ArgumentParser(
        prog="train_visual",
        description=__doc__,
        formatter_class=argparse.ArgumentDefaultsHelpFormatter,
    )
    parser.add_argument("--data", type=Path, default=Path("data/states_5"), help="folder of shards")
    parser.add_argument("--run", type=Path, default=Path("runs/visual"), help="folder to write")
    parser.add_argument("--threads", type=int, default=2, help="processor threads")
    parser.add_argument(
        "--install", action="store_true", help="make the result the package's default weights"
    )
    for field in fields(TrainingConfig):
        flag = f"--{field.name.replace('_', '-')}"
        default: Any = bfloat16_helps() if field.name == "bfloat16" else field.default
        if isinstance(default, bool):
            action = argparse.BooleanOptionalAction
            parser.add_argument(flag, action=action, default=default, help=field.name)
        else:
            choices = BACKBONES if field.name == "backbone" else None
            parser.add_argument(
                flag, type=type(default), default=default, choices=choices, help=field.name
            )
    return parser.parse_args(arguments)


if __name__ == "__main__":
    sys.exit(main())
