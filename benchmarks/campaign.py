# SPDX-License-Identifier: Apache-2.0
"""A campaign: tasks on running graphs, each of which leaves a file, stopped and taken up again."""

from __future__ import annotations

import argparse
import json
import signal
import sys
from collections.abc import Callable, Sequence
from pathlib import Path
from typing import Any, Protocol, TypeVar

import rclpy
import side_by_side
from rclpy.signals import SignalHandlerOptions
from tamp_runtime.node_process import prepare_process

from tamp_bringup.processes import use_own_domain


class Task(Protocol):
    """One thing to be run."""

    @property
    def path(self) -> Path:
        """Where its result is kept, JSON."""


AnyTask = TypeVar("AnyTask", bound=Task)
#: Runs those tasks whose results are not there yet, as the share of that number.
Run = Callable[[Sequence[AnyTask], int], None]


def add_arguments(parser: argparse.ArgumentParser) -> None:
    """``--jobs``, ``--resume`` and ``--report``."""
    side_by_side.add_arguments(parser)
    parser.add_argument("--resume", action="store_true", help="keep the results so far")
    parser.add_argument("--report", action="store_true", help="only write what has been measured")


def run_campaign(
    tasks: Sequence[AnyTask], options: argparse.Namespace, run: Run[AnyTask]
) -> list[dict[str, Any]] | int:
    """The results of all tasks that have one; or the exit code where there is nothing to tell.

    Args:
        options: as :func:`add_arguments` made them.
        run: is interrupted by Ctrl-C.
    """
    for task in tasks:
        task.path.parent.mkdir(parents=True, exist_ok=True)
        if not options.resume and not options.report:
            task.path.unlink(missing_ok=True)
    # Where a script put this into the background, SIGINT is ignored.
    signal.signal(signal.SIGINT, signal.default_int_handler)
    if options.share is not None:
        mine = side_by_side.share_of(tasks, options)
        return 0 if _run_in_own_domain(run, mine, options.share) else 130
    if not options.report:
        whole = (
            side_by_side.run_shares(options.jobs)
            if options.jobs > 1
            else _run_in_own_domain(run, tasks, 0)
        )
        if not whole:
            print("\nstopped; RESUME=1 goes on with what is left")
            return 130
    results = [json.loads(task.path.read_text()) for task in tasks if task.path.exists()]
    if not results:
        print("nothing has been measured yet", file=sys.stderr)
        return 1
    return results


def _run_in_own_domain(run: Run[AnyTask], tasks: Sequence[AnyTask], share: int) -> bool:
    """Whether it came to its end."""
    use_own_domain()
    prepare_process()
    rclpy.init(signal_handler_options=SignalHandlerOptions.NO)
    try:
        run(tasks, share)
    except KeyboardInterrupt:
        return False
    finally:
        rclpy.try_shutdown()
    return True
