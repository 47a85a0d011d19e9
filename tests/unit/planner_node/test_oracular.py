# SPDX-License-Identifier: Apache-2.0
from __future__ import annotations

import pytest
from planner_states import NAMES, all_states

from planner_node.action_models import apply_to_graph
from scene_graph import (
    ImpossibleMoveError,
    Move,
    Relation,
    all_moves,
    apply_move,
    left_relations,
    up_relations,
)


def test_relations_and_stacks_are_moved_alike() -> None:
    for state in all_states(NAMES[:4], 3):
        for move in all_moves(3):
            if not state[move.source]:
                with pytest.raises(ImpossibleMoveError):
                    apply_to_graph(up_relations(state), move)
                continue
            moved = apply_to_graph(up_relations(state), move)
            assert moved == up_relations(apply_move(state, move))


def test_the_moved_block_loses_all_its_relations() -> None:
    state = (("red_box",), ("blue_box",), ())
    graph = up_relations(state) | left_relations(state)
    assert apply_to_graph(graph, Move(0, 1)) == {
        Relation("blue_box", "up", "stack1"),
        Relation("red_box", "up", "blue_box"),
    }


def test_a_move_onto_itself_is_impossible() -> None:
    with pytest.raises(ImpossibleMoveError):
        apply_to_graph(up_relations((("red_box",), ())), Move(0, 0))
