# SPDX-License-Identifier: Apache-2.0
"""A callback that never returns does not keep a node's process from stopping."""

from __future__ import annotations

import os
import signal
import subprocess
import sys

STUCK = """
import sys, time
from rclpy.node import Node
from tamp_runtime.node_process import run_node

class Stuck(Node):
    def __init__(self):
        super().__init__("stuck")
        self.create_timer(0.01, self.stay)

    def stay(self):
        print("here", flush=True)
        time.sleep(1000.0)

sys.exit(run_node(Stuck))
"""


def test_a_stuck_node_is_ended_and_shows_where_it_hangs() -> None:
    process = subprocess.Popen(
        [sys.executable, "-c", STUCK],
        stdout=subprocess.PIPE,
        stderr=subprocess.PIPE,
        text=True,
        env={**os.environ, "ROS_DOMAIN_ID": str(1 + os.getpid() % 100)},
    )
    assert process.stdout is not None
    assert process.stdout.readline() == "here\n"
    process.send_signal(signal.SIGINT)
    _, stderr = process.communicate(timeout=60.0)
    assert process.returncode == 0
    assert "not stopped after 5 s" in stderr
    assert "in stay" in stderr
