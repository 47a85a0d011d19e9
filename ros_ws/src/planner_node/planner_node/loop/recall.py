# SPDX-License-Identifier: Apache-2.0
"""What was seen before, in the place of what blocks hide now (5.4.3)."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import replace
from typing import Final

from tamp_runtime.motion_report import MotionReport, MotionState

from scene_graph import (
    SceneObject,
    Stacks,
    front_relations,
    is_hidden,
    rows_of,
    up_relations,
)

from .plan import Plan
from .scene import Scene

#: Heights of one block may differ by this from what was measured [m].
TOLERANCE: Final = 0.006


def recall(scene: Scene, plan: Plan, report: MotionReport) -> Scene:
    """A scene after a plan, with what the plan knows of where blocks are hidden now.

    Nothing is taken from memory that what is seen contradicts: every place that is seen has to be
    as the plan predicts it, and hidden blocks have to fit where they are hidden.
    """
    if not scene.hidden:
        return scene
    done = min(report.moves_done, len(plan.moves))
    complete = report.state == MotionState.SUCCEEDED
    for expected in [plan.states[-1]] if complete else plan.states[done : done + 2]:
        stacks = recalled(scene, expected, plan.scene.graph.objects)
        if stacks is not None:
            return _with(scene, stacks, plan)
    return scene


def recalled(scene: Scene, expected: Stacks, objects: Sequence[SceneObject]) -> Stacks | None:
    """The state that fits what is seen and what is expected; None where they contradict."""
    heights = {item.name: item.size[2] for item in (*objects, *scene.graph.objects)}
    seen = {name for stack in scene.stacks for name in stack}
    stacks = []
    for here, before in zip(scene.stacks, expected):
        if any(map(is_hidden, before)):
            stacks.append(here)  # it was not known before
        elif _fits(here, [name for name in before], seen, heights):
            stacks.append(before)
        else:
            return None
    return tuple(stacks)


def _fits(
    here: Sequence[str], before: Sequence[str], seen: set[str], heights: Mapping[str, float]
) -> bool:
    """Whether a stack is the expected one, with hidden blocks where something stands for them."""
    left = list(before)
    for level, name in enumerate(here):
        if not is_hidden(name):
            if not left or left.pop(0) != name:
                return False
            continue
        height, count = 0.0, 0
        while left and left[0] not in seen:
            height, count = height + heights.get(left.pop(0), 0.0), count + 1
        off = height - heights[name]
        # On top there may be less than there is room for.
        if off > TOLERANCE * (count + 1) or (level + 1 < len(here) and -off > TOLERANCE * count):
            return False
    return not left


def _with(scene: Scene, stacks: Stacks, plan: Plan) -> Scene:
    """The scene with what stands for hidden blocks exchanged for those that are remembered."""
    graph, places = scene.graph, scene.graph.places
    names = {name for stack in stacks for name in stack}
    objects = {item.name: item for item in graph.objects if item.name in names}
    known = {item.name: item for item in plan.scene.graph.objects}
    for index, stack in enumerate(stacks):
        x, y, top = places[index].position_world
        for level, name in enumerate(stack):
            if name not in objects:
                item = known[name]
                if plan.scene.stacks[index][: level + 1] != stack[: level + 1]:
                    item = replace(item, position_world=(x, y, top + 0.5 * item.size[2]))
                objects[name] = item
            x, y, middle = objects[name].position_world
            top = middle + 0.5 * objects[name].size[2]
    graph = replace(
        graph,
        objects=tuple(objects[name] for name in sorted(objects)),
        relations=up_relations(stacks) | front_relations(stacks, rows_of(places)),
    )
    return replace(scene, graph=graph, stacks=stacks)
