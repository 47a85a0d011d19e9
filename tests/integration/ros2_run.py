# SPDX-License-Identifier: Apache-2.0
"""Executables as processes of their own, as a person starts them with ``ros2 run``."""

from __future__ import annotations

import os
import subprocess
from collections.abc import Callable
from typing import NamedTuple

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


def ros2_run(domain_id: int, package: str, executable: str, *arguments: str) -> Process:
    """Starts an executable in a DDS domain."""
    return subprocess.Popen(
        ["ros2", "run", package, executable, *arguments],
        stdout=subprocess.PIPE,
        stderr=subprocess.PIPE,
        text=True,
        env={**os.environ, "ROS_DOMAIN_ID": str(domain_id)},
    )


def finish(process: Process) -> Ended:
    """Waits for the end of a process, which must not be a traceback."""
    stdout, stderr = process.communicate(timeout=PROCESS_TIMEOUT)
    assert "Traceback" not in stderr, stderr
    return Ended(process.returncode, stdout, stderr)
