# SPDX-License-Identifier: Apache-2.0
"""Executables as processes of their own, as a person starts them with ``ros2 run``."""

from __future__ import annotations

import signal
import subprocess
from collections.abc import Callable
from typing import NamedTuple

from tamp_runtime.node_process import EXIT_STUCK

Process = subprocess.Popen[str]
#: ``start(package, executable, *arguments)``, the fixture ``start``.
Start = Callable[..., Process]

#: A process imports rclpy and finds its neighbours; slow machines need a while [s].
PROCESS_TIMEOUT = 120.0


class Ended(NamedTuple):
    """What is left of a process."""

    code: int
    stdout: str
    stderr: str


def ros2_run(
    package: str, executable: str, *arguments: str, ignore_sigint: bool = False
) -> Process:
    """Starts an executable in the DDS domain of the environment.

    Args:
        ignore_sigint: as a script starts what it puts into the background.
    """
    number = signal.SIG_IGN if ignore_sigint else signal.SIG_DFL
    return subprocess.Popen(
        ["ros2", "run", package, executable, *arguments],
        stdout=subprocess.PIPE,
        stderr=subprocess.PIPE,
        text=True,
        preexec_fn=lambda: signal.signal(signal.SIGINT, number),
    )


def finish(process: Process) -> Ended:
    """Waits for the end of a process, which must be neither a traceback nor a hang."""
    stdout, stderr = process.communicate(timeout=PROCESS_TIMEOUT)
    assert process.returncode != EXIT_STUCK, stderr
    assert "Traceback" not in stderr, stderr
    return Ended(process.returncode, stdout, stderr)
