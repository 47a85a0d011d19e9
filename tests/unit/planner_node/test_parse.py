# SPDX-License-Identifier: Apache-2.0
from __future__ import annotations

import pytest

from planner_node.errors import AmbiguousObjectError, InvalidGoalError, UnknownObjectError
from planner_node.goals import parse_goal, resolve_goal

NAMES = ("blue_box", "green_box", "red_box", "red_cylinder", "yellow_sphere")


def read(text: str, names: tuple[str, ...] = NAMES) -> str:
    return str(resolve_goal(parse_goal(text), names))


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
        ("blue beside green", 0, "blue beside green"),
        ("on green", 0, "on"),
        ("blue on", 5, "on"),
        ("blue on top of", 5, "on top of"),
        ("blue on the", 5, "on"),
        ("blue on green on red", 14, "on red"),
        ("blue on green!", 13, "!"),
        ("blue in green", 8, "green"),
        ("stack1 in blue", 10, "blue"),
        ("blue left of stack1", 13, "stack1"),
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
        ("blue right of stack1", "'right of' relates two blocks; use 'on' or 'above' for a place"),
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
        read("blue on gren")
    assert caught.value.name == "gren"
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
