# SPDX-License-Identifier: Apache-2.0
"""``make train-latent``: state encoder and action models of Chapter 4, on two processor cores.

Ctrl-C saves and stops; the same command goes on from there. Weights that are there are kept.
"""

from __future__ import annotations

import argparse
import sys
from pathlib import Path

import torch
from latent.blocks_world import DataError, read_set
from latent.trainings import (
    StoppedError,
    cached_codes,
    split,
    train_action_model,
    train_encoder,
    transitions_of,
)

from perception_node.errors import PerceptionError
from perception_node.latent.objective import Weights
from perception_node.latent.quantiser import QUANTISERS
from perception_node.latent.state_encoder import CHANNELS, EncoderConfig
from perception_node.latent.trainer import TrainingConfig
from planner_node.action_models.effect_network import EffectConfig
from planner_node.action_models.training import OBJECTIVES, ActionTraining
from planner_node.errors import PlannerError


def main() -> int:
    """Exit code 0 when done, 130 when stopped by Ctrl-C, 2 when it cannot start."""
    options = _parse()
    torch.set_num_threads(options.threads)
    try:
        train(options)
    except (DataError, PerceptionError, PlannerError) as error:
        print(f"cannot train: {error}", file=sys.stderr)
        return 2
    except (StoppedError, KeyboardInterrupt):
        print("stopped; the same command goes on from there")
        return 130
    return 0


def train(options: argparse.Namespace) -> None:
    """Everything of one seed, into the folder of the run."""
    world = read_set(options.data / "train_5")
    weights = Weights() if options.stable else Weights(agreement=0.0, return_=0.0)
    encoder = train_encoder(
        options.run,
        world,
        TrainingConfig(
            EncoderConfig(options.quantiser, options.channels, options.width),
            weights,
            steps=options.steps,
            seed=options.seed,
        ),
    )
    if options.action_steps == 0:
        return
    codes = cached_codes(options.run, "train_5", encoder, world)
    seen = transitions_of(encoder, codes, world, split(world).seen)
    effect = EffectConfig()
    for objective in options.objectives:
        config = ActionTraining(effect, objective, steps=options.action_steps, seed=options.seed)
        print(train_action_model(options.run / objective, seen, config))


def _parse() -> argparse.Namespace:
    parser = argparse.ArgumentParser(
        description=__doc__, formatter_class=argparse.ArgumentDefaultsHelpFormatter
    )
    parser.add_argument("--data", type=Path, default=Path("data/latent"), help="folder of the sets")
    parser.add_argument("--run", type=Path, default=Path("runs/latent/0"), help="folder to write")
    parser.add_argument("--seed", type=int, default=0, help="of weights and batches")
    parser.add_argument("--threads", type=int, default=2, help="processor threads")
    parser.add_argument("--quantiser", choices=QUANTISERS, default="binary", help="of the encoder")
    parser.add_argument("--channels", type=int, choices=CHANNELS, default=8, help="o")
    parser.add_argument("--width", type=int, default=24, help="of the encoder's layers")
    parser.add_argument("--steps", type=int, default=1500, help="of the encoder")
    parser.add_argument(
        "--stable",
        action=argparse.BooleanOptionalAction,
        default=True,
        help="ask for one code of all pictures of a state",
    )
    parser.add_argument("--action-steps", type=int, default=2500, help="of the action model")
    parser.add_argument(
        "--objectives", nargs="+", choices=OBJECTIVES, default=list(OBJECTIVES), help="of π"
    )
    return parser.parse_args()


if __name__ == "__main__":
    raise SystemExit(main())
