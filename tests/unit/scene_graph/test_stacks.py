# SPDX-License-Identifier: Apache-2.0
"""States and up-relations with bases say the same thing (A.2.2)."""

import pytest
from hypothesis import given
from hypothesis import strategies as st

from scene_graph import (
    ImpossibleMoveError,
    InconsistentRelationsError,
    Move,
    Relation,
    all_moves,
    apply_move,
    base_index,
    left_relations,
    split_object_name,
    stacks_from_relations,
    up_relations,
)

NAMES = ["red_box", "green_box", "blue_box", "pink_box", "cyan_box"]


@st.composite
def states(draw: st.DrawFn) -> tuple[tuple[str, ...], ...]:
    stacks: list[list[str]] = [[], [], []]
    for name in draw(st.permutations(NAMES)):
        stacks[draw(st.integers(0, 2))].append(name)
    return tuple(map(tuple, stacks))


@given(states())
def test_relations_with_bases_are_a_complete_state(state: tuple[tuple[str, ...], ...]) -> None:
    assert stacks_from_relations(up_relations(state), 3) == state


@given(states(), st.sampled_from(all_moves(3)))
def test_a_move_and_its_opposite_change_nothing(
    state: tuple[tuple[str, ...], ...], move: Move
) -> None:
    if not state[move.source]:
        with pytest.raises(ImpossibleMoveError):
            apply_move(state, move)
        return
    moved = apply_move(state, move)
    assert moved != state
    assert apply_move(moved, Move(move.target, move.source)) == state


@pytest.mark.parametrize("move", [Move(0, 3), Move(-1, 0), Move(1, 1)])
def test_a_move_outside_the_table_is_refused(move: Move) -> None:
    with pytest.raises(ImpossibleMoveError):
        apply_move((("red_box",), ("blue_box",), ()), move)


@pytest.mark.parametrize(
    ("relations", "names"),
    [
        ([("red_box", "up", "stack0"), ("blue_box", "up", "stack0")], {"red_box", "blue_box"}),
        ([("red_box", "up", "stack0"), ("red_box", "up", "stack1")], {"red_box"}),
        ([("red_box", "up", "blue_box"), ("blue_box", "up", "red_box")], {"red_box", "blue_box"}),
        ([("red_box", "up", "stack7")], set()),
    ],
)
def test_impossible_relations_name_the_objects(
    relations: list[tuple[str, str, str]], names: set[str]
) -> None:
    with pytest.raises(InconsistentRelationsError) as caught:
        stacks_from_relations([Relation(*triple) for triple in relations], 3)
    assert set(caught.value.names) == names


def test_left_relations_join_neighbouring_stacks_only() -> None:
    assert left_relations((("a", "b"), (), ("c",))) == {Relation("a", "left", "c")}


def test_only_bases_have_a_base_index() -> None:
    assert [base_index(name) for name in ("stack0", "stack12", "stack01", "stack", "red_box")] == [
        0, 12, None, None, None,
    ]  # fmt: skip


def test_an_unknown_predicate_is_refused() -> None:
    with pytest.raises(ValueError, match="touches"):
        Relation("red_box", "touches", "blue_box")


def test_a_name_tells_colour_and_shape() -> None:
    assert split_object_name("red_cylinder") == ("red", "cylinder")
    with pytest.raises(ValueError, match="teapot"):
        split_object_name("red_teapot")
