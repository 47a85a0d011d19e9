# SPDX-License-Identifier: Apache-2.0
"""Draws the tasks of a family: the same seed gives the same task, and nothing else matters."""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from dataclasses import asdict, dataclass, field, replace
from typing import Any, Final

import numpy as np

from scene_graph import Stacks, object_name
from sim_node.layouts import random_arrangement, random_layout
from tamp_bringup.task import goal_text, random_goal
from tasks.family import Family, Range, Row, Viewpoint
from tasks.two_rows import row_goal
from tasks.view import camera_of

#: Written and drawn alike: tenths of a millimetre.
_DIGITS: Final = 4
#: So many rows are drawn until one is in reach; of a thousand none was never seen.
_ROWS_TRIED: Final = 1000

Point = tuple[float, float]
Drawn = float | str


@dataclass(frozen=True)
class Task:
    """One task, complete: what is written down of it is enough to run it again.

    Attributes:
        family, seed: what it was drawn from.
        layout: where the blocks stand when it begins.
        goal: as text.
        scene: content of its scene file; None: the plain world.
        parameters: of the nodes, by node; that of the scene file is added where it is written.
        disturbance: request to ``sim/disturb``; empty: nothing goes wrong.
        drawn: what failures are sorted by, see :data:`tasks.failures.AXES`.
    """

    family: str
    seed: int
    layout: Stacks
    goal: str
    scene: Mapping[str, Any] | None = None
    parameters: Mapping[str, Mapping[str, Any]] = field(default_factory=dict)
    disturbance: Mapping[str, Any] = field(default_factory=dict)
    drawn: Mapping[str, Drawn] = field(default_factory=dict)

    def to_json(self) -> dict[str, Any]:
        """For a file, with lists in place of tuples."""
        return {**asdict(self), "layout": [list(stack) for stack in self.layout]}

    @classmethod
    def from_json(cls, content: Mapping[str, Any]) -> Task:
        """The inverse of :meth:`to_json`."""
        return cls(**{**content, "layout": tuple(tuple(stack) for stack in content["layout"])})


def draw_task(family: Family, seed: int) -> Task:
    """The task of a family that a seed means."""
    if family.has_own_scenes:
        return _task_of_its_own(family, seed)
    low, high = family.blocks
    blocks = low if low == high else int(np.random.default_rng([seed, 2]).integers(low, high + 1))
    layout = random_layout(seed, blocks)
    goal = random_goal([name for stack in layout for name in stack], seed)
    return _with_errors(Task(family.name, seed, layout, goal_text(goal),
                             drawn=_heights(layout, goal)), family)  # fmt: skip


def _task_of_its_own(family: Family, seed: int) -> Task:
    rng = np.random.default_rng([seed, 2])
    blocks = int(rng.integers(family.blocks[0], family.blocks[1] + 1))
    if family.rows:
        places = family.rows.places(rng)
    else:
        places = draw_row(family.row or Row((3, 3), (0.15, 0.15)), rng)
    colors = [str(color) for color in rng.permutation(list(family.colors))[:blocks]]
    names = [object_name(color, str(rng.choice(list(family.shapes)))) for color in colors]
    sizes = {name: _uniform(family.sizes or (0.045, 0.045), rng) for name in names}
    layout = (
        family.rows.layout(names, rng)
        if family.rows
        else random_arrangement(names, rng, len(places))
    )
    goal = _other_goal(layout, rng)
    told = goal_text(goal)
    if family.rows and rng.random() < 0.5:
        told = row_goal(goal, family.rows.count, rng)
    highest = sum(sizes.values())
    view = family.viewpoint or Viewpoint(azimuth=0.0)
    azimuth = round(float(rng.uniform(-view.azimuth, view.azimuth)), _DIGITS)
    scene = {
        "places": [list(place) for place in places],
        "blocks": {"named": {name: {"size": [size] * 3} for name, size in sizes.items()}},
        "cameras": [
            family.rows.view(rng) if family.rows else camera_of(view, places, highest, azimuth)
        ],
    }
    parameters = {
        "perception_node": {"stack_positions": [value for x, y in places for value in (x, y, 0.0)]}
    }
    drawn = {
        "places": len(places),
        "blocks": blocks,
        "smallest block": 100.0 * min(sizes.values()),
        "camera angle": math.degrees(azimuth),
        "farthest place": max(math.hypot(*place) for place in places),
        **_heights(layout, goal),
    }
    rounded = {name: round(float(value), _DIGITS) for name, value in drawn.items()}
    task = Task(family.name, seed, layout, told, scene, parameters, {}, rounded)
    return _with_errors(task, family)


