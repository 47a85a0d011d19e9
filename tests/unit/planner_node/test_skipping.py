# SPDX-License-Identifier: Apache-2.0
"""Goals with words around them that say nothing: those are skipped, and no others."""

from __future__ import annotations

from typing import Any

import pytest
from hypothesis import given
from hypothesis import strategies as st

from planner_node.errors import PlannerError
from planner_node.goals import parse_goal, resolve_goal
from planner_node.goals.grammar import reader
from planner_node.goals.grammar.lattice import lattice_of
from planner_node.goals.grammar.skipping import is_bound, stretches

NAMES = ("blue_box", "cyan_box", "green_box", "red_box", "yellow_box")
#: By what they are: words in front of a goal, and behind one.
BEFORE = (
    "the goal is a configuration in which",
    "i think it would look nice with",
    "no no ,",
    "because the lab is cold ,",
    "my daughter is watching so",
    "before you leave :",
    "by lunch ,",
    "when the inspector comes ,",
    "acceptance criterion :",
)
BEHIND = (
    ". go go",
    ", idc where exactly",
    ", order does not matter",
    ", like a crown",
    "so my daughter can see it",
    "by the time i 'm back",
    "for the photo",
    ", the baby crawls over there",
    ", otherwise the forklift can not reach it",
    ", i find it prettier that way",
    "because the red one is fragile",
)
#: What may change the meaning of what it is put to.
BOUND = (
    "not", "never", "without", "only", "two", "three", "or", "except", "unless", "if", "instead",
    "green", "gren", "blu", "cube", "stack", "left", "above", "swap", "reverse", "remove",
    "undo", "same", "either", "than", "already", "stack1", "all", "r",
)  # fmt: skip
#: These are listed for stretches of one form, where they say nothing.
LISTED = {"not", "if", "stack", "all", "already", "remove"}


def read(text: str) -> str | None:
    try:
        return str(resolve_goal(parse_goal(text), NAMES, 3))
    except PlannerError:
        return None


@pytest.mark.parametrize("words", BEFORE)
def test_what_stands_in_front_and_says_nothing_is_skipped(words: str) -> None:
    assert read(f"{words} red is on blue") == "red_box on blue_box"


@pytest.mark.parametrize("words", BEHIND)
def test_what_stands_behind_and_says_nothing_is_skipped(words: str) -> None:
    assert read(f"red above blue {words}") == "red_box above blue_box"


@given(st.sampled_from((*BEFORE, *BEHIND)), st.sampled_from(BOUND), st.data())
def test_a_word_that_may_change_the_meaning_is_in_no_stretch(
    words: str, bound: str, data: st.DataObject
) -> None:
    inside = words.split()
    at = data.draw(st.integers(0, len(inside)))
    said = ["red", "on", "blue", ",", *inside[:at], bound, *inside[at:], ",", "red", "on", "blue"]
    put = 4 + at
    covered = [
        (start, end) for start in range(len(said)) for end, _ in stretches(said, start)
        if start <= put < end
    ]  # fmt: skip
    assert not covered or bound in LISTED


@pytest.mark.parametrize("word", BOUND)
def test_what_changes_a_meaning_is_bound(word: str) -> None:
    assert is_bound(word)


@pytest.mark.parametrize(
    "text",
    [
        "red on blue, not like a crown",
        "red on blue, or like a crown",
        "red on blue unless my daughter is watching",
        "red on blue if the lab is cold",
        "the goal is not a configuration in which red is on blue",
        "the goal is a configuration in which red is on blue or green",
        "is the goal a configuration in which red is on blue?",
        "it was nice with red on blue",
        "red on blue, green matters",
        "i do not care, green on top or not: red on blue",
        "red on blue, not necessarily touching",
        "red on blue. undo that",
        "red on blue, green like a crown",
        "red on blue, never mind",
        "yellow, broken, on red",
        "red on blue. do not bother",
        "it is not so that red is on blue",
        "it is unacceptable, red on blue",
        "red on blue before green is on yellow",
        "red on blue for two",
    ],
)
def test_what_may_mean_something_is_asked_back(text: str) -> None:
    assert read(text) is None


@pytest.mark.parametrize(("times", "again"), [(5, 1), (11, 0)])
def test_a_text_is_read_again_without_what_says_nothing_unless_it_is_long(
    times: int, again: int, monkeypatch: pytest.MonkeyPatch
) -> None:
    done = []

    def noted(tokens: Any, literals: Any, skipping: bool) -> Any:
        done.append(skipping)
        return lattice_of(tokens, literals, skipping)

    monkeypatch.setattr(reader, "lattice_of", noted)
    text = "the weather in the lab is nice, " * times + "red goes somewhere near blorp " * 3
    assert read(text) is None
    assert done.count(True) == again
