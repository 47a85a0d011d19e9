# SPDX-License-Identifier: Apache-2.0
"""Fits the probability that a graph is right to pictures of every set, by seeds from 100 to 999.

Nothing is drawn that ``make eval-perception`` measures on: its seeds begin at 1000. Sets in which
what is wrong cannot be seen in one picture are left out. Writes ``weights/graph_probability.json``
of perception_node; ``--n`` pictures of each set.
"""

from __future__ import annotations

import argparse
import json
from collections.abc import Iterator
from concurrent.futures import ProcessPoolExecutor

import numpy as np
import torch
from perception.answers import Answer, answers_of
from perception.scenes import FIRST_SEED
from perception.sets import SETS, sets_named
from results_file import source_commit
from tqdm import tqdm

from perception_node import load_weights
from perception_node.probability import EVIDENCE, PARAMETERS, fit

#: Seeds of the pictures, before those of the benchmarks.
SEEDS = range(100, 1000)


def main() -> int:
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--n", type=int, default=100, help="pictures of each set")
    parser.add_argument("--jobs", type=int, default=2, help="processes")
    options = parser.parse_args()
    told = [item.name for item in SETS if item.told]
    answers: list[Answer] = []
    with ProcessPoolExecutor(
        options.jobs, initializer=torch.set_num_threads, initargs=(1,)
    ) as pool:
        for part in tqdm(pool.map(_look, told, [options.n] * len(told)), total=len(told)):
            answers += part
    used = [answer for answer in answers if answer.evidence]
    seen = np.array([answer.evidence for answer in used])
    right = np.array([answer.right for answer in used])
    weights = fit(seen, right)
    content = {
        "command": f"make fit-probability N={options.n}",
        "commit": source_commit(),
        "graphs": len(used),
        "right": int(right.sum()),
        "weights": dict(zip(EVIDENCE, (round(float(value), 5) for value in weights))),
    }
    PARAMETERS.write_text(json.dumps(content, indent=1) + "\n")
    print(json.dumps(content, indent=1))
    return 0


def _look(name: str, count: int) -> list[Answer]:
    """In a process of its own: pictures of a set, before its first."""
    (item,) = sets_named(name)
    numbers: Iterator[int] = (seed - FIRST_SEED for seed in SEEDS[:: max(1, len(SEEDS) // count)])
    return list(answers_of(item, load_weights(), [number for number in numbers][:count]))


if __name__ == "__main__":
    raise SystemExit(main())
