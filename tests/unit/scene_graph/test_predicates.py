# SPDX-License-Identifier: Apache-2.0
"""A predicate is one entry: its phrases, its meaning, and what people are told."""

import pytest

from scene_graph import PREDICATES, Predicate, Predicates, Relation, Spot, spots_of

STATE = (("a", "b", "c"), (), ("d",))
NAMES = ("a", "b", "c", "d")


def true_pairs(predicate: str, objects: tuple[str, ...] = NAMES) -> set[tuple[str, str]]:
    spots = spots_of(STATE)
    return {(s, o) for s in NAMES for o in objects if Relation(s, predicate, o).holds(spots)}


def test_up_is_directly_on_and_above_is_anywhere_above() -> None:
    assert true_pairs("up") == {("b", "a"), ("c", "b")}
    assert true_pairs("above") == {("b", "a"), ("c", "b"), ("c", "a")}


def test_left_compares_stacks() -> None:
    assert true_pairs("left") == {(s, "d") for s in "abc"}


def test_a_base_is_below_the_lowest_block() -> None:
    bases = ("stack0", "stack1", "stack2")
    assert true_pairs("up", bases) == {("a", "stack0"), ("d", "stack2")}
    assert true_pairs("above", bases) == {(s, "stack0") for s in "abc"} | {("d", "stack2")}


def test_what_is_not_there_fulfils_nothing() -> None:
    spots = spots_of(STATE)
    assert not Relation("x", "left", "d").holds(spots)
    assert not Relation("a", "up", "stack3").holds(spots)


def test_phrases_lead_to_one_predicate_and_tell_which_side_is_which() -> None:
    phrases = PREDICATES.phrases
    assert phrases["on", "top", "of"].predicate.name == "up"
    left, right = phrases["left", "of"], phrases["right", "of"]
    assert left.predicate is right.predicate
    assert (left.inverse, right.inverse) == (False, True)
    assert phrases["in",].needs_place


def test_people_are_told_the_first_phrase() -> None:
    assert Relation("red_box", "up", "blue_box").words == "red_box on blue_box"
    assert str(Relation("red_box", "up", "blue_box")) == "red_box up blue_box"


def test_a_new_predicate_is_known_until_it_is_removed() -> None:
    def far(subject: Spot, object_: Spot) -> bool:
        return abs(subject.stack - object_.stack) == 2

    with pytest.raises(ValueError, match="unknown predicate 'far'"):
        Relation("a", "far", "b")
    PREDICATES.add(Predicate("far", far, phrases=("far", "away from")))
    try:
        assert Relation("a", "far", "b").holds(spots_of((("a",), (), ("b",))))
        assert Relation("a", "not_far", "b").holds(spots_of((("a",), ("b",))))
        assert Relation("a", "not_far", "b").words == "a not far b"
        assert PREDICATES.phrases["away", "from"].predicate.name == "far"
    finally:
        PREDICATES.remove("far")
    assert ("away", "from") not in PREDICATES.phrases


def test_a_name_or_phrase_means_one_thing() -> None:
    known = Predicates(Predicate("up", lambda _a, _b: True, phrases=("on",)))
    with pytest.raises(ValueError, match="'up' already"):
        known.add(Predicate("up", lambda _a, _b: False))
    with pytest.raises(ValueError, match="'on' has a meaning"):
        known.add(Predicate("over", lambda _a, _b: False, phrases=("on",)))
    assert list(known) == ["up"]
