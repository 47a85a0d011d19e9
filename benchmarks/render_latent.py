# SPDX-License-Identifier: Apache-2.0
"""``make data-latent``: the blocks-world data sets of Chapter 4; the same command goes on."""

from __future__ import annotations

import argparse
import sys
from pathlib import Path

from latent.blocks_world import DataError, SetConfig, render_set

#: Of the pictures that only evaluation sees; those of training have seed 0.
TEST_SEED = 1000


def main() -> int:
    """Exit code 0 when done, 130 when stopped by Ctrl-C, 2 when it cannot start."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--out", type=Path, default=Path("data/latent"), help="folder to write")
    parser.add_argument("--limit", type=int, help="states of each set, for a trial")
    options = parser.parse_args()
    sets = {
        "train_5": SetConfig(5, 4, 0),
        "test_4": SetConfig(4, 3, TEST_SEED),
        "test_5": SetConfig(5, 1, TEST_SEED),
    }
    try:
        for name, config in sets.items():
            if not render_set(options.out / name, config, options.limit):
                print("stopped; the same command goes on where this one ended")
                return 130
    except DataError as error:
        print(f"cannot render: {error}", file=sys.stderr)
        return 2
    return 0


if __name__ == "__main__":
    raise SystemExit(main())