def _with_errors(task: Task, family: Family) -> Task:
    """The task with what goes wrong in it, drawn apart from all else."""
    rng = np.random.default_rng([task.seed, 3])
    drawn: dict[str, Drawn] = dict(task.drawn)
    sensor, disturbance = dict(family.noise), dict(task.disturbance)
    if family.masks:
        kind = str(rng.choice(list(family.masks)))
        sensor |= {"sensor.segmentation.kind": kind, "sensor.segmentation.strength": 1}
        drawn["masks"] = kind
    if family.disturbances:
        disturbance = dict(family.disturbances[int(rng.integers(len(family.disturbances)))])
        drawn["disturbance"] = " ".join(
            str(disturbance[key]) for key in ("kind", "what", "when") if key in disturbance
        )
    parameters = {node: dict(values) for node, values in task.parameters.items()}
    if sensor:
        parameters["sim_node"] = {**sensor, "sensor.seed": task.seed}
    if family.mask_source:
        parameters.setdefault("perception_node", {})["mask_source"] = family.mask_source
    return replace(task, parameters=parameters, disturbance=disturbance, drawn=drawn)


def reachable_goal(layout: Stacks, rng: np.random.Generator) -> Stacks:
    """A random state that moves can lead to.

    From three places on that is every state. With two, a block that is to get past another has
    nowhere to wait: the order of the blocks along one stack down and the other one up stays for
    ever, and a state is only where that order is cut.
    """
    if len(layout) != 2:
        return random_arrangement(
            sorted(name for stack in layout for name in stack), rng, len(layout)
        )
    order = layout[0] + layout[1][::-1]
    cut = int(rng.integers(len(order) + 1))
    return order[:cut], order[cut:][::-1]


def _other_goal(layout: Stacks, rng: np.random.Generator) -> Stacks:
    """One that is not there yet."""
    while (goal := reachable_goal(layout, rng)) == layout:
        pass
    return goal


def draw_row(row: Row, rng: np.random.Generator) -> tuple[Point, ...]:
    """Places from the left of the image, (x, y) on the table [m].

    Raises:
        RuntimeError: no row of the family is in reach.
    """
    count = int(rng.integers(row.count[0], row.count[1] + 1))
    for _ in range(_ROWS_TRIED):
        gaps = rng.uniform(*row.gap, count - 1)
        along = np.concatenate([[0.0], np.cumsum(gaps)])
        along -= 0.5 * along[-1]
        turn = rng.uniform(-row.turn, row.turn)
        distance, bearing = rng.uniform(*row.reach), rng.uniform(-row.bearing, row.bearing)
        centre = distance * np.array([math.cos(bearing), math.sin(bearing)])
        points = centre + along[:, None] * np.array([-math.sin(turn), math.cos(turn)])
        places = tuple((round(float(x), _DIGITS), round(float(y), _DIGITS)) for x, y in points)
        if all(_is_in_reach(row, place) for place in places):
            return places
    raise RuntimeError(f"no row of {count} places of this family is in reach: {row}")


def _is_in_reach(row: Row, place: Point) -> bool:
    x, y = place
    low, high = row.reach
    return low <= math.hypot(x, y) <= high and abs(math.atan2(y, x)) <= row.bearing


def _heights(layout: Stacks, goal: Stacks) -> dict[str, float]:
    return {
        "highest stack of the start": float(max(map(len, layout))),
        "highest stack of the goal": float(max(map(len, goal))),
    }


def _uniform(limits: Range, rng: np.random.Generator) -> float:
    return round(float(rng.uniform(*limits)), _DIGITS)


def unknown_parameters(task: Task, known: Mapping[str, Sequence[str]]) -> list[str]:
    """Those that a node would silently pass over, as ``NODE.NAME``.

    Args:
        known: names of the parameters that each node declares.
    """
    return [
        f"{node}.{name}"
        for node, values in task.parameters.items()
        for name in values
        if name not in known[node]
    ] + ([] if task.scene is None or "scene" in known["sim_node"] else ["sim_node.scene"])
