# SPDX-License-Identifier: Apache-2.0
"""``make eval-latent-qa``: Table 4.1 and Figure 4.9 on our scenes; trains what is not trained yet.

Ctrl-C saves and stops; the same command goes on from there.
"""

from __future__ import annotations

import argparse
import sys
import time
from collections.abc import Sequence
from dataclasses import dataclass, field
from pathlib import Path
from typing import Final

import numpy as np
import torch
from latent.blocks_world import DataError
from latent.clevr.dataset import ClevrSet, read_clevr
from latent.linear_reader import words_named_right
from latent.qa_training import (
    Answers,
    baseline_rows,
    gain_rows,
    linear_rows,
    owners_of,
    qa_rows,
    reader_rows,
    train_qa,
    train_reader,
)
from latent.seeds import together
from latent.trainings import StoppedError
from numpy.typing import NDArray
from results_file import Row, print_rows, write_result

from perception_node.errors import PerceptionError
from perception_node.latent.answering import ANSWERERS
from perception_node.latent.qa_trainer import SETTINGS, QaConfig, QaTrainer, ReaderConfig
from perception_node.latent.state_encoder import CHANNELS, EncoderConfig

#: Passes over the images of each setting's training.
EPOCHS: Final = {"reconstruction": 16, "both": 9, "kl": 9}
#: Peak of the learning rate of a training that goes on from another one.
FURTHER_RATE: Final = 3e-4


def main() -> int:
    """Exit code 0 when done, 130 when stopped by Ctrl-C, 2 when it cannot start."""
    options = _parse()
    torch.set_num_threads(options.threads)
    begun = time.perf_counter()
    try:
        rows = measure(options)
    except (DataError, PerceptionError) as error:
        print(f"cannot measure: {error}", file=sys.stderr)
        return 2
    except (StoppedError, KeyboardInterrupt):
        print("stopped; the same command goes on from there")
        return 130
    print_rows(rows)
    told = _without_folders(sys.argv[1:])
    command = "make eval-latent-qa" + (f' ARGS="{" ".join(told)}"' if told else "")
    print(write_result("latent_qa", command, rows, time.perf_counter() - begun))
    return 0


def measure(options: argparse.Namespace) -> list[Row]:
    """Trains and measures every setting, size and seed that was asked for."""
    train, test = (read_clevr(options.data / f"clevr_{name}") for name in ("train", "test"))
    of_seeds = [_of_seed(options, seed, train, test) for seed in options.seeds]
    rows = baseline_rows(train, test) + together([seed.rows for seed in of_seeds])
    for channels in options.channels:
        right, named = (
            {setting: [of_seed[setting, channels] for of_seed in found
                       if (setting, channels) in of_seed]
             for setting in options.settings}
            for found in ([seed.right for seed in of_seeds], [seed.named for seed in of_seeds])
        )  # fmt: skip
        rows += gain_rows(right, channels, owners_of(test))
        rows += linear_rows(named, channels, of_seeds[0].things)
    return rows


@dataclass
class _Seed:
    """What one seed gave.

    Attributes:
        rows: of its answerer, and of each setting and size.
        right: by setting and size, which questions were answered right.
        named: by the same, which words of things a linear reader named right.
        things: the scene of each thing.
    """

    rows: list[Row]
    right: dict[tuple[str, int], Answers] = field(default_factory=dict)
    named: dict[tuple[str, int], Answers] = field(default_factory=dict)
    things: NDArray[np.int64] = field(default_factory=lambda: np.zeros(0, np.int64))


def _of_seed(options: argparse.Namespace, seed: int, train: ClevrSet, test: ClevrSet) -> _Seed:
    config = ReaderConfig(options.answerer, epochs=options.reader_epochs, seed=seed)
    reader = train_reader(options.runs / f"reader_{options.answerer}_{seed}", train, config)
    found = _Seed(reader_rows(reader, test))

    def trained(setting: str, start: QaTrainer | None, encoder: EncoderConfig) -> QaTrainer:
        epochs = EPOCHS | dict(options.epochs)
        config = QaConfig(
            encoder,
            setting,
            epochs=epochs.get(f"{setting}@{encoder.channels}", epochs[setting]),
            learning_rate=FURTHER_RATE if start else QaConfig.learning_rate,
            seed=seed,
        )
        name = f"{setting}_{encoder.channels}_{options.answerer}_{seed}"
        return train_qa(options.runs / name, config, reader, start)

    enough = options.once if seed != options.seeds[0] else ()
    for channels in [size for size in options.channels if size not in enough]:
        encoder = EncoderConfig(options.quantiser, channels, options.width)
        for setting in options.settings:
            # The reader cannot be asked of what shows nothing yet: the others go on from there.
            alone = setting == "reconstruction"
            start = None if alone else trained("reconstruction", None, encoder)
            trainer = trained(setting, start, encoder)
            rows, found.right[setting, channels] = qa_rows(trainer, test)
            found.named[setting, channels], found.things = words_named_right(
                trainer.encoder, train, test
            )
            found.rows += rows
    return found


def _epochs(text: str) -> tuple[str, int]:
    name, _, number = text.partition("=")
    setting, _, channels = name.partition("@")
    known = setting in SETTINGS and (not channels or channels in map(str, CHANNELS))
    if not known or not number.isdigit():
        raise argparse.ArgumentTypeError(
            f"{text!r} is not SETTING=NUMBER, as kl=8, or of one size SETTING@CHANNELS=NUMBER"
        )
    return name, int(number)


def _without_folders(arguments: Sequence[str]) -> list[str]:
    """What a result depends on; not where this machine keeps its data, nor how many threads."""
    parser = argparse.ArgumentParser(add_help=False, allow_abbrev=False)
    for name in ("--data", "--runs", "--threads"):
        parser.add_argument(name)
    return parser.parse_known_args(arguments)[1]


def _parse() -> argparse.Namespace:
    parser = argparse.ArgumentParser(
        description=__doc__, formatter_class=argparse.ArgumentDefaultsHelpFormatter
    )
    parser.add_argument("--data", type=Path, default=Path("data/latent"), help="folder of the sets")
    parser.add_argument("--runs", type=Path, default=Path("runs/latent_qa"), help="of trainings")
    parser.add_argument("--settings", nargs="+", choices=SETTINGS, default=list(SETTINGS))
    parser.add_argument("--channels", nargs="+", type=int, choices=CHANNELS, default=[64, 16, 8])
    parser.add_argument("--answerer", choices=ANSWERERS, default="program")
    parser.add_argument("--quantiser", default="binary", help="of the encoder")
    parser.add_argument("--width", type=int, default=24, help="of the encoder's layers")
    parser.add_argument(
        "--epochs",
        nargs="+",
        type=_epochs,
        default=[],
        help=f"SETTING=NUMBER or SETTING@CHANNELS=NUMBER of encoders' trainings, else {EPOCHS}",
    )
    parser.add_argument("--reader-epochs", type=int, default=14, help="of the answerer's")
    parser.add_argument("--threads", type=int, default=2, help="processor threads")
    parser.add_argument(
        "--seeds", nargs="+", type=int, default=[0, 1, 2], help="of weights and batches"
    )
    parser.add_argument(
        "--once",
        nargs="*",
        type=int,
        choices=CHANNELS,
        default=[16, 8],
        help="sizes that are trained with the first seed only",
    )
    return parser.parse_args()


if __name__ == "__main__":
    raise SystemExit(main())
