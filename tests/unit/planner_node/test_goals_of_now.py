# SPDX-License-Identifier: Apache-2.0
"""Goals that say what they mean by how the blocks stand; texts that nobody can read."""

from __future__ import annotations

from typing import Final

import pytest
from planner_states import all_states

from planner_node import PlannerError, parse_goal, resolve_goal
from planner_node.errors import AmbiguousObjectError, InvalidGoalError, UnknownObjectError
from scene_graph import Stacks

NOW: Final[Stacks] = (("red_box", "blue_box"), ("green_box",), ())
NAMES: Final = ("red_box", "blue_box", "green_box")


def fulfilled(text: str, now: Stacks = NOW) -> set[Stacks]:
    names = [name for stack in now for name in stack]
    goal = resolve_goal(parse_goal(text), names, len(now), now=now)
    return {state for state in all_states(tuple(names), len(now)) if goal.holds(state)}


@pytest.mark.parametrize(
    ("text", "plain"),
    [
        ("swap red and blue", "blue on stack0, red on blue, green on stack1"),
        ("could you exchange red and green?", "green on stack0, blue on green, red on stack1"),
        ("put green where blue is", "green on red"),
        ("put green where red is", "green on stack0"),
        ("put the top block of stack 0 on green", "blue on green"),
        ("put green on the one on red", "green on blue"),
        ("clear the tallest stack", "clear stack0"),
        ("blue in the empty stack", "blue in stack2"),
        ("turn the tower upside down", "red on blue, blue on stack0, green on stack1"),
        ("leave everything as it is", "red on stack0, blue on red, green on stack1"),
        ("move green one place to the left", "green in stack0"),
    ],
)  # fmt: skip
def test_it_means_what_is_so_now(text: str, plain: str) -> None:
    assert fulfilled(text) == fulfilled(plain) != set()


def test_another_state_is_another_goal() -> None:
    assert fulfilled("put green where blue is", (("red_box",), ("green_box",), ("blue_box",))) == (
        fulfilled("green on stack2")
    )


@pytest.mark.parametrize(
    ("text", "error", "told"),
    [
        ("red in the other stack", AmbiguousObjectError, "stack1, stack2"),
        ("put red on the one on green", UnknownObjectError, "no block is like that now"),
        ("swap red", InvalidGoalError, "which block"),
    ],
)
def test_what_is_not_clear_now_is_asked_back(
    text: str, error: type[PlannerError], told: str
) -> None:
    with pytest.raises(error, match=told):
        fulfilled(text)


def test_without_a_state_it_is_refused() -> None:
    with pytest.raises(InvalidGoalError, match="how the blocks stand now"):
        resolve_goal(parse_goal("swap red and blue"), NAMES, 3)


def test_every_red_box_means_all_of_them() -> None:
    now: Stacks = (("red_box", "blue_box"), ("red_box_2",), ())
    assert fulfilled("every red box in stack2", now) == (
        fulfilled("red_box in stack2, red_box_2 in stack2", now)
    )


@pytest.mark.parametrize("text", ["polish red on blue", "red on zorple", "gimble the wabe"])
def test_words_that_nobody_knows_are_named(text: str) -> None:
    with pytest.raises(PlannerError, match=r"polish|zorple|gimble"):
        fulfilled(text)


@pytest.mark.parametrize("text", ["red on blue, " * 150, "blah " * 400, "red " * 300])
def test_a_text_without_end_is_refused(text: str) -> None:
    with pytest.raises(PlannerError):
        fulfilled(text)
