# SPDX-License-Identifier: Apache-2.0
"""``make data-latent``: the data sets of Chapter 4; stopped, the same command goes on."""

from __future__ import annotations

import argparse
import sys
from pathlib import Path

from latent.blocks_world import DataError, SetConfig, render_set
from latent.clevr.dataset import ClevrConfig, ask_more, render_clevr

#: Of the pictures that only evaluation sees; those of training have seed 0.
TEST_SEED = 1000
#: Number of the first scene of the test questions: no scene of training has it.
FIRST_TEST_SCENE = 1_000_000


def main() -> int:
    """Exit code 0 when done, 130 when stopped by Ctrl-C, 2 when it cannot start."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--out", type=Path, default=Path("data/latent"), help="folder to write")
    parser.add_argument("--limit", type=int, help="states of each set, for a trial")
    parser.add_argument("--scenes", type=int, default=5000, help="with questions, for training")
    parser.add_argument("--rounds", type=int, default=3, help="of questions about each of them")
    options = parser.parse_args()
    sets = {
        "train_5": SetConfig(5, 4, 0),
        "test_4": SetConfig(4, 3, TEST_SEED),
        "test_5": SetConfig(5, 1, TEST_SEED),
    }
    tests = max(1, options.scenes // 10)
    try:
        done = all(
            render_set(options.out / name, config, options.limit) for name, config in sets.items()
        ) and all(
            render_clevr(options.out / name, config)
            for name, config in {
                "clevr_train": ClevrConfig(options.scenes),
                "clevr_test": ClevrConfig(tests, FIRST_TEST_SCENE, TEST_SEED),
            }.items()
        )
        done = done and ask_more(options.out / "clevr_train", options.rounds)
    except DataError as error:
        print(f"cannot render: {error}", file=sys.stderr)
        return 2
    if not done:
        print("stopped; the same command goes on where this one ended")
    return 0 if done else 130


if __name__ == "__main__":
    raise SystemExit(main())
