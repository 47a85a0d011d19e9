# SPDX-License-Identifier: Apache-2.0
"""Rows and details of the replay's result file, and its table on the results page."""

from __future__ import annotations

from collections import Counter
from collections.abc import Mapping, Sequence
from statistics import median
from typing import Any, Final

from results_file import Row, wilson_interval

#: Of the tasks, so many have to end in the same scene graph in both engines.
REQUIRED: Final = ">= 0.95"

Verdicts = Sequence[Mapping[str, Any]]


def make_rows(results: Mapping[str, Verdicts], blocks: int, source: str) -> list[Row]:
    """The published rows.

    Args:
        results: verdicts as JSON has them, of ``tasks``, and of the controls ``still`` (the arm is
            told nothing) and ``weak`` (fingers too weak to carry a block).
        blocks: in each task.
        source: how the tasks were executed.
    """
    tasks = [task for task in results["tasks"] if task["trajectories"]]
    name = f"{blocks} blocks, executed in pybullet"
    by = "the four nodes" if source == "graph" else "planners and simulator in one process"
    rows = [
        _share(
            name,
            "same scene graph in MuJoCo",
            [task["same"] for task in tasks],
            f"executed by {by}; 95% Wilson interval",
            REQUIRED if blocks == 6 else None,
        ),
        _share(
            name,
            "same scene graph, trivial baseline: the arm does not move",
            [not task["moved"] for task in tasks],
            "share of the tasks that end as they begin",
        ),
    ]
    if results["still"]:
        rows.append(
            _share(
                name,
                "blocks stand still in MuJoCo where the arm is told nothing",
                [task["unrest"] < 1e-3 for task in results["still"]],
                "to within 1 mm",
            )
        )
        rows.append(
            _share(
                name,
                "same scene graph, fingers too weak to carry a block",
                [task["same"] for task in results["weak"]],
                "0.2 N instead of 20 N: shows that this judge can say no",
            )
        )
    for metric, key in (
        ("largest distance of a block's final positions", "final_deviation"),
        ("largest distance of a block's positions at any time", "largest_deviation"),
    ):
        values = [1e3 * task[key] for task in tasks if task["same"]]
        if values:
            note = "where the scene graphs are the same; median and extremes over tasks"
            rows.append(_median(name, metric, values, note))
    for engine, key in (("pybullet", "recorded_slips"), ("MuJoCo", "replayed_slips")):
        slips = [1e3 * value for task in tasks for value in task[key]]
        if slips:
            note = "median and extremes over grasps"
            rows.append(_median(name, f"slip in the hand, {engine}", slips, note))
    if len(tasks) < len(results["tasks"]):
        nothing = [not task["trajectories"] for task in results["tasks"]]
        rows.append(_share(name, "nothing was executed; left out above", nothing, ""))
    causes = Counter(task["cause"] for task in tasks if task["cause"])
    for cause, count in causes.most_common():
        share = [True] * count + [False] * (len(tasks) - count)
        rows.append(_share(name, f"differs: {cause}", share, ""))
    return rows


def verdict_details(tasks: Verdicts, again: str) -> dict[str, Any]:
    """What else belongs to the measurement.

    Args:
        tasks: verdicts.
        again: the command that runs one again, with ``{seed}`` in it.
    """
    keys = ("seed", "cause", "sentence", "missing", "extra", "notes")
    return {
        "differences": [
            {**{key: task[key] for key in keys}, "again": again.format(seed=task["seed"])}
            for task in tasks
            if not task["same"]
        ],
        "tasks": [
            {
                "seed": task["seed"],
                "same": task["same"],
                "success": task["success"],
                "grasps": task["grasps"],
                "final_deviation_mm": round(1e3 * task["final_deviation"], 2),
                "largest_deviation_mm": round(1e3 * task["largest_deviation"], 2),
                "parted_at_s": task["parted_at"],
            }
            for task in tasks
        ],
    }


def differences_table(differences: Sequence[Mapping[str, Any]]) -> list[str]:
    """Where the engines part, one line a task, in Markdown."""
    lines = [
        "Tasks that end in another scene graph in MuJoCo, and where the engines part.",
        "",
        "| seed | what happens in MuJoCo | only in pybullet | only in MuJoCo | again |",
        "|---:|---|---|---|---|",
    ]
    for item in differences:
        missing, extra = (
            ", ".join(f"{subject} {predicate} {below}" for subject, predicate, below in item[key])
            for key in ("missing", "extra")
        )
        cells = (str(item["seed"]), item["sentence"], missing, extra, f"`{item['again']}`")
        lines.append("| " + " | ".join(cell.replace("|", "\\|") for cell in cells) + " |")
    return lines


def _share(
    name: str, metric: str, found: Sequence[bool], note: str, required: str | None = None
) -> Row:
    count, n = sum(found), len(found)
    interval = wilson_interval(count, n)
    return Row(name, metric, count / n, "", n, interval, required=required, note=note or None)


def _median(name: str, metric: str, values: Sequence[float], note: str) -> Row:
    return Row(
        name, metric, median(values), "mm", len(values), (min(values), max(values)), note=note
    )
