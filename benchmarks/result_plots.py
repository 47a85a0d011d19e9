# SPDX-License-Identifier: Apache-2.0
"""Plots of the results page, drawn from the details of a result file."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import Any, Final

import matplotlib
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.patches import Patch

#: What the machine does before the arm moves; the rest of a task is execution.
THINKING: Final = ("perceive", "plan", "motion")
_COLORS: Final = {"perceive": "#4c72b0", "plan": "#dd8452", "motion": "#8172b3"}
#: Shares down to 1e-4 are told apart; zero can be drawn.
_SCALES: Final[dict[str, dict[str, float]]] = {"x": {}, "y": {"linthresh": 1e-4}}
_SUCCEEDED: Final = "#55a868"
_FAILED: Final = "#c44e52"
#: Of more tasks only every tenth can be named below its bar.
_NAMED_BARS: Final = 60


def plot_result(result: Mapping[str, Any], folder: Path) -> list[Path]:
    """Draws what a result file has details for; equal results give equal files.

    Returns:
        The files written: ``NAME.svg`` where the details list timed tasks, and ``NAME_CURVES.svg``
        for each of their curves.
    """
    details = result.get("details") or {}
    figures = {
        f"{result['name']}_{name}": draw_curves(curves)
        for name, curves in details.get("curves", {}).items()
    }
    tasks = details.get("tasks")
    if tasks and all("timing_s" in task for task in tasks):
        figures[result["name"]] = draw_tasks(tasks)
    return [_saved(figure, folder / f"{name}.svg") for name, figure in figures.items()]


def _saved(figure: Figure, path: Path) -> Path:
    path.parent.mkdir(parents=True, exist_ok=True)
    # Without date and with fixed identifiers, so that an unchanged result is an unchanged file.
    with matplotlib.rc_context({"svg.hashsalt": path.stem}):
        figure.savefig(path, metadata={"Date": None})
    return path


def draw_curves(curves: Mapping[str, Any]) -> Figure:
    """Lines of one picture: ``x``, ``y`` and ``title`` name it, ``log`` which axes are so.

    ``lines`` has for each label its points, [x, y] each.
    """
    figure = Figure(figsize=(6.0, 3.6), layout="constrained")
    axes = figure.subplots()
    for name, points in curves["lines"].items():
        xs, ys = zip(*points)
        axes.plot(xs, ys, marker="o", markersize=3.0, label=name)
    for axis in curves.get("log", ""):
        getattr(axes, f"set_{axis}scale")("log" if axis == "x" else "symlog", **_SCALES[axis])
    axes.set_title(curves["title"])
    axes.set_xlabel(curves["x"])
    axes.set_ylabel(curves["y"])
    axes.grid(alpha=0.3)
    axes.legend(frameon=False, fontsize=8)
    return figure


def draw_tasks(tasks: Sequence[Mapping[str, Any]]) -> Figure:
    """One bar a task: seconds of thinking above, seconds of execution and success below."""
    width = min(12.0, max(6.0, 2.0 + 0.3 * len(tasks)))
    figure = Figure(figsize=(width, 5.0), layout="constrained")
    above, below = figure.subplots(2, 1, sharex=True)
    _draw_thinking(above, tasks)
    _draw_execution(below, tasks)
    return figure


def _draw_thinking(axes: Axes, tasks: Sequence[Mapping[str, Any]]) -> None:
    places = range(len(tasks))
    bottoms = [0.0] * len(tasks)
    for stage in THINKING:
        seconds = [task["timing_s"][stage] for task in tasks]
        axes.bar(places, seconds, bottom=bottoms, color=_COLORS[stage], label=stage)
        bottoms = [low + high for low, high in zip(bottoms, seconds)]
    axes.set_ylabel("seconds before\nthe arm moves")
    axes.legend(ncols=len(THINKING), loc="lower right", bbox_to_anchor=(1.0, 1.0), frameon=False)


def _draw_execution(axes: Axes, tasks: Sequence[Mapping[str, Any]]) -> None:
    places = range(len(tasks))
    bars = axes.bar(
        places,
        [task["timing_s"]["execute"] for task in tasks],
        color=[_SUCCEEDED if task["success"] else _FAILED for task in tasks],
    )
    if len(tasks) <= _NAMED_BARS:
        axes.bar_label(bars, [str(task["moves_executed"]) for task in tasks], fontsize=7)
        axes.set_ylabel("seconds of execution\n(label: moves)")
    else:
        axes.set_ylabel("seconds of execution")
    named = list(places)[:: 1 if len(tasks) <= _NAMED_BARS else 10]
    seeds = [str(tasks[place]["seed"]) for place in named]
    axes.set_xticks(named, seeds, rotation=90, fontsize=7)
    axes.set_xlabel("seed of the task")
    axes.margins(y=0.15)
    axes.legend(
        handles=[Patch(color=_SUCCEEDED, label="success"), Patch(color=_FAILED, label="failure")],
        ncols=2,
        loc="lower right",
        bbox_to_anchor=(1.0, 1.0),
        frameon=False,
    )
