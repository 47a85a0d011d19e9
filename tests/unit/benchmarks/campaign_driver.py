# SPDX-License-Identifier: Apache-2.0
"""A campaign whose tasks do nothing but wait for a file, as a program that can be stopped.

Usage: campaign_driver.py FOLDER SEED… [--jobs N]; what runs writes a line into FOLDER/ran, and a
task ends when FOLDER/go_SEED is there: it fails if a word stands in it.
"""

from __future__ import annotations

import argparse
import sys
import time
from contextlib import contextmanager
from pathlib import Path
from typing import Any

import side_by_side
import tasks.campaign
from tasks.campaign import Campaign, Settings
from tasks.draw import Task, draw_task
from tasks.family import family_named
from tasks.record import CampaignRunsError, Records
from tasks.stopping import Stop

SIX = family_named("six")


class FakeGraph:
    """No nodes, no logs."""

    def __init__(self, folder: Path, *_: Any) -> None:
        self._folder = folder

    def __enter__(self) -> FakeGraph:
        return self

    def __exit__(self, *_error: object) -> None:
        pass

    def log_sizes(self) -> dict[str, int]:
        return {}

    def keep_logs(self, folder: Path, since: dict[str, int]) -> None:
        del since
        folder.mkdir(parents=True, exist_ok=True)


def make_measure(folder: Path) -> Any:
    def measure(_graph: FakeGraph, task: Task) -> dict[str, Any]:
        with (folder / "ran").open("a") as ran:
            ran.write(f"{task.seed}\n")
        go = folder / f"go_{task.seed}"
        while not go.exists():
            time.sleep(0.01)
        reason = go.read_text()
        failure = {"module": "motion", "reason": reason} if reason else None
        return {"success": not reason, "failure": failure}

    return measure


@contextmanager
def held(records: Records, options: argparse.Namespace) -> Any:
    """The lock, where this is no share."""
    if options.share is not None:
        yield None
        return
    with records.lock() as lock:
        records.interrupt_all_begun()
        yield lock


def main() -> int:
    parser = argparse.ArgumentParser()
    parser.add_argument("folder", type=Path)
    parser.add_argument("seeds", type=int, nargs="+")
    parser.add_argument("--resume", action="store_true")
    side_by_side.add_arguments(parser)
    options = parser.parse_args()
    tasks.campaign.Graph = FakeGraph  # type: ignore[assignment, misc]
    tasks.campaign.measure = make_measure(options.folder)
    records, stop = Records(options.folder / "records"), Stop()
    campaign = Campaign(
        Settings(SIX, 0.0, options.share or 0), records, stop, lambda seed: draw_task(SIX, seed)
    )
    try:
        with held(records, options) as lock:
            if options.jobs > 1 and options.share is None:
                return 0 if side_by_side.run_shares(options.jobs, [lock]) else 130
            stop.listen()
            campaign.run(side_by_side.share_of(options.seeds, options), options.seeds)
    except KeyboardInterrupt:
        return 130
    except CampaignRunsError as error:
        print(error, file=sys.stderr)
        return 1
    return 0


if __name__ == "__main__":
    sys.exit(main())
