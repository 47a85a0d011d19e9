# SPDX-License-Identifier: Apache-2.0
"""A running node stops on SIGINT and SIGTERM, also where its parent had them ignored."""

from __future__ import annotations

import signal
import sys

import pytest
from ros2_run import Spawn, finish

NODE = """
import sys
from rclpy.node import Node
from tamp_runtime.node_process import run_node

class Running(Node):
    def __init__(self):
        super().__init__("running")
        self.create_timer(0.01, lambda: print("here", flush=True))

sys.exit(run_node(Running))
"""


@pytest.mark.parametrize("ignored", [False, True], ids=["heard", "ignored"])
@pytest.mark.parametrize("number", [signal.SIGINT, signal.SIGTERM])
def test_a_signal_ends_a_running_node(spawn: Spawn, number: signal.Signals, ignored: bool) -> None:
    process = spawn(sys.executable, "-c", NODE, ignored=[number] if ignored else [])
    assert process.stdout is not None
    assert process.stdout.readline() == "here\n"
    process.send_signal(number)
    assert finish(process).code == 0
