# SPDX-License-Identifier: Apache-2.0
"""``make eval-perception``: how often the scene graph is right, accepted, or refused and why.

Renders the pictures of each set of :mod:`perception.sets` (seeds from 1000), lets perception
interpret them, and compares the whole graph, every relation and name, with the simulator's truth.
``--set`` picks sets by name and publishes nothing, ``--n`` takes so many pictures of each at most;
answers are kept set by set in ``runs/eval_perception``, so that ``--resume`` goes on with pictures
that are left, and takes those of a set that was looked at in more pictures, too. Writes
``benchmarks/results/perception.json``; ``QUICK=1`` takes 30 pictures of each set.
"""

from __future__ import annotations

import argparse
import json
import sys
import time
from collections.abc import Iterable
from concurrent.futures import ProcessPoolExecutor
from dataclasses import asdict
from pathlib import Path
from typing import Any

import torch
from perception.answers import Answer, answers_of
from perception.score import confidence_rows, refusals, rows_of
from perception.sets import PictureSet, UnknownSetError, sets_named
from results_file import Row, print_rows, quick, write_result
from tqdm import tqdm

from perception_node import load_weights

RUNS = Path("runs/eval_perception")
#: Pictures that a process is given at once.
CHUNK = 50


def main() -> int:
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--set", default="", help="names of sets, with commas between; all of them")
    parser.add_argument("--n", type=int, help="pictures of each set at most")
    parser.add_argument("--jobs", type=int, default=2, help="processes")
    parser.add_argument("--resume", action="store_true", help="keep the sets that are done")
    options = parser.parse_args()
    try:
        chosen = sets_named(options.set)
    except UnknownSetError as error:
        print(f"cannot evaluate: {error}", file=sys.stderr)
        return 2
    start = time.perf_counter()
    rows: list[Row] = []
    seen: list[tuple[PictureSet, Answer]] = []
    refused: dict[str, Any] = {}
    wrong: dict[str, Any] = {}
    for item in chosen:
        count = min(item.count, options.n or (30 if quick() else item.count))
        answers = _answers(item, count, options.jobs, options.resume)
        rows += rows_of(item, answers)
        seen += [(item, answer) for answer in answers]
        refused[item.what] = refusals(answers)
        if seeds := [answer.seed for answer in answers if answer.confident and not answer.right]:
            wrong[item.what] = seeds
    rows += confidence_rows(seen)
    print_rows(rows)
    if options.set:
        print("nothing is published: not all sets were looked at")
        return 0
    details = {"refused": refused, "accepted and wrong, seeds": wrong}
    command = "make eval-perception" + (f" N={options.n}" if options.n else "")
    print(write_result("perception", command, rows, time.perf_counter() - start, details))
    return 0


def _answers(item: PictureSet, count: int, jobs: int, resume: bool) -> list[Answer]:
    """Of the first pictures of a set, those that an earlier run looked at from its file."""
    path = RUNS / f"{item.name}.json"
    found: list[Answer] = []
    if resume and path.is_file():
        found = [Answer(**_with_tuples(entry)) for entry in json.loads(path.read_text())]
    done = len(found)
    chunks = [
        range(first, min(first + CHUNK, count)) for first in range(done, max(done, count), CHUNK)
    ]
    path.parent.mkdir(parents=True, exist_ok=True)
    with (
        ProcessPoolExecutor(jobs, initializer=torch.set_num_threads, initargs=(1,)) as pool,
        tqdm(total=max(done, count), initial=done, desc=item.name, unit="picture") as progress,
    ):
        for part in pool.map(_look, [item.name] * len(chunks), chunks):
            found += part
            partial = path.with_suffix(".partial")
            partial.write_text(json.dumps([asdict(answer) for answer in found]))
            partial.replace(path)
            progress.update(len(part))
    return found


def _look(name: str, numbers: Iterable[int]) -> list[Answer]:
    """In a process of its own: some pictures of a set."""
    (item,) = sets_named(name)
    return list(answers_of(item, load_weights(), numbers))


def _with_tuples(entry: dict[str, Any]) -> dict[str, Any]:
    errors = tuple(tuple(error) for error in entry["errors"])
    named = tuple(tuple(block) for block in entry["named"])
    tuples = {name: tuple(entry[name]) for name in ("iou", "baselines", "evidence", "place_errors")}
    return {**entry, **tuples, "errors": errors, "named": named}


if __name__ == "__main__":
    raise SystemExit(main())
