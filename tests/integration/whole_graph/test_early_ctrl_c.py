# SPDX-License-Identifier: Apache-2.0
"""SIGINT stops a node in order, however early it comes and whatever the parent did with it."""

from __future__ import annotations

import signal
import time
from pathlib import Path

import pytest
from ros2_run import PROCESS_TIMEOUT, Process, Start, finish

from tamp_bringup.processes import NODES


def wait_for_library(process: Process, library: str) -> None:
    """Returns as soon as a process has a shared library in its memory."""
    maps = Path(f"/proc/{process.pid}/maps")
    deadline = time.monotonic() + PROCESS_TIMEOUT
    while library not in maps.read_text():
        assert process.poll() is None, f"ended without {library}: {process.args}"
        assert time.monotonic() < deadline, f"no {library}: {process.args}"
        time.sleep(0.005)


@pytest.mark.parametrize("ignored", [[], [signal.SIGINT]], ids=["heard", "ignored"])
@pytest.mark.parametrize("node", NODES)
def test_a_node_that_is_still_loading_stops_without_a_trace(
    start: Start, node: str, ignored: list[signal.Signals]
) -> None:
    process = start(node, node, ignored=ignored)
    wait_for_library(process, "_rclpy_pybind11")
    process.send_signal(signal.SIGINT)
    assert finish(process).code == 0


@pytest.mark.parametrize("node", NODES)
def test_a_node_that_is_just_starting_stops_without_a_trace(start: Start, node: str) -> None:
    process = start(node, node)
    wait_for_library(process, "librmw_fastrtps_cpp")
    process.send_signal(signal.SIGINT)
    assert finish(process).code == 0
