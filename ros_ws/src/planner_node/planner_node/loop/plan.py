# SPDX-License-Identifier: Apache-2.0
"""A plan to be carried out: the moves, the scene they start from, and those they lead to."""

from __future__ import annotations

import uuid
from collections.abc import Sequence
from dataclasses import dataclass

from scene_graph import Move, SceneGraph, SceneObject, Stacks, up_relations

from ..action_models import GraphModel, apply_to_graph
from ..goals.goal import Goal
from ..search import SearchResult
from .scene import Scene


@dataclass(frozen=True)
class Plan:
    """What the motion node is asked to do.

    Attributes:
        plan_id: names the plan wherever it is spoken of; unique.
        stamp: when it was made, in ROS time [ns].
        scene: what it starts from.
        goal: what it achieves.
        moves: in order.
        states: the state before the first move and after each.
        predicted: the scene after each move: names, relations and places, no poses.
        watched: the motion node is told what is seen, see :class:`.plan_watch.PlanSight`.
        explain: nothing is to move; it is only asked why it was refused, and what would help.
    """

    plan_id: str
    stamp: int
    scene: Scene
    goal: Goal
    moves: tuple[Move, ...]
    states: tuple[Stacks, ...]
    predicted: tuple[SceneGraph, ...]
    explain: bool = False
    watched: bool = False

    @property
    def blocks(self) -> tuple[str, ...]:
        """The block that each move takes."""
        return tuple(state[move.source][-1] for move, state in zip(self.moves, self.states))


def plan_for(scene: Scene, goal: Goal, found: SearchResult, stamp: int) -> Plan:
    """The plan that a search has found, under a new name; ``stamp`` is the ROS time [ns]."""
    return Plan(
        plan_id=uuid.uuid4().hex[:12],
        stamp=stamp,
        scene=scene,
        goal=goal,
        moves=found.moves,
        states=found.states,
        predicted=_predicted(scene, found.moves, apply_to_graph),
    )


def _predicted(scene: Scene, moves: Sequence[Move], model: GraphModel) -> tuple[SceneGraph, ...]:
    """The scene after each move, by an action model M; nobody has seen it yet."""
    objects = tuple(
        SceneObject(item.name, item.color, item.shape, size=item.size, confidence=0.0)
        for item in scene.graph.objects
    )
    graphs = []
    relations = up_relations(scene.stacks)
    for move in moves:
        relations = model(relations, move)
        graphs.append(SceneGraph(objects, relations, scene.graph.places, scene.graph.confidence))
    return tuple(graphs)
