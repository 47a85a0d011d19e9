# SPDX-License-Identifier: Apache-2.0
from __future__ import annotations

import pytest
from hypothesis import given
from hypothesis import strategies as st

from planner_node.errors import AmbiguousObjectError, InvalidGoalError, UnknownObjectError
from planner_node.goals import parse_goal, resolve_goal

NAMES = ("blue_box", "green_box", "red_box", "red_cylinder", "yellow_sphere")


def read(text: str, names: tuple[str, ...] = NAMES, stack_count: int | None = None) -> str:
    return str(resolve_goal(parse_goal(text), names, stack_count))


@pytest.mark.parametrize(
    ("text", "meaning"),
    [
        ("blue on green", "blue_box on green_box"),
        ("blue up green", "blue_box on green_box"),
        ("blue on top of green", "blue_box on green_box"),
        ("blue_box on green_box", "blue_box on green_box"),
        ("blue box on green box", "blue_box on green_box"),
        ("the blue box is on the green block", "blue_box on green_box"),
        ("BLUE ON Green", "blue_box on green_box"),
        ("  blue\non\tgreen ", "blue_box on green_box"),
        ("blue above green", "blue_box above green_box"),
        ("blue below green", "green_box above blue_box"),
        ("stack2 below green", "green_box above stack2"),
        ("blue left of green", "blue_box left of green_box"),
        ("blue left green", "blue_box left of green_box"),
        ("blue is to the left of green", "blue_box left of green_box"),
        ("blue right of green", "green_box left of blue_box"),
        ("blue right green", "green_box left of blue_box"),
        ("red box on blue", "red_box on blue_box"),
        ("cylinder on sphere", "red_cylinder on yellow_sphere"),
        ("blue on stack1", "blue_box on stack1"),
        ("blue on stack 1", "blue_box on stack1"),
        ("blue above stack2", "blue_box above stack2"),
        ("blue in stack 0", "blue_box above stack0"),
        ("blue on stack9", "blue_box on stack9"),
    ],
)
def test_a_relation_can_be_written_in_several_ways(text: str, meaning: str) -> None:
    assert read(text) == meaning


@pytest.mark.parametrize(
    "text",
    [
        "blue on green, green on sphere",
        "blue on green; green on sphere",
        "blue on green and green on sphere",
        "blue on green, and green on sphere",
        "blue on green,\n green on sphere,",
        "blue on green, green on sphere, blue box up green",
    ],
)
def test_relations_are_separated_and_repetitions_count_once(text: str) -> None:
    assert read(text) == "blue_box on green_box, green_box on yellow_sphere"


@pytest.mark.parametrize(
    ("text", "offset", "offending"),
    [
        ("", 0, ""),
        ("   ", 0, ""),
        (", ;", 0, ""),
        ("blue", 0, "blue"),
        ("blue on green, make a tower", 15, "make a tower"),
        ("blue near green", 0, "blue near green"),
        ("on green", 0, "on"),
        ("blue on", 5, "on"),
        ("blue on top of", 5, "on top of"),
        ("blue on the", 5, "on"),
        ("blue left of green on red", 19, "on"),
        ("blue on green %", 14, "%"),
        ("blue in green", 8, "green"),
        ("stack1 in blue", 10, "blue"),
        ("blue next to stack1", 13, "stack1"),
        ("stack1 right of blue", 0, "stack1"),
    ],
)
def test_what_makes_no_sense_is_refused_with_its_position(
    text: str, offset: int, offending: str
) -> None:
    with pytest.raises(InvalidGoalError) as caught:
        parse_goal(text)
    assert (caught.value.offset, caught.value.text) == (offset, offending)
    assert f"offset {offset}" in str(caught.value)
    assert text[offset : offset + len(offending)] == offending


@pytest.mark.parametrize(
    ("text", "sentence"),
    [
        ("make a tower", "known are on, above, below, in, left of, right of"),
        ("blue in green", "'in' needs a place, such as stack0; use 'above' for a block"),
        ("blue next to stack1", "'next to' relates two blocks; use 'on' or 'above' for a place"),
    ],
)
def test_a_refusal_says_what_would_be_understood(text: str, sentence: str) -> None:
    with pytest.raises(InvalidGoalError) as caught:
        parse_goal(text)
    assert sentence in str(caught.value)


def test_names_are_looked_up_in_the_order_they_are_written() -> None:
    with pytest.raises(UnknownObjectError, match="no 'pink'"):
        read("pink right of white")


def test_an_unknown_object_comes_with_the_known_ones_and_a_guess() -> None:
    with pytest.raises(UnknownObjectError) as caught:
        read("blue on grain")
    assert caught.value.name == "grain"
    assert caught.value.known == NAMES
    sentence = str(caught.value)
    assert "offset 8" in sentence
    assert "did you mean 'green'" in sentence
    assert all(name in sentence for name in NAMES)


def test_a_known_part_with_a_wrong_one_is_unknown() -> None:
    with pytest.raises(UnknownObjectError, match="no 'blue sphere'"):
        read("blue sphere on green")


