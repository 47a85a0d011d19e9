# SPDX-License-Identifier: Apache-2.0
"""Plans as lines of text for the terminal."""

from __future__ import annotations

from tamp_interfaces.msg import SceneGraph, SymbolicPlan
from tamp_runtime.messages.scene_graph import relations_from_messages

from scene_graph import (
    InconsistentRelationsError,
    format_relations,
    format_stacks,
    stacks_from_relations,
)


def describe_scene(graph: SceneGraph) -> str:
    """The stacks from the left; the relations where they do not describe stacks."""
    relations = relations_from_messages(graph.relations)
    try:
        return format_stacks(stacks_from_relations(relations, len(graph.bases)))
    except InconsistentRelationsError:
        return format_relations(relations)


def describe_plan(plan: SymbolicPlan, states: list[SceneGraph]) -> list[str]:
    """One line a move: the action (p, q), the block, and the predicted scene."""
    width = max([len(move.object_name) for move in plan.moves] + [5])
    lines = [f"       {'start':{width}}  {describe_scene(plan.initial)}"]
    for move, state in zip(plan.moves, states):
        action = f"({move.source}, {move.target})"
        lines.append(f"{action} {move.object_name:{width}}  {describe_scene(state)}")
    return lines
