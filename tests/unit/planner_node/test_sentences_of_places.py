# SPDX-License-Identifier: Apache-2.0
"""Goals that are told from the places: what they hold, lists behind them, what is together."""

from __future__ import annotations

import pytest

from planner_node.errors import PlannerError
from planner_node.goals import parse_goal, resolve_goal
from scene_graph import Stacks

NAMES = ("blue_box", "cyan_box", "green_box", "red_box")


def holds(text: str, stacks: Stacks, names: tuple[str, ...] = NAMES) -> bool:
    """Whether a goal is true of a state."""
    return resolve_goal(parse_goal(text), names, len(stacks)).holds(stacks)


def state(text: str) -> Stacks:
    """ "rb c g": red and on it blue, then cyan, then green; "-" is an empty place."""
    names = {name[0]: name for name in NAMES}
    return tuple(tuple(names[one] for one in word if one != "-") for word in text.split())


@pytest.mark.parametrize(
    ("text", "true", "false"),
    [
        ("stack0 has two blocks", "rb c g", "r bc g"),
        ("stack0 should contain exactly two blocks", "rb c g", "rbc - g"),
        ("stack 1 must not have any blocks in it", "rb - cg", "r b cg"),
        ("stack0 and stack2 should have no blocks in them", "- rbcg -", "r bcg -"),
        ("stack0 has more than two blocks", "rbc g -", "rb c g"),
        ("stack0 has fewer than two blocks", "r bc g", "rb c g"),
        ("no stack has more than two blocks", "rb cg -", "rbc g -"),
        ("no stack should be higher than two blocks", "rb cg -", "rbc g -"),
        ("no stack taller than 2", "rb cg -", "rbc g -"),
        ("every stack contains at least one block", "rb c g", "rb cg -"),
        ("all stacks have at most two blocks", "rb cg -", "- rbc g"),
        ("red has nothing on it", "br c g", "rb c g"),
        ("blue should have red on top of it", "br c g", "b r cg"),
        ("only red in stack1", "bc r g", "bc rg -"),
        ("nothing but red in stack1", "bc r g", "bc rg -"),
        ("only red and blue in stack1", "c rb g", "c rbg -"),
        ("red in stack1 and nothing else", "bc r g", "bc rg -"),
        ("keep red off blue", "r b cg", "br c g"),
        ("at least two of red, blue and green in stack1", "c rb g", "c r bg"),
        ("exactly one of red and blue in stack1", "b r cg", "c rb g"),
        ("red alone in stack1", "bc r g", "bc rg -"),
        ("two blocks in stack1, with red at the bottom of it", "c rb g", "c br g"),
        ("two blocks in stack1, red at the very top", "c br g", "c rb g"),
        ("red in stack1 at the top", "c br g", "c rb g"),
        ("red and blue, put them in stack1", "c br g", "b rc g"),
        ("Take red and blue and put them both in stack 1", "c br g", "b rc g"),
        ("please stack, starting from the bottom, red, blue and green", "rbg c -", "gbr c -"),
        ("Empty stack 2, would you?", "rb cg -", "rb c g"),
        ("red should not be on any other block", "rb c g", "br c g"),
        ("red has nothing on it, and it belongs in stack1", "b cr g", "cr b g"),
        ("red on blue - thanks a lot!", "br c g", "rb c g"),
        ("red, blue and green were all in stack1, in whatever order", "c gbr -", "g br c"),
        ("hmm, let me think... red on blue", "br c g", "rb c g"),
        ("red not on blue, and green not on blue either", "r b cg", "bg c r"),
        ("A tower in stack1: red at the bottom, then blue, then green", "c rbg -", "c rgb -"),
        ("in stack1 red at the bottom, then blue", "c rb g", "c br g"),
        ("red at the top of stack1", "c br g", "c rb g"),
        ("red and nothing else in stack1", "bc r g", "bc rg -"),
        ("no more than two blocks in any stack", "rb cg -", "rbc g -"),
        ("nothing on red or blue", "r b cg", "rg b c"),
        ("nothing on red nothing on blue", "r b cg", "rg b c"),
        ("do not leave anything on red, green or blue", "r b cg", "gc b r"),
        ("red in the second stack from the left", "b r cg", "r b cg"),
        ("Tower, top to bottom: red, blue, green, and green in stack1", "c gbr -", "gbr c -"),
        ("all the blcoks in the midle stakc", "- rbcg -", "r bcg -"),
        ("keep stack2 emtpy", "rb cg -", "rb c g"),
        ("on top of blue I want red, and on that the green one", "brg c -", "brc g -"),
        ("all boxes that are not red belong in stack2", "r - bcg", "r b cg"),
        ("red must never be in stack1 or stack2", "r bc g", "c br g"),
        ("red must not stand on another block", "rb c g", "br c g"),
        ("red in stack1 with blue on it", "c rb g", "rb c g"),
        ("stack1 should contain red and nothing else", "bc r g", "bc rg -"),
        ("no more then two blocks in stack0", "rb cg -", "rbc g -"),
        ("red neither on blue nor on green", "r bc g", "gr bc -"),
        ("red should be neither on blue nor green", "r bc g", "gr bc -"),
        ("don't put red on blue or on green", "r bc g", "gr bc -"),
        ("red not on blue or in stack1", "r bc g", "bg r c"),
        ("stack 1 has red on top", "b gr c", "b rg c"),
        ("red directly to the left of blue", "r b cg", "r gc b"),
        ("red goes in the stack immediately to the right of blue", "b r cg", "b gc r"),
        ("stack 2: red, stack 1: blue", "cg b r", "cg r b"),
        ("stack 0: red. stack 1: blue and green.", "r bgc -", "r bc g"),
        ("Red -> stack0, blue -> stack 1", "r bc g", "b rc g"),
        ("In stack1, from bottom to top: red, blue, green", "c rbg -", "c gbr -"),
        ("red and blue in the same stack", "bcr - g", "bc r g"),
        ("red in the same stack as blue", "bcr - g", "bc r g"),
        ("red and blue not in the same stack", "bc r g", "bcr - g"),
        ("red, blue and green in different stacks", "r bc g", "r bg c"),
        ("red below blue, somewhere in the same stack", "rcb - g", "brc - g"),
        ("red and blue next to each other", "r b cg", "r cg b"),
        ("red on blue, which is in stack 1", "c br g", "br c g"),
        ("get red, blue and green into stack 0", "rgb c -", "rg b c"),
        ("First put red on blue. Second put green on red.", "brg c -", "bgr c -"),
        ("For the experiment, red is on blue", "br c g", "rb c g"),
        ("A student asked for red directly on blue", "br c g", "rb c g"),
        ("My class would like to see red on blue", "br c g", "rb c g"),
        ("exactly two blocks in stack1, I don't care which ones", "r bc g", "r b cg"),
        ("put the red box direclty on stack2", "bc g r", "b c gr"),
        ("please bulid this: red on blue", "br c g", "rb c g"),
    ],
)
def test_what_is_told_of_places(text: str, true: str, false: str) -> None:
    assert holds(text, state(true))
    assert not holds(text, state(false))


@pytest.mark.parametrize(
    "text",
    [
        "only red on blue",
        "only red blocks in stack1",
        "blue on green, red in stack1 and nothing else",
        "red, blue and green not in the same stack",
        "red, blue and green next to each other",
        "red and blue on each other",
        "which is in stack1",
        "red on stack1, which is left of blue",
        "red in stack1, then blue",
        "all blocks not in stack1",
        "you don't have to put red on blue",
        "is red on blue?",
        "the one that is on blue onto red",
        "put one of red and blue in stack1",
        "I wonder if red is on blue",
        "light blue on red",
        "red in stack1, blue on top",
        "two of red",
        "red not directly left of blue",
        "the boxes not red in stack1",
        "kick red on blue",
        "bottom red, then blue in stack1 at the bottom, then",
        "red on one of blue and green",
        "red, and two of blue and green, in stack1",
        "red at the top",
        "no stack has no blocks",
        "no stack has at most two blocks",
        "red has blue in it",
    ],
)
def test_what_may_mean_several_things_is_asked_back(text: str) -> None:
    with pytest.raises(PlannerError):
        resolve_goal(parse_goal(text), NAMES, 3)
