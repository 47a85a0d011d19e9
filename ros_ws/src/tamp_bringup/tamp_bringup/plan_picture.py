# SPDX-License-Identifier: Apache-2.0
"""Draws a plan like Figure 5.4: the start as seen, every predicted state, the goal, the actions."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path

import matplotlib
import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.patches import Ellipse, FancyBboxPatch, Patch
from numpy.typing import NDArray

from scene_graph import COLORS, CYLINDER, SPHERE, Move, Stacks, split_object_name

matplotlib.use("Agg")

_COLUMNS = 5
_GREEN = "#1a8f2e"


def draw_plan(
    path: Path,
    image: NDArray[np.uint8] | None,
    states: Sequence[Stacks],
    moves: Sequence[Move],
    goal: str,
) -> None:
    """Writes the picture.

    Args:
        image: the camera image of the start, (height, width, 3) uint8, or None.
        states: the start and the predicted state after each move; one more than ``moves``.
        goal: in words.
    """
    panels = len(states) + 1
    rows = -(-panels // _COLUMNS)
    figure = Figure(figsize=(2.6 * min(panels, _COLUMNS), 2.9 * rows), layout="constrained")
    axes = figure.subplots(rows, min(panels, _COLUMNS), squeeze=False).ravel()
    for axis in axes:
        axis.set_axis_off()
    if image is not None:
        axes[0].imshow(image)
        axes[0].set_title("camera", fontsize=9)
    else:
        axes[0].set_title("no image", fontsize=9)
    for index, (axis, state) in enumerate(zip(axes[1:], states)):
        draw_state(axis, state)
        if index == len(moves):
            axis.set_title("goal" if moves else "start = goal", fontsize=9)
        else:
            axis.set_title("start" if index == 0 else f"after move {index}", fontsize=9)
            moved = state[moves[index].source][-1].replace("_", " ")
            axis.text(
                0.02,
                0.98,
                f"{moves[index]}  {moved}",
                transform=axis.transAxes,
                color=_GREEN,
                fontsize=9,
                fontweight="bold",
                verticalalignment="top",
            )
    figure.suptitle(_wrapped(f"goal: {goal}"), fontsize=9)
    path.parent.mkdir(parents=True, exist_ok=True)
    figure.savefig(path, dpi=110)


def draw_state(axis: Axes, stacks: Stacks) -> None:
    """Draws one symbolic state: a column a stack, blocks in their colours and shapes."""
    highest = max(4, sum(len(stack) for stack in stacks))
    axis.set_xlim(-0.75, len(stacks) - 0.25)
    axis.set_ylim(-0.6, highest + 0.9)
    axis.plot([-0.6, len(stacks) - 0.4], [0.0, 0.0], color="0.3", linewidth=2)
    for index, stack in enumerate(stacks):
        axis.text(index, -0.12, f"stack{index}", ha="center", va="top", fontsize=7, color="0.3")
        for level, name in enumerate(stack):
            _draw_block(axis, index, level, name)


def _draw_block(axis: Axes, column: int, level: int, name: str) -> None:
    try:
        color, shape = split_object_name("_".join(name.split("_")[:2]))
        face = COLORS[color]
    except ValueError:
        face, shape = (0.7, 0.7, 0.7), ""
    if shape == SPHERE:
        patch: Patch = Ellipse((column, level + 0.5), 0.72, 0.92, facecolor=face, edgecolor="0.2")
    else:
        rounding = 0.18 if shape == CYLINDER else 0.03
        patch = FancyBboxPatch(
            (column - 0.34, level + 0.06),
            0.68,
            0.88,
            boxstyle=f"round,pad=0,rounding_size={rounding}",
            facecolor=face,
            edgecolor="0.2",
        )
    axis.add_patch(patch)
    dark = sum(face) < 1.4
    label = name.split("_")[0]
    axis.text(
        column,
        level + 0.5,
        label,
        ha="center",
        va="center",
        fontsize=7,
        color="white" if dark else "black",
    )


def _wrapped(text: str, width: int = 110) -> str:
    lines = [""]
    for word in text.split():
        if len(lines[-1]) + len(word) > width:
            lines.append("")
        lines[-1] += f"{word} "
    return "\n".join(line.rstrip() for line in lines)
