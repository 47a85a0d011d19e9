# SPDX-License-Identifier: Apache-2.0
"""Two rows of places: what is in front of what, and that it is one with the stacks."""

from __future__ import annotations

from dataclasses import replace

import pytest
from hypothesis import given
from hypothesis import strategies as st

from scene_graph import (
    FRONT,
    ONE_ROW,
    ROW_OF_THREE,
    InconsistentRelationsError,
    Relation,
    Rows,
    SceneGraph,
    SceneObject,
    Stacks,
    front_relations,
    hidden_name,
    hidden_places,
    in_rows,
    is_hidden,
    rows_of,
    spots_of,
    up_relations,
)

CAMERA = (1.45, 0.0, 0.85)
FRONT_ROW = ((0.58, -0.15, 0.0), (0.58, 0.0, 0.0), (0.58, 0.15, 0.0))
BACK_ROW = ((0.42, -0.15, 0.0), (0.42, 0.0, 0.0), (0.42, 0.15, 0.0))
PLACES = in_rows(FRONT_ROW + BACK_ROW, CAMERA)
NAMES = ("a_box", "b_box", "c_box", "d_box", "e_box")


@st.composite
def states(draw: st.DrawFn) -> Stacks:
    stacks: list[list[str]] = [[] for _ in PLACES]
    for name in draw(st.permutations(NAMES)):
        stacks[draw(st.integers(0, len(PLACES) - 1))].append(name)
    return tuple(map(tuple, stacks))


def graph_of(stacks: Stacks, relations: frozenset[Relation]) -> SceneGraph:
    objects = tuple(SceneObject(name, "red", "box") for stack in stacks for name in stack)
    return SceneGraph(objects, relations, PLACES)


def test_three_places_in_front_of_three_are_two_rows() -> None:
    assert rows_of(PLACES) == Rows((0, 0, 0, 1, 1, 1), (0, 1, 2, 0, 1, 2))
    assert rows_of(PLACES).count == 2


def test_two_places_in_front_of_three_are_between_their_columns() -> None:
    places = in_rows(((0.58, -0.075, 0.0), (0.58, 0.075, 0.0), *BACK_ROW), CAMERA)
    assert rows_of(places) == Rows((0, 0, 1, 1, 1), (1, 3, 0, 2, 4))


@pytest.mark.parametrize(
    ("positions", "camera"),
    [
        (ROW_OF_THREE, CAMERA),
        (ROW_OF_THREE[::-1], CAMERA),  # no order of anything
        (BACK_ROW + FRONT_ROW, CAMERA),  # the further one first
        (ROW_OF_THREE[:1], CAMERA),
        ((), CAMERA),
    ],
)
def test_all_else_is_one_row(
    positions: tuple[tuple[float, float, float], ...], camera: tuple[float, float, float]
) -> None:
    assert rows_of(in_rows(positions, camera)) == ONE_ROW


def test_left_compares_columns_and_front_rows() -> None:
    spots = spots_of((("a",), (), (), ("b",), ("c",), ()), rows_of(PLACES).spot)
    assert Relation("a", FRONT, "b").holds(spots)
    assert Relation("a", FRONT, "c").holds(spots)
    assert not Relation("b", FRONT, "a").holds(spots)
    assert not Relation("b", FRONT, "c").holds(spots)
    assert Relation("a", "left", "c").holds(spots)
    assert not Relation("a", "left", "b").holds(spots)
    assert not Relation("a", "beside", "b").holds(spots)
    assert Relation("b", "beside", "c").holds(spots)


def test_in_one_row_nothing_is_in_front_of_anything() -> None:
    spots = spots_of((("a",), (), ("b",)))
    assert not Relation("a", FRONT, "b").holds(spots)
    assert not Relation("b", FRONT, "a").holds(spots)


@given(states())
def test_relations_to_stacks_to_relations_is_the_identity(stacks: Stacks) -> None:
    relations = up_relations(stacks) | front_relations(stacks, rows_of(PLACES))
    seen = graph_of(stacks, relations).stacks()
    assert seen == stacks
    assert up_relations(seen) | front_relations(seen, rows_of(PLACES)) == relations


@given(states())
def test_front_relations_are_those_that_hold_of_the_lowest_blocks(stacks: Stacks) -> None:
    spots = spots_of(stacks, rows_of(PLACES).spot)
    lowest = [stack[0] for stack in stacks if stack]
    true = {
        Relation(one, FRONT, other)
        for one in lowest
        for other in lowest
        if Relation(one, FRONT, other).holds(spots)
    }
    assert front_relations(stacks, rows_of(PLACES)) == true


@given(states(), st.data())
def test_a_front_relation_that_is_turned_round_is_noticed(
    stacks: Stacks, data: st.DataObject
) -> None:
    fronts = front_relations(stacks, rows_of(PLACES))
    if not fronts:
        return
    turned = data.draw(st.sampled_from(sorted(fronts)))
    odd = (fronts - {turned}) | {replace(turned, subject=turned.object, object=turned.subject)}
    with pytest.raises(InconsistentRelationsError, match="in front of"):
        graph_of(stacks, up_relations(stacks) | odd).stacks()


def test_what_stands_for_hidden_blocks_is_in_front_of_nothing() -> None:
    stacks = (("a",), (), (), (hidden_name(3), "b"), (hidden_name(4),), ())
    assert front_relations(stacks, rows_of(PLACES)) == {Relation("a", FRONT, "b")}
    assert hidden_places(stacks) == (3, 4)


def test_names_of_blocks_are_not_those_of_what_is_hidden() -> None:
    assert is_hidden(hidden_name(4)) and is_hidden("hidden_stack4_2")
    assert not is_hidden("red_box") and not is_hidden("hidden_box")