def test_an_ambiguous_name_comes_with_its_candidates() -> None:
    with pytest.raises(AmbiguousObjectError) as caught:
        read("blue on red")
    assert caught.value.candidates == ("red_box", "red_cylinder")
    assert "red_box, red_cylinder" in str(caught.value)


def test_a_word_for_everything_is_ambiguous() -> None:
    with pytest.raises(AmbiguousObjectError):
        read("blue on the block")


def test_a_full_name_wins_over_parts() -> None:
    assert read("red on blue", ("blue_box", "red", "red_box")) == "red on blue_box"


def test_an_empty_scene_knows_nothing() -> None:
    with pytest.raises(UnknownObjectError, match="the scene has no objects"):
        read("blue on red", ())


# Verbs


@pytest.mark.parametrize(
    ("text", "meaning"),
    [
        ("put blue on green", "blue_box on green_box"),
        ("Please put the blue box on green", "blue_box on green_box"),
        ("move blue to the left of green", "blue_box left of green_box"),
        (
            "stack blue on green, please place sphere on blue",
            "blue_box on green_box, yellow_sphere on blue_box",
        ),
        ("stack 1 below blue", "blue_box above stack1"),
        ("stack1 below blue", "blue_box above stack1"),
    ],
)
def test_fault_12_a_relation_may_start_with_a_verb(text: str, meaning: str) -> None:
    assert read(text) == meaning


_REQUESTS = st.sampled_from(
    ["put", "place", "stack", "move", "please", "please put", "please move"]
)
_RELATIONS = st.builds(
    "{0} {2} {1}".format,
    *[st.sampled_from(["blue", "the green box", "red_box", "cylinder"])] * 2,
    st.sampled_from(["on", "on top of", "above", "is below", "left of", "to the right of"]),
)


@given(st.lists(st.tuples(_REQUESTS, _RELATIONS), min_size=1, max_size=4))
def test_a_verb_in_front_of_a_relation_changes_nothing(goal: list[tuple[str, str]]) -> None:
    bare = ", ".join(relation for _, relation in goal)
    assert read(" and ".join(f"{verb} {relation}" for verb, relation in goal)) == read(bare)


@pytest.mark.parametrize("text", ["please", "put", "put blue", "please stack", "stack"])
def test_a_verb_alone_is_no_relation(text: str) -> None:
    with pytest.raises(InvalidGoalError, match="write relations like 'red on blue"):
        parse_goal(text)


@pytest.mark.parametrize("text", ["put on green", "please put is on green", "move left of green"])
def test_a_verb_is_no_block(text: str) -> None:
    with pytest.raises(InvalidGoalError, match="there is no block before this"):
        parse_goal(text)


def test_an_unknown_verb_gets_a_sentence_that_shows_a_goal() -> None:
    with pytest.raises(UnknownObjectError) as caught:
        read("juggle blue on green")
    assert "no 'juggle blue'" in str(caught.value)
    assert "write relations like 'red on blue, green left of red'" in str(caught.value)


# Places that are not there


@pytest.mark.parametrize(
    "name",
    ["stack7", "stack 7", "stack_3", "stack-1", "place3", "place 3", "position-3", "column7"],
)
def test_fault_12_a_place_that_is_not_there_is_unknown_and_those_that_are_are_listed(
    name: str,
) -> None:
    with pytest.raises(UnknownObjectError) as caught:
        read(f"blue on {name}", stack_count=3)
    assert caught.value.known == ("stack0", "stack1", "stack2")
    assert f"offset 8: there is no place '{name}'" in str(caught.value)
    assert "the places are stack0, stack1, stack2 from the left" in str(caught.value)


@pytest.mark.parametrize("name", ["table", "the floor", "stack", "place"])
def test_fault_12_a_place_without_a_number_is_told_how_to_write_one(name: str) -> None:
    with pytest.raises(UnknownObjectError) as caught:
        read(f"blue on {name}", stack_count=2)
    assert "the places are stack0, stack1 from the left" in str(caught.value)
    assert "write which one, such as 'red on stack0'" in str(caught.value)


def test_a_block_may_be_called_like_a_place() -> None:
    assert read("blue on table", ("blue_box", "table")) == "blue_box on table"


@given(st.integers(0, 30), st.integers(1, 9), st.sampled_from(["", " ", "_"]))
def test_a_place_is_known_exactly_if_the_scene_has_it(index: int, count: int, gap: str) -> None:
    text = f"blue on stack{gap}{index}"
    if index < count:
        assert read(text, stack_count=count) == f"blue_box on stack{index}"
    else:
        with pytest.raises(UnknownObjectError) as caught:
            read(text, stack_count=count)
        assert caught.value.known == tuple(f"stack{place}" for place in range(count))


def test_without_a_scene_any_numbered_place_may_exist() -> None:
    assert read("blue on stack12") == "blue_box on stack12"
    with pytest.raises(UnknownObjectError, match="places are called stack0, stack1, … from"):
        read("blue on table")
