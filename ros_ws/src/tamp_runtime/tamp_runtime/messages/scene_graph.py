# SPDX-License-Identifier: Apache-2.0
"""Where the messages of tamp_interfaces meet the types of scene_graph."""

from __future__ import annotations

from collections.abc import Iterable, Sequence

from geometry_msgs.msg import Point, Pose, Quaternion, Vector3
from std_msgs.msg import Header
from tamp_interfaces.msg import Base as BaseMsg
from tamp_interfaces.msg import Move as MoveMsg
from tamp_interfaces.msg import Relation as RelationMsg
from tamp_interfaces.msg import SceneGraph as SceneGraphMsg
from tamp_interfaces.msg import SceneObject as SceneObjectMsg

from scene_graph import Move, Place, Relation, SceneGraph, SceneObject, Stacks


def object_to_message(item: SceneObject) -> SceneObjectMsg:
    """One block; poses are in the world frame, sizes in metres, as in :class:`SceneObject`."""
    x, y, z, w = item.quaternion_world
    return SceneObjectMsg(
        name=item.name,
        color=item.color,
        alternatives=list(item.alternatives),
        shape=item.shape,
        label=item.label,
        pose=Pose(
            position=Point(**dict(zip("xyz", map(float, item.position_world)))),
            orientation=Quaternion(x=float(x), y=float(y), z=float(z), w=float(w)),
        ),
        size=Vector3(**dict(zip("xyz", map(float, item.size)))),
        coordinates=[float(value) for value in item.coordinates],
        confidence=float(item.confidence),
    )


def object_from_message(message: SceneObjectMsg) -> SceneObject:
    """One block; the inverse of :func:`object_to_message`."""
    position, orientation, size = message.pose.position, message.pose.orientation, message.size
    return SceneObject(
        name=message.name,
        color=message.color,
        shape=message.shape,
        position_world=(position.x, position.y, position.z),
        quaternion_world=(orientation.x, orientation.y, orientation.z, orientation.w),
        size=(size.x, size.y, size.z),
        label=message.label,
        coordinates=(float(message.coordinates[0]), float(message.coordinates[1])),
        confidence=message.confidence,
        alternatives=tuple(message.alternatives),
    )


def relations_to_messages(relations: Iterable[Relation]) -> list[RelationMsg]:
    """Sorted, so that equal graphs give equal messages."""
    return [
        RelationMsg(subject=item.subject, predicate=item.predicate, object=item.object)
        for item in sorted(relations)
    ]


def relations_from_messages(messages: Iterable[RelationMsg]) -> frozenset[Relation]:
    """Raises ValueError for an unknown predicate."""
    return frozenset(Relation(item.subject, item.predicate, item.object) for item in messages)


def graph_to_message(graph: SceneGraph, header: Header) -> SceneGraphMsg:
    """Status, message and processing time are left at their defaults."""
    return SceneGraphMsg(
        header=header,
        objects=[
            object_to_message(item) for item in sorted(graph.objects, key=lambda item: item.name)
        ],
        relations=relations_to_messages(graph.relations),
        bases=[
            BaseMsg(
                index=place.index,
                position=Point(**dict(zip("xyz", map(float, place.position_world)))),
                hidden=float(place.hidden),
                seen_to=float(place.seen_to),
                row=place.row,
                column=place.column or 0,
                clear=[float(height) for height in place.clear],
                aside=place.aside,
            )
            for place in graph.places
        ],
        confidence=float(graph.confidence),
    )


def graph_from_message(message: SceneGraphMsg) -> SceneGraph:
    """Raises ValueError if names repeat or a predicate is unknown."""
    return SceneGraph(
        objects=tuple(object_from_message(item) for item in message.objects),
        relations=relations_from_messages(message.relations),
        places=_places_from_messages(message.bases),
        confidence=message.confidence,
    )


def _places_from_messages(messages: Sequence[BaseMsg]) -> tuple[Place, ...]:
    """Columns are told only of several rows."""
    several = any(item.row for item in messages)
    return tuple(
        Place(
            item.index,
            (item.position.x, item.position.y, item.position.z),
            item.hidden,
            item.seen_to,
            item.row,
            item.column if several else None,
            tuple(item.clear),
            item.aside,
        )
        for item in messages
    )


def moves_to_messages(moves: Sequence[Move], states: Sequence[Stacks]) -> list[MoveMsg]:
    """``states[i]`` is the state before ``moves[i]``; it names the block that is moved."""
    return [
        MoveMsg(source=move.source, target=move.target, object_name=state[move.source][-1])
        for move, state in zip(moves, states)
    ]


def moves_from_messages(messages: Iterable[MoveMsg]) -> tuple[Move, ...]:
    """The moves without the names of their blocks, which follow from the state before each."""
    return tuple(Move(item.source, item.target) for item in messages)
