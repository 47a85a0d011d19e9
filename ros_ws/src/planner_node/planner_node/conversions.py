# SPDX-License-Identifier: Apache-2.0
"""The only place where messages meet the types of the planner."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any, Final

from builtin_interfaces.msg import Time
from std_msgs.msg import Header
from tamp_interfaces.action import AchieveGoal
from tamp_interfaces.msg import SceneGraph as SceneGraphMsg
from tamp_interfaces.msg import SceneObject, SymbolicPlan
from tamp_runtime.messages.scene_graph import (
    graph_from_message,
    moves_to_messages,
    relations_to_messages,
)

from scene_graph import Relation, SceneGraphError, Stacks, up_relations

from .action_model import apply_to_graph
from .errors import NotConfidentError, PlannerError
from .goals import Goal
from .search import SearchResult

GRAPH_STATUSES: Final = (
    "CONFIDENT",
    "LOW_CONFIDENCE",
    "OCCLUDED",
    "UNSTABLE",
    "NO_OBJECTS",
    "BAD_IMAGE",
)
MOTION_STATES: Final = ("IDLE", "OPTIMISING", "EXECUTING", "SUCCEEDED", "CANCELLED", "FAILED")


@dataclass(frozen=True)
class Scene:
    """A scene graph that can be planned on: the message and the state that it describes."""

    message: Any
    stacks: Stacks

    @property
    def names(self) -> tuple[str, ...]:
        """The names of all objects, sorted."""
        return tuple(sorted(name for stack in self.stacks for name in stack))


def scene_from_message(message: SceneGraphMsg, min_confidence: float) -> Scene:
    """Raises NotConfidentError if the graph cannot be planned on; the sentence says why."""
    if message.status != SceneGraphMsg.CONFIDENT:
        raise NotConfidentError(
            message.message
            or f"perception reports {constant_name(SceneGraphMsg, message.status, GRAPH_STATUSES)}"
        )
    if message.confidence < min_confidence:
        raise NotConfidentError(
            f"the scene graph's confidence {message.confidence:.2f} is below min_confidence "
            f"{min_confidence:.2f}; look again, or lower the parameter"
        )
    try:
        graph = graph_from_message(message)
        stacks = graph.stacks()
    except (SceneGraphError, ValueError) as error:
        raise NotConfidentError(f"the scene graph contradicts itself: {error}") from error
    if not graph.places:
        raise NotConfidentError("the scene graph has no bases, so that stacks cannot be told apart")
    on_stacks = {name for stack in stacks for name in stack}
    if on_stacks != set(graph.names):
        odd = ", ".join(sorted(on_stacks ^ set(graph.names)))
        raise NotConfidentError(
            f"the scene graph is incomplete: objects and relations differ: {odd}"
        )
    return Scene(message, stacks)


def plan_to_message(
    scene: Scene, goal: Goal, result: SearchResult, plan_id: str, stamp: Time
) -> SymbolicPlan:
    return SymbolicPlan(
        header=Header(stamp=stamp, frame_id=scene.message.header.frame_id),
        plan_id=plan_id,
        initial=scene.message,
        moves=moves_to_messages(result.moves, result.states),
        goal=relations_to_messages(goal.witnesses(result.states[-1])),
    )


def predicted_scenes(scene: Scene, result: SearchResult) -> list[SceneGraphMsg]:
    """The scene after each move, by the action model M: names, relations and bases, no poses."""
    graphs = []
    relations: frozenset[Relation] = up_relations(scene.stacks)
    for move in result.moves:
        relations = apply_to_graph(relations, move)
        graphs.append(
            SceneGraphMsg(
                header=Header(frame_id=scene.message.header.frame_id),
                objects=[
                    SceneObject(name=item.name, color=item.color, shape=item.shape, size=item.size)
                    for item in scene.message.objects
                ],
                relations=relations_to_messages(relations),
                bases=scene.message.bases,
                confidence=scene.message.confidence,
            )
        )
    return graphs


def status_code(error: PlannerError) -> int:
    """The number of an error in PlanToGoal and AchieveGoal, which share it."""
    code: int = getattr(AchieveGoal.Result, error.status)
    return code


def constant_name(message_type: Any, value: int, names: tuple[str, ...]) -> str:
    """The one of ``names`` whose constant in the message has this value."""
    for name in names:
        if getattr(message_type, name) == value:
            return name
    return str(value)
