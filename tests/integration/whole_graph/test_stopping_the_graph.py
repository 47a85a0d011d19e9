# SPDX-License-Identifier: Apache-2.0
"""``ros2 run planner_node stop`` with the real nodes: a person who has no other terminal left."""

from __future__ import annotations

from pathlib import Path

import pytest
from ros2_run import PROCESS_TIMEOUT, Start, finish

from tamp_bringup.processes import NodeProcesses

LAYOUT = "['red_box,blue_box','','green_box']"
ATTEMPTS = 60


@pytest.mark.timeout(900)
def test_fault_1_a_plan_that_nobody_follows_any_more_is_stopped_and_the_arm_goes_home(
    domain_id: int, start: Start, tmp_path: Path
) -> None:
    del domain_id  # it is in the environment
    with NodeProcesses(tmp_path, {"sim_node": {"layout": LAYOUT}}) as graph:
        for _ in range(ATTEMPTS):  # until the graph has found itself together
            asked = finish(start("planner_node", "plan_to_goal", "red on green", "--execute"))
            if asked.code == 0:
                break
        assert asked.code == 0, asked
        graph.kill("planner_node")
        stopped = finish(
            start("planner_node", "stop", "--timeout", f"{PROCESS_TIMEOUT - 20:g}"), PROCESS_TIMEOUT
        )
        assert stopped.code == 0, stopped
        assert "the arm is at home with an empty hand" in stopped.stdout
        # The next planner finds everything at rest.
        graph.restart("planner_node")
        done = finish(start("planner_node", "achieve_goal", "red on stack1"), 3 * PROCESS_TIMEOUT)
        assert done.code == 0, done
        graph.check()
