# SPDX-License-Identifier: Apache-2.0
"""The examples do what they say; people copy them."""

from __future__ import annotations

import os
import subprocess
import sys
from pathlib import Path

import pytest

EXAMPLES = Path(__file__).parents[3] / "examples"

#: Something that each prints if it works, and what it writes.
EXPECTED = {
    "another_arm": "place blue_box",
    "gripper_action_behind_a_topic": "calls of the gripper)",
    "graph_in_process": "the camera confirms 'red_box on green_box'",
    "optimise_a_plan": "plotted into",
    "own_constraint": "room for red_box below the shelf is violated",
    "own_predicate": "2 moves to 'red_box level with yellow_box, green_box above blue_box'",
    "own_segmenter": "CONFIDENT",
    "perceive_a_picture": "drawn into",
    "plan_of_another_planner": "INVALID_PLAN: step 2 of the plan, '(move red_box stack0 blue_box)'",
    "plan_from_a_scene": "4 moves to 'red_box on blue_box, green_box left of red_box'",
}


def run(name: str, folder: Path, *arguments: str) -> str:
    ended = subprocess.run(
        [sys.executable, str(EXAMPLES / f"{name}.py"), *arguments],
        cwd=folder,
        env={**os.environ, "MPLBACKEND": "Agg"},
        capture_output=True,
        text=True,
        timeout=240.0,
    )
    assert ended.returncode == 0, ended.stdout + ended.stderr
    assert "Traceback" not in ended.stderr, ended.stderr
    return ended.stdout


def test_every_example_is_tested() -> None:
    assert {path.stem for path in EXAMPLES.glob("*.py")} == set(EXPECTED)


@pytest.mark.parametrize("name", EXPECTED)
def test_the_example_runs_and_says_what_it_did(name: str, tmp_path: Path) -> None:
    said = run(name, tmp_path)
    assert EXPECTED[name] in said
    if name == "own_segmenter":
        seen, truth = said.splitlines()[-2:]
        assert seen.removeprefix("seen") == truth.removeprefix("truth")
    if name == "own_constraint":
        free, below = (line.split("rises to ")[1] for line in said.splitlines()[-3:-1])
        assert float(below.split()[0]) < float(free.split()[0]) - 0.005


def test_a_goal_without_a_plan_ends_in_a_sentence(tmp_path: Path) -> None:
    said = run("plan_from_a_scene", tmp_path, "red on blue, blue on red")
    assert said.startswith("CONTRADICTORY_GOAL: ")
