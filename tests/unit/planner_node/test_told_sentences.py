# SPDX-License-Identifier: Apache-2.0
"""Goals as they are spoken: corrections, names without commas, exceptions, towers in any order."""

from __future__ import annotations

import pytest
from planner_states import all_states

from planner_node.errors import PlannerError
from planner_node.goals import parse_goal, resolve_goal

NAMES = ("blue_box", "cyan_box", "green_box", "red_box")


def read(text: str) -> str:
    return str(resolve_goal(parse_goal(text), NAMES, 3)).replace("_box", "")


@pytest.mark.parametrize(
    ("text", "plain"),
    [
        ("red on blue, no wait, on green", "red on green"),
        ("red on blue no sorry red on green", "red on green"),
        ("put red, no, blue on green", "blue on green"),
        ("red on blue, I mean green", "red on green"),
        ("Red in stack 1. No, in stack 2.", "red in stack 2"),
        ("Red on blue. Scratch that. Green on blue.", "green on blue"),
        ("red on blue and green on cyan, oops, green on red", "red on blue, green on red"),
        ("sorry, red on blue", "red on blue"),
        ("red on blue green on cyan", "red on blue, green on cyan"),
        ("red box on blue box green box in stack 1", "red on blue, green in stack 1"),
        ("red blue and green in stack 1", "red, blue and green in stack 1"),
        ("red stack 1, blue stack 2", "red in stack 1, blue in stack 2"),
        ("all blocks but red and blue in stack 1", "green and cyan in stack 1"),
        ("everything in stack1 but red", "blue, green and cyan in stack 1"),
        ("clear all stacks except stack 1", "clear stack 0 and stack 2"),
        ("red in stack 0, the rest in stack 1", "red in stack 0, blue, green, cyan in stack 1"),
        ("red in stack 1, leave the rest", "red in stack 1"),
        ("red in stack1, blue elsewhere", "red in stack1, blue not in stack1"),
        ("red must not be in stack1, and blue must not be there either",
         "red not in stack1, blue not in stack1"),
        ("red in stack1, and so should blue", "red and blue in stack1"),
        ("red should not be on blue, nor should green", "red not on blue, green not on blue"),
        ("red not on blue, put it on green", "red not on blue, red on green"),
        ("remove red from stack1", "red not in stack1"),
        ("take red off blue", "red not on blue"),
        ("red on top, green in the middle, blue at the bottom", "red on green, green on blue"),
        ("red, green, blue (top to bottom)", "from top to bottom: red, green, blue"),
        ("blue at the bottom, then green, then red", "from bottom to top: blue, green, red"),
        ("Build a tower. At the bottom blue, on top red, in the middle green.",
         "from top to bottom: red, green, blue"),
        ("the top block of stack1 is red", "red at the top of stack1"),
        ("red is the only block in stack1", "only red in stack1"),
        ("the second pile from the right empty", "stack1 empty"),
        ("stacks 0 and 2 empty", "stack0 empty, stack2 empty"),
        ("red in position 2", "red in stack2"),
        ("between one and two blocks in stack0",
         "at least one block in stack0, at most two blocks in stack0"),
        ("I'd be grateful if you could see to it that red stands on blue", "red on blue"),
        ("if it is not too much trouble, might I ask you to put red on blue?", "red on blue"),
        ("put red on blue if you can", "red on blue"),
        ("blue carries red and red carries nothing", "red on blue, red clear"),
        ("redon blue", "red on blue"),
    ],
)  # fmt: skip
def test_it_means_the_same_as_plain_relations(text: str, plain: str) -> None:
    said, meant = (resolve_goal(parse_goal(one), NAMES, 3) for one in (text, plain))
    for state in all_states(NAMES, 3):
        assert said.holds(state) == meant.holds(state)


@pytest.mark.parametrize(
    "text",
    [
        "red on blue, sorry, not green",
        "put red in stack 1, wait, blue in stack 2",
        "red on blue, no",
        "red on blue if green is clear",
        "anything but red on blue",
        "all six blocks in stack1",
        "Red on blue. All in stack1.",
        "red block blue on green cyan on",
    ],
)
def test_what_is_not_clear_is_asked_back(text: str) -> None:
    with pytest.raises(PlannerError):
        read(text)
