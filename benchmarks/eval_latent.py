# SPDX-License-Identifier: Apache-2.0
"""``make eval-latent``: the discrete latent state of Chapter 4, measured; see ``latent/``.

Reads what ``make data-latent`` and ``make train-latent`` wrote; seeds that were trained are
measured each, and their spread is given beside the first one's values.
"""

from __future__ import annotations

import argparse
import sys
import time
from pathlib import Path
from typing import Any

import torch
from latent.bench import TEST_SEED, open_bench
from latent.blocks_world import BlocksWorld, DataError, read_set
from latent.codes_measured import encoder_rows
from latent.figures import noise_curves, noise_picture, plan_picture, saved
from latent.measure import cold_rows, learnt_rows, observed_rows, prediction_rows, sample_plans
from latent.seeds import together
from latent.trainings import ENCODER
from results_file import Row, print_rows, quick, write_result

from perception_node.errors import PerceptionError
from perception_node.latent.weights import load_encoder
from planner_node.errors import PlannerError


def main() -> int:
    """Exit code 0 when done, 2 when there is nothing to measure."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--data", type=Path, default=Path("data/latent"), help="folder of the sets")
    parser.add_argument("--runs", type=Path, default=Path("runs/latent"), help="a folder a seed")
    parser.add_argument("--n", type=int, help="pairs of states to plan for")
    parser.add_argument("--threads", type=int, default=2, help="processor threads")
    options = parser.parse_args()
    torch.set_num_threads(options.threads)
    begun = time.perf_counter()
    details: dict[str, Any] = {}
    try:
        rows = measure(options, details)
    except (DataError, PerceptionError, PlannerError) as error:
        print(f"cannot measure: {error}", file=sys.stderr)
        return 2
    details["curves"] = {"noise": noise_curves(rows)}
    print_rows(rows)
    print(write_result("latent", "make eval-latent", rows, time.perf_counter() - begun, details))
    return 0


def measure(options: argparse.Namespace, details: dict[str, Any]) -> list[Row]:
    """Rows of all seeds that were trained."""
    folders = sorted(path.parent for path in options.runs.glob(f"[0-9]*/{ENCODER}"))
    if not folders:
        raise DataError(f"nothing was trained in {options.runs}; `make train-latent` does")
    sets = {name: read_set(options.data / name) for name in ("train_5", "test_4", "test_5")}
    of_seeds = []
    for folder in folders[: 1 if quick() else None]:
        found = details.setdefault(f"seed {folder.name}", {})
        of_seeds.append(of_seed(folder, sets, options.n or (20 if quick() else 200), found))
    if not quick():
        details["pictures"] = pictures(folders[0], sets)
    return together(of_seeds)


def of_seed(
    folder: Path, sets: dict[str, BlocksWorld], tasks: int, details: dict[str, Any]
) -> list[Row]:
    """Rows of one seed."""
    bench = open_bench(folder, load_encoder(folder / ENCODER), sets, tasks)
    details["file_kib"] = (folder / ENCODER).stat().st_size // 1024
    searches = ("from both ends",) if quick() else ("from both ends", "A*")
    return [
        *encoder_rows(bench, 40 if quick() else 360),
        *observed_rows(bench, details),
        *prediction_rows(bench),
        *learnt_rows(bench, details, searches),
        *cold_rows(bench),
    ]


def pictures(folder: Path, sets: dict[str, BlocksWorld]) -> list[dict[str, str]]:
    """Figures 4.7 and 4.8 on our data."""
    bench = open_bench(folder, load_encoder(folder / ENCODER), sets, tasks=200)
    image = bench.five.images[len(bench.five.images) // 2, 0]
    return [
        saved(
            noise_picture(bench.encoder, image, TEST_SEED),
            "latent_noise",
            "Images under noise of α = 0.001 to 1 (Figure 4.7): given, what the code shows, what "
            "the snapped code shows.",
        ),
        saved(
            plan_picture(bench.encoder, sample_plans(bench, 5), 8),
            "latent_plans",
            "Plans of the learnt action model M2, as their codes show them (Figures 4.1 and 4.8).",
        ),
    ]


if __name__ == "__main__":
    raise SystemExit(main())
