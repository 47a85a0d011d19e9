# SPDX-License-Identifier: Apache-2.0
"""Benchmarks of many cases by seed, each with a file of its own: a stopped run can be taken up."""

from __future__ import annotations

import argparse
import json
from collections.abc import Callable
from pathlib import Path
from typing import Any, Final

from results_file import quick

#: Of what is published.
FIRST_SEED: Final = 1000
#: Of all benchmarks; git ignores it.
RUNS: Final = Path(__file__).parent.parent / "runs"


def options(description: str | None, count: int, few: int) -> argparse.Namespace:
    """What a run is asked for: ``seed``, ``n`` and ``resume``.

    Args:
        count, few: how many cases, and how many with ``QUICK=1``.
    """
    parser = argparse.ArgumentParser(description=description)
    parser.add_argument("--seed", type=int, default=FIRST_SEED, help="first one; to tune: not 1000")
    parser.add_argument("--n", type=int, default=few if quick() else count)
    parser.add_argument("--resume", action="store_true", help="keep the results so far")
    return parser.parse_args()


def kept(folder: str, seed: int, resume: bool, measure: Callable[[int], dict[str, Any]]) -> Any:
    """What ``measure`` says of a seed, as JSON keeps it; its file says so if it may be used.

    Args:
        folder: of the cases, in ``runs``.
    """
    path = RUNS / folder / f"{seed}.json"
    if not resume or not path.exists():
        path.parent.mkdir(parents=True, exist_ok=True)
        path.write_text(json.dumps(measure(seed), indent=1))
    return json.loads(path.read_text())
