# SPDX-License-Identifier: Apache-2.0
"""Nodes and clients as processes through ``ros2 run``, as a person uses them."""

from __future__ import annotations

import json
import signal
import sys
from collections.abc import Iterator
from pathlib import Path

import pytest
from ros2_run import Start, finish

from tamp_bringup import demo
from tamp_bringup.processes import NODES, NodeProcesses

#: How long the arm may take to build a tower on a machine that has a lot to do [s].
TOWER_TIMEOUT = 400.0

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


@pytest.mark.timeout(600)
def test_the_demo_writes_what_it_promises(start: Start, tmp_path: Path) -> None:
    arguments = ["--seed", "2", "--blocks", "3", "--out", str(tmp_path)]
    done = finish(start("tamp_bringup", "demo", *arguments), TOWER_TIMEOUT)
    assert done.code == 0, done
    assert "hung" not in done.stderr
    result = json.loads((tmp_path / "result.json").read_text())
    assert result["success"] is True
    assert result["failure"] is None
    assert result["moves_executed"] >= result["moves_planned"] > 0
    assert set(result["timing_s"]) == {"perceive", "plan", "motion", "execute", "total"}
    assert len(result["initial"]) == len(result["final"]) == 3
    assert (tmp_path / "plan.png").stat().st_size > 10_000
    assert (tmp_path / "execution.gif").read_bytes()[:3] == b"GIF"


def test_ctrl_c_stops_the_demo_and_every_node_even_in_the_background_of_a_script(
    start: Start, tmp_path: Path
) -> None:
    arguments = ["--blocks", "6", "--out", str(tmp_path)]
    process = start("tamp_bringup", "demo", *arguments, ignored=[signal.SIGINT])
    assert process.stdout is not None
    for line in process.stdout:
        if line.startswith("plan"):
            break
    process.send_signal(signal.SIGINT)
    ended = finish(process)
    assert ended.code == 130, ended
    assert "hung" not in ended.stderr
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
def test_the_demo_refuses_bad_arguments_before_it_starts_anything(
    arguments: list[str], monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    monkeypatch.setattr(sys, "argv", ["demo", *arguments])
    with pytest.raises(SystemExit) as refused:
        demo.main()
    assert refused.value.code == 2
    assert arguments[0] in capsys.readouterr().err
