# SPDX-License-Identifier: Apache-2.0
"""``make eval-tasks``: what its arguments mean, what it publishes, and what it refuses."""

from __future__ import annotations

import json
from importlib import import_module
from pathlib import Path
from typing import Any

import eval_tasks
import pytest
import results_file
import tasks.campaign
from campaign_driver import FakeGraph
from eval_tasks import OtherTasksError, as_written, check_same_tasks, parse_arguments, task_of
from tasks.draw import Task, draw_task, unknown_parameters
from tasks.family import FAMILIES, Family, family_named
from tasks.record import Records

SIX, VARIED = family_named("six"), family_named("varied")
SIM_PARAMETERS = [spec.name for spec in import_module("sim_node.parameters").PARAMETERS]


@pytest.fixture
def here(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    """A folder for runs and results, and graphs without nodes whose odd tasks fail."""
    monkeypatch.setattr(eval_tasks, "RUNS", tmp_path / "runs")
    monkeypatch.setattr(results_file, "RESULTS_FOLDER", tmp_path / "results")
    monkeypatch.setattr(tasks.campaign, "Graph", FakeGraph)
    monkeypatch.setattr(tasks.campaign, "measure", measure)
    monkeypatch.setattr(eval_tasks.Stop, "listen", lambda _self: None)  # pytest keeps its own
    monkeypatch.delenv("QUICK", raising=False)
    return tmp_path


def measure(_graph: FakeGraph, task: Task) -> dict[str, Any]:
    timing = dict.fromkeys(("perceive", "plan", "motion", "execute", "total"), 0.1)
    failure = {"module": "motion", "reason": "red_box fell"} if task.seed % 2 else None
    return {
        "success": failure is None, "failure": failure, "moves_planned": 7, "moves_executed": 7,
        "replans": 0, "timing_s": timing, "wall_seconds": 1.0, "simulated_seconds": 2.0,
        "real_time_factor": 2.0, "graph_seconds": [0.1], "other_graph_seconds": {},
    }  # fmt: skip


def call(monkeypatch: pytest.MonkeyPatch, *arguments: str) -> int:
    monkeypatch.setattr("sys.argv", ["eval_tasks.py", *arguments])
    return eval_tasks.main()


def family_by(monkeypatch: pytest.MonkeyPatch, *arguments: str) -> Family:
    monkeypatch.setattr("sys.argv", ["eval_tasks.py", *arguments])
    return parse_arguments()[1]


def result_files(here: Path) -> list[str]:
    folder = here / "results"
    return sorted(path.name for path in folder.iterdir()) if folder.exists() else []


# Arguments


def test_blocks_name_a_plain_family(monkeypatch: pytest.MonkeyPatch) -> None:
    assert family_by(monkeypatch) == family_by(monkeypatch, "--blocks", "6") == SIX
    assert family_by(monkeypatch, "--blocks", "7").result == "tasks_7"
    assert family_by(monkeypatch, "--family", "varied") == VARIED


@pytest.mark.parametrize(
    ("arguments", "sentence"),
    [
        (["--family", "sixty"], "there are three, four"),
        (["--blocks", "9"], "3 to 7"),
        (["--blocks", "6", "--family", "six"], "leave out BLOCKS or FAMILY"),
        (["--baseline", "x", "--jobs", "2"], "leave out JOBS"),
        (["--baseline", "x", "--family", "varied"], "leave out BASELINE"),
        (["--n", "-1"], "1 or more"),
        (["--jobs", "0"], "1 or more"),
    ],
)
def test_what_makes_no_sense_is_refused_with_a_sentence(
    arguments: list[str],
    sentence: str,
    monkeypatch: pytest.MonkeyPatch,
    capsys: pytest.CaptureFixture[str],
) -> None:
    with pytest.raises(SystemExit):
        family_by(monkeypatch, *arguments)
    assert sentence in capsys.readouterr().err


# Campaigns


def test_a_campaign_is_published_with_its_failures(
    here: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    assert call(monkeypatch, "--family", "six", "--n", "4", "--real-time-factor", "0") == 0
    content = json.loads((here / "results" / "tasks_6.json").read_text())
    assert content["command"] == "make eval-tasks FAMILY=six N=4 RTF=0"
    assert content["rows"][0]["value"] == 0.5
    again = "make eval-tasks FAMILY=six SEED=1001 RTF=0"
    assert content["details"]["failure_table"]["rows"][0]["again"] == again
    assert again in capsys.readouterr().out


def test_a_single_run_publishes_nothing_and_leaves_the_campaign_alone(
    here: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    assert call(monkeypatch, "--family", "six", "--n", "2") == 0
    records = Records(here / "runs" / "eval_tasks_6")
    before = {path: path.read_bytes() for path in records.folder.glob("*.json")}
    results = (here / "results" / "tasks_6.json").read_bytes()
    assert call(monkeypatch, "--family", "six", "--seed", "1001") == 1
    assert "red_box fell" in capsys.readouterr().out
    assert call(monkeypatch, "--family", "six", "--seed", "1000") == 0
    assert {path: path.read_bytes() for path in records.folder.glob("*.json")} == before
    assert result_files(here) == ["tasks_6.json"]
    assert (here / "results" / "tasks_6.json").read_bytes() == results


def test_a_quick_run_has_two_tasks_and_a_file_of_its_own(
    here: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setenv("QUICK", "1")
    assert call(monkeypatch, "--n", "200") == 0
    assert result_files(here) == ["tasks_6.quick.json"]
    assert Records(here / "runs" / "eval_tasks_6").seeds() == [1000, 1001]
    quick = json.loads((here / "results" / "tasks_6.quick.json").read_text())
    assert quick["command"] == "make eval-tasks FAMILY=six N=2 RTF=0"


def test_a_campaign_that_goes_on_keeps_what_is_there(
    here: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    call(monkeypatch, "--n", "2")
    records = Records(here / "runs" / "eval_tasks_6")
    before = records.path(1001).read_bytes()
    records.path(1002).write_text(json.dumps({"seed": 1002, "state": "begun", "drawn": {}}))
    assert call(monkeypatch, "--n", "4", "--resume") == 0
    assert records.path(1001).read_bytes() == before
    assert records.read(1002)["failure"]["module"] == "operator"
    assert records.read(1003)["failure"]["module"] == "motion"


def test_a_task_is_run_again_as_it_was_kept(here: Path) -> None:
    drawn = draw_task(SIX, 1003)
    kept = {**as_written(drawn), "goal": "red on blue"}
    Records(here / "runs" / "eval_tasks_6").begin(1003, {"task": kept})
    assert task_of(SIX, 1003).goal == "red on blue"
    assert task_of(SIX, 1004) == draw_task(SIX, 1004)


def test_a_campaign_does_not_go_on_with_other_tasks(here: Path) -> None:
    records = Records(here / "campaign")
    records.begin(1, {"task": as_written(draw_task(VARIED, 1))})
    check_same_tasks(records, VARIED, range(3))
    records.begin(2, {"task": as_written(draw_task(VARIED, 3))})
    with pytest.raises(OtherTasksError, match="without RESUME=1"):
        check_same_tasks(records, VARIED, range(3))


# Families and nodes


@pytest.mark.skipif("scene" not in SIM_PARAMETERS, reason="sim_node reads no scene files here")
@pytest.mark.skipif("sensor.seed" not in SIM_PARAMETERS, reason="sim_node's camera is perfect here")
@pytest.mark.parametrize("family", FAMILIES, ids=lambda family: family.name)
def test_nodes_know_every_parameter_that_a_family_sets(family: Family) -> None:
    nodes = {
        node: [spec.name for spec in import_module(f"{node}.parameters").PARAMETERS]
        for node in ("sim_node", "perception_node")
    }
    for seed in range(20):
        assert unknown_parameters(draw_task(family, seed), nodes) == []


@pytest.mark.skipif("scene" not in SIM_PARAMETERS, reason="sim_node reads no scene files here")
@pytest.mark.parametrize("seed", range(20))
def test_the_simulator_accepts_every_scene_and_layout(seed: int, tmp_path: Path) -> None:
    task = draw_task(VARIED, seed)
    scene = import_module("sim_node.scene").load_scene(
        str(tasks.campaign.write_scene(task, tmp_path))
    )
    import_module("sim_node.layouts").check_layout(
        task.layout, len(scene.stack_positions), scene.blocks, seed
    )
    assert len(scene.stack_positions) == task.drawn["places"]
