# SPDX-License-Identifier: Apache-2.0
"""Executables as processes of their own, as a person starts them with ``ros2 run``."""

from __future__ import annotations

import ctypes
import signal
import subprocess
from collections.abc import Callable, Collection
from typing import NamedTuple

from tamp_runtime.node_process import EXIT_STUCK

Process = subprocess.Popen[str]
#: ``start(package, executable, *arguments)``, the fixture ``start``.
Start = Callable[..., Process]
#: ``spawn(*command)``, the fixture ``spawn``.
Spawn = Callable[..., Process]

#: A process imports rclpy and finds its neighbours; slow machines need a while [s].
PROCESS_TIMEOUT = 120.0

#: How long the arm may take to build a tower on a machine that has a lot to do [s].
TOWER_TIMEOUT = 400.0

_PR_SET_PDEATHSIG = 1


class Ended(NamedTuple):
    """What is left of a process."""

    code: int
    stdout: str
    stderr: str


def start_process(*command: str, ignored: Collection[signal.Signals] = ()) -> Process:
    """Starts a command in the DDS domain of the environment; it does not outlive the tests.

    Args:
        ignored: signals that the process inherits as ignored, as SIGINT in a script's background.
    """

    def set_up_child() -> None:
        ctypes.CDLL(None).prctl(_PR_SET_PDEATHSIG, signal.SIGKILL)
        for number in (signal.SIGINT, signal.SIGTERM, signal.SIGHUP):
            signal.signal(number, signal.SIG_IGN if number in ignored else signal.SIG_DFL)

    return subprocess.Popen(
        command,
        stdin=subprocess.PIPE,
        stdout=subprocess.PIPE,
        stderr=subprocess.PIPE,
        text=True,
        preexec_fn=set_up_child,
    )


def finish(process: Process, timeout: float = PROCESS_TIMEOUT) -> Ended:
    """Waits for the end of a process, which must be neither a traceback nor a hang."""
    stdout, stderr = process.communicate(timeout=timeout)
    assert process.returncode != EXIT_STUCK, stderr
    assert "Traceback" not in stderr, stderr
    return Ended(process.returncode, stdout, stderr)
