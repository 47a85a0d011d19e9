# SPDX-License-Identifier: Apache-2.0
"""A node stops on SIGINT and SIGTERM, also where its parent had them ignored, and only once."""

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


IMPATIENT = """
import sys
from rclpy.node import Node
from tamp_runtime.node_process import run_node

class Slow(Node):
    def __init__(self):
        super().__init__("slow")
        {constructor}
        self.create_timer(0.01, lambda: print("here", flush=True))

    def destroy_node(self):
        print("stopping", flush=True)
        sys.stdin.readline()
        super().destroy_node()

sys.exit(run_node(Slow))
"""


def test_a_second_ctrl_c_does_not_disturb_the_stop(spawn: Spawn) -> None:
    process = spawn(sys.executable, "-c", IMPATIENT.format(constructor=""))
    assert process.stdin is not None and process.stdout is not None
    assert process.stdout.readline() == "here\n"
    process.send_signal(signal.SIGINT)
    assert "stopping\n" in process.stdout
    process.send_signal(signal.SIGINT)
    process.stdin.write("\n")
    assert finish(process).code == 0


@pytest.mark.parametrize("number", [signal.SIGINT, signal.SIGTERM])
def test_a_signal_ends_a_node_that_is_being_made(spawn: Spawn, number: signal.Signals) -> None:
    constructor = "print('here', flush=True); sys.stdin.readline()"
    process = spawn(sys.executable, "-c", IMPATIENT.format(constructor=constructor))
    assert process.stdin is not None and process.stdout is not None
    assert process.stdout.readline() == "here\n"
    process.send_signal(number)
    ended = finish(process)  # closes its stdin
    assert (ended.code, ended.stderr) == (0, "")
