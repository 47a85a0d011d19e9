# SPDX-License-Identifier: Apache-2.0
"""Ctrl-C before a node is there."""

from __future__ import annotations

import signal
import time
from pathlib import Path

import pytest
from ros2_run import PROCESS_TIMEOUT, Start, finish

from tamp_bringup.processes import NODES


@pytest.mark.parametrize("node", NODES)
@pytest.mark.parametrize("library", ["_rclpy_pybind11", "librmw_fastrtps_cpp"])
def test_a_node_that_is_still_loading_stops_without_a_trace(
    start: Start, node: str, library: str
) -> None:
    process = start(node, node)
    deadline = time.monotonic() + PROCESS_TIMEOUT
    while library not in Path(f"/proc/{process.pid}/maps").read_text():
        assert time.monotonic() < deadline
        time.sleep(0.005)
    process.send_signal(signal.SIGINT)
    assert finish(process).code == 0
