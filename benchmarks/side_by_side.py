# SPDX-License-Identifier: Apache-2.0
"""A campaign in shares: the same program several times at once, each with a graph of its own."""

from __future__ import annotations

import argparse
import ctypes
import signal
import subprocess
import sys
from collections.abc import Collection, Sequence
from typing import Final, TypeVar

Item = TypeVar("Item")

_PR_SET_PDEATHSIG: Final = 1


def add_arguments(parser: argparse.ArgumentParser) -> None:
    """``--jobs``, and what this program tells its shares."""
    parser.add_argument("--jobs", type=int, default=1, help="graphs side by side")
    parser.add_argument("--share", type=int, help=argparse.SUPPRESS)


def share_of(items: Sequence[Item], options: argparse.Namespace) -> Sequence[Item]:
    """Those items that this process has to run; all where there are no shares."""
    return items if options.share is None else items[options.share :: options.jobs]


def run_shares(jobs: int, keep_open: Collection[int] = ()) -> bool:
    """Runs this program once for each share; whether all of them came to their end.

    Each resumes, as what was to be forgotten is forgotten before. Ctrl-C reaches all, SIGTERM is
    passed on, and all are waited for. If this process is killed, its shares get SIGTERM.

    Args:
        keep_open: file descriptors that the shares inherit, such as that of a lock.
    """
    command = [sys.executable, *sys.argv, "--resume"]
    shares = [
        subprocess.Popen(
            [*command, "--share", str(share)],
            pass_fds=tuple(keep_open),
            preexec_fn=_end_with_parent,
        )
        for share in range(jobs)
    ]

    def pass_on(number: int, _frame: object) -> None:
        for share in shares:
            share.send_signal(number)

    before = signal.signal(signal.SIGTERM, pass_on)
    interrupted = False
    try:
        for share in shares:
            while share.poll() is None:
                try:
                    share.wait()
                except KeyboardInterrupt:
                    interrupted = True
    finally:
        signal.signal(signal.SIGTERM, before)
    return not interrupted and not any(share.returncode for share in shares)


def _end_with_parent() -> None:
    ctypes.CDLL(None).prctl(_PR_SET_PDEATHSIG, signal.SIGTERM)
