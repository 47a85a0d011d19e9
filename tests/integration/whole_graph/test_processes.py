# SPDX-License-Identifier: Apache-2.0
"""Nodes and clients as processes through ``ros2 run``, as a person uses them."""

from __future__ import annotations

import resource
import time
from collections.abc import Iterator
from pathlib import Path

import pytest
from ros2_run import TOWER_TIMEOUT, Start, finish

from tamp_bringup.processes import NODES, NodeProcesses

#: After a restart the nodes have to find one another, and the camera has to look.
ATTEMPTS = 60


@pytest.fixture
def graph(domain_id: int, tmp_path: Path) -> Iterator[NodeProcesses]:
    del domain_id  # it is in the environment
    scene = {"layout": "['red_box,blue_box','','green_box']"}
    with NodeProcesses(tmp_path / "logs", {"sim_node": scene}) as processes:
        yield processes


def plan(start: Start) -> None:
    """Asks for the plan until the graph has found itself together."""
    for _ in range(ATTEMPTS):
        answer = finish(start("planner_node", "plan_to_goal", "red on green"))
        if answer.code == 0:
            assert "(0, 1)" in answer.stdout
            return
    raise AssertionError(answer)


@pytest.mark.timeout(600)
def test_any_node_can_be_stopped_and_started_again_and_the_graph_still_works(
    graph: NodeProcesses, start: Start, tmp_path: Path
) -> None:
    plan(start)
    for node in NODES:
        assert graph.stop(node) == 0, node
        graph.start(node)
        plan(start)
    done = finish(start("planner_node", "achieve_goal", "red on green"), TOWER_TIMEOUT)
    assert done.code == 0, done
    graph.check()
    assert graph.stop_all() == dict.fromkeys(NODES, 0)
    for node in NODES:
        assert "Traceback" not in (tmp_path / "logs" / f"{node}.log").read_text()


def children_seconds() -> float:
    """CPU time of this process's children that have ended [s]."""
    used = resource.getrusage(resource.RUSAGE_CHILDREN)
    return used.ru_utime + used.ru_stime


def test_the_cpu_time_of_a_node_is_that_of_its_process(domain_id: int, tmp_path: Path) -> None:
    del domain_id
    before, node = children_seconds(), "planner_node"
    with NodeProcesses(tmp_path, nodes=(node,)) as processes:
        while (used := processes.cpu_seconds()[node]) < 0.2:  # it imports its program
            processes.check()
            time.sleep(0.01)
    assert set(processes.cpu_seconds()) == set()
    assert used <= children_seconds() - before + 0.02  # a clock tick each
