# SPDX-License-Identifier: Apache-2.0
"""A node that does not get through its shutdown is ended, and cannot pass for one that does."""

from __future__ import annotations

import signal
import sys

import pytest
from ros2_run import PROCESS_TIMEOUT, Spawn
from tamp_runtime.node_process import EXIT_HELD, EXIT_STUCK

STUCK = """
import ctypes, sys, time
from rclpy.node import Node
from tamp_runtime.node_process import run_node

class Stuck(Node):
    def __init__(self):
        super().__init__("stuck")
        self.create_timer(0.01, self.work)

    def stay(self):
        time.sleep(1000.0)

    def hold(self):
        ctypes.PyDLL(None).sleep(1000)  # with the interpreter's lock

    def work(self):
        print("here", flush=True)
        {callback}

    def destroy_node(self):
        {destructor}

sys.exit(run_node(Stuck))
"""


@pytest.mark.parametrize(
    "callback, destructor, code, words",
    [
        ("self.stay()", "pass", EXIT_STUCK, ("not stopped after 5 s", "in stay")),
        ("pass", "self.stay()", EXIT_STUCK, ("not stopped after 5 s", "in stay")),
        ("pass", "self.hold()", EXIT_HELD, ("in hold",)),
    ],
)
def test_a_stuck_node_is_ended_and_shows_where_it_hangs(
    spawn: Spawn, callback: str, destructor: str, code: int, words: tuple[str, ...]
) -> None:
    process = spawn(sys.executable, "-c", STUCK.format(callback=callback, destructor=destructor))
    assert process.stdout is not None
    assert process.stdout.readline() == "here\n"
    process.send_signal(signal.SIGINT)
    _, stderr = process.communicate(timeout=PROCESS_TIMEOUT)
    assert process.returncode == code
    assert all(word in stderr for word in words)
