# SPDX-License-Identifier: Apache-2.0
"""Nodes and clients as processes through ``ros2 run``, as a person uses them."""

from __future__ import annotations

import json
import os
import signal
import subprocess
import time
from collections.abc import Iterator
from pathlib import Path

import pytest

from tamp_bringup.processes import NODES, NodeProcesses


def run(*command: str, timeout: float = 120.0) -> subprocess.CompletedProcess[str]:
    return subprocess.run(
        ["ros2", "run", *command], capture_output=True, text=True, timeout=timeout, check=False
    )


@pytest.fixture(autouse=True)
def own_domain(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setenv("ROS_DOMAIN_ID", str(1 + (os.getpid() + time.time_ns() // 10**6) % 100))


@pytest.fixture
def graph(tmp_path: Path) -> Iterator[NodeProcesses]:
    scene = {"layout": "['red_box,blue_box','','green_box']"}
    with NodeProcesses(tmp_path / "logs", {"sim_node": scene}) as processes:
        yield processes


def plan_until_ready(goal: str, timeout: float = 90.0) -> subprocess.CompletedProcess[str]:
    """Asks for a plan until the graph has found itself together."""
    deadline = time.monotonic() + timeout
    while True:
        answer = run("planner_node", "plan_to_goal", goal)
        if answer.returncode == 0 or time.monotonic() > deadline:
            return answer
        time.sleep(1.0)


@pytest.mark.timeout(400)
def test_nodes_and_clients_work_as_processes_and_stop_cleanly(
    graph: NodeProcesses, tmp_path: Path
) -> None:
    plan = plan_until_ready("red on green")
    assert plan.returncode == 0, plan.stdout + plan.stderr
    assert "(0, 1)" in plan.stdout
    unknown = run("planner_node", "plan_to_goal", "purple on green")
    assert unknown.returncode != 0
    assert "green_box" in unknown.stdout + unknown.stderr
    done = run("planner_node", "achieve_goal", "red on green", timeout=200.0)
    assert done.returncode == 0, done.stdout + done.stderr
    graph.check()
    assert graph.stop_all() == dict.fromkeys(NODES, 0)
    for log in (tmp_path / "logs").iterdir():
        assert "not stopped after" not in log.read_text(), log.read_text()
    for node in NODES:
        assert "Traceback" not in (tmp_path / "logs" / f"{node}.log").read_text()


@pytest.mark.timeout(400)
def test_any_node_can_be_stopped_and_started_again(graph: NodeProcesses) -> None:
    assert plan_until_ready("red on green").returncode == 0
    for node in NODES:
        assert graph.stop(node) == 0, node
        graph.start(node)
        answer = plan_until_ready("red on green")
        assert answer.returncode == 0, f"after a restart of {node}: {answer.stdout}{answer.stderr}"
    done = run("planner_node", "achieve_goal", "blue on green", timeout=200.0)
    assert done.returncode == 0, done.stdout + done.stderr


@pytest.mark.timeout(300)
def test_the_demo_writes_what_it_promises(tmp_path: Path) -> None:
    done = run(
        "tamp_bringup",
        "demo",
        "--seed",
        "2",
        "--blocks",
        "3",
        "--out",
        str(tmp_path),
        timeout=280.0,
    )
    assert done.returncode == 0, done.stdout + done.stderr
    result = json.loads((tmp_path / "result.json").read_text())
    assert result["success"] is True
    assert result["failure"] is None
    assert result["moves_executed"] >= result["moves_planned"] > 0
    assert set(result["timing_s"]) == {"perceive", "plan", "motion", "execute", "total"}
    assert len(result["initial"]) == len(result["final"]) == 3
    assert (tmp_path / "plan.png").stat().st_size > 10_000
    assert (tmp_path / "execution.gif").read_bytes()[:3] == b"GIF"


@pytest.mark.timeout(120)
def test_ctrl_c_stops_the_demo_and_every_node(tmp_path: Path) -> None:
    demo = subprocess.Popen(
        ["ros2", "run", "tamp_bringup", "demo", "--blocks", "6", "--out", str(tmp_path)],
        stdout=subprocess.PIPE, stderr=subprocess.STDOUT, text=True, start_new_session=True,
    )  # fmt: skip
    try:
        assert demo.stdout is not None
        for line in demo.stdout:
            if line.startswith("plan"):
                break
        os.killpg(demo.pid, signal.SIGINT)
        output, _ = demo.communicate(timeout=90)
    finally:
        demo.kill()
    assert demo.returncode == 130, output
    assert "Traceback" not in output
    assert not left_over(str(tmp_path))


def left_over(marker: str) -> list[str]:
    """Command lines of processes whose log is in a folder."""
    found = []
    for folder in Path("/proc").glob("[0-9]*"):
        try:
            target = (folder / "fd" / "1").readlink()
            if marker in str(target):
                found.append((folder / "cmdline").read_text().replace("\0", " "))
        except OSError:
            continue
    return found


@pytest.mark.parametrize("arguments", [["--blocks", "9"], ["--goal", "red over"], ["--seed", "-1"]])
def test_the_demo_refuses_bad_arguments_before_it_starts_anything(arguments: list[str]) -> None:
    refused = run("tamp_bringup", "demo", *arguments)
    assert refused.returncode == 2
    assert arguments[0] in refused.stderr
