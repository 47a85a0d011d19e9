# SPDX-License-Identifier: Apache-2.0
"""Scene graphs survive the way into a message and back."""

from dataclasses import replace

import pytest
from std_msgs.msg import Header
from tamp_runtime.messages.scene_graph import (
    graph_from_message,
    graph_to_message,
    moves_from_messages,
    moves_to_messages,
    relations_from_messages,
    relations_to_messages,
)

from scene_graph import Move, Place, Relation, SceneGraph, SceneObject, up_relations

STACKS = (("red_box", "blue_box"), (), ("green_box",))
GRAPH = SceneGraph(
    objects=(
        SceneObject("blue_box", "blue", "box", (0.5, -0.125, 0.0625), (0.0, 0.0, 0.0, 1.0),
                    (0.5, 0.25, 0.125), 3, (0.25, 0.5), 0.75),
        SceneObject("green_box", "green", "box"),
        SceneObject("red_box", "red", "box"),
    ),
    relations=up_relations(STACKS),
    places=tuple(Place(index, (0.5, 0.25 * index, 0.0)) for index in range(3)),
    confidence=0.75,
)  # fmt: skip


def test_there_and_back_changes_nothing() -> None:
    # All numbers above are exact in float32, so equality is exact.
    assert graph_from_message(graph_to_message(GRAPH, Header())) == GRAPH


def test_what_is_hidden_of_places_goes_there_and_back() -> None:
    places = (Place(0, (0.5, 0.0, 0.0), 0.25, 0.125), Place(1, (0.5, 0.25, 0.0)))
    back = graph_from_message(graph_to_message(replace(GRAPH, places=places), Header()))
    assert [(item.hidden, item.seen_to) for item in back.places] == [(0.25, 0.125), (0.0, 0.0)]


def test_objects_and_relations_come_sorted() -> None:
    message = graph_to_message(GRAPH, Header())
    assert [item.name for item in message.objects] == ["blue_box", "green_box", "red_box"]
    assert relations_from_messages(relations_to_messages(GRAPH.relations)) == GRAPH.relations


def test_moves_name_the_block_that_they_take() -> None:
    moves = [Move(0, 1), Move(2, 1)]
    states = [STACKS, (("red_box",), ("blue_box",), ("green_box",))]
    messages = moves_to_messages(moves, states)
    assert [item.object_name for item in messages] == ["blue_box", "green_box"]
    assert moves_from_messages(messages) == tuple(moves)


def test_a_graph_with_a_name_twice_is_refused() -> None:
    message = graph_to_message(GRAPH, Header())
    message.objects[0].name = message.objects[1].name
    with pytest.raises(ValueError, match="not unique"):
        graph_from_message(message)


def test_an_unknown_predicate_is_refused() -> None:
    messages = relations_to_messages([Relation("a", "up", "b")])
    messages[0].predicate = "inside"
    with pytest.raises(ValueError, match="inside"):
        relations_from_messages(messages)
