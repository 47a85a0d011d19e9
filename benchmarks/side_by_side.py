# SPDX-License-Identifier: Apache-2.0
"""A campaign in shares: the same program several times at once, each with a graph of its own."""

from __future__ import annotations

import argparse
import subprocess
import sys
from collections.abc import Sequence
from typing import TypeVar

Item = TypeVar("Item")


def add_arguments(parser: argparse.ArgumentParser) -> None:
    """``--jobs``, and what this program tells its shares."""
    parser.add_argument("--jobs", type=int, default=1, help="graphs side by side")
    parser.add_argument("--share", type=int, help=argparse.SUPPRESS)


def share_of(items: Sequence[Item], options: argparse.Namespace) -> Sequence[Item]:
    """Those items that this process has to run; all where there are no shares."""
    return items if options.share is None else items[options.share :: options.jobs]


def run_shares(jobs: int) -> bool:
    """Runs this program once for each share; whether all of them came to their end.

    Each resumes, as what was to be forgotten is forgotten before. Ctrl-C reaches all, and all are
    waited for.
    """
    command = [sys.executable, *sys.argv, "--resume"]
    shares = [subprocess.Popen([*command, "--share", str(share)]) for share in range(jobs)]
    interrupted = False
    for share in shares:
        while share.poll() is None:
            try:
                share.wait()
            except KeyboardInterrupt:
                interrupted = True
    return not interrupted and not any(share.returncode for share in shares)
