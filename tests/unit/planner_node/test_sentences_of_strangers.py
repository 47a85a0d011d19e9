# SPDX-License-Identifier: Apache-2.0
"""Goals as strangers put them: what they mean, and what is asked back.

They are of 1,140 that eight people who did not know the reader wrote with their meanings, or like
them, and were not read, or read otherwise, before.
"""

from __future__ import annotations

import pytest

from planner_node.errors import PlannerError
from planner_node.goals import parse_goal, resolve_goal

SCENES = {
    "A": (3, ("red_box", "blue_box", "green_box", "yellow_box", "cyan_box")),
    "B": (3, ("red_box", "red_cylinder", "blue_box", "green_box", "yellow_sphere")),
    "C": (4, ("purple_box", "orange_box", "pink_cylinder", "brown_box", "white_box")),
}


def read(scene: str, text: str) -> str:
    places, names = SCENES[scene]
    return str(resolve_goal(parse_goal(text), names, places))


@pytest.mark.parametrize(
    ("scene", "text", "meaning"),
    [
        # a number of some that are named one by one
        ("A", "exactly one of the blocks red, yellow, cyan is in stack 0",
         "exactly 1 of red_box, yellow_box, cyan_box above stack0"),
        ("C", "the purple, the orange and the brown: at least one of them in stack 0",
         "at least 1 of purple_box, orange_box, brown_box above stack0"),
        ("A", "Of the red, blue and green boxes at least one must be in stack 2.",
         "at least 1 of red_box, blue_box, green_box above stack2"),
        ("A", "red, blue, green: at most one in stack 0",
         "at most 1 of red_box, blue_box, green_box above stack0"),
        ("A", "at least one of these in stack 0: red, blue",
         "at least 1 of red_box, blue_box above stack0"),
        ("B", "One and only one of the red objects must be in stack 0.",
         "exactly 1 of red_box, red_cylinder above stack0"),
        ("A", "none of the blocks red, yellow, cyan is in stack 0",
         "red_box not above stack0, yellow_box not above stack0, cyan_box not above stack0"),
        # what a word denies, and what it does not
        ("A", "!(green on blue)", "green_box not on blue_box"),
        ("C", "white over brown, not necessarily touching", "white_box above brown_box"),
        ("C", "I'd rather not see brown above white, thanks.", "brown_box not above white_box"),
        ("C", "No more than two pieces in stack 2, and the cylinder not among them.",
         "pink_cylinder not above stack2, at most 2 of brown_box, orange_box, pink_cylinder, "
         "purple_box, white_box above stack2"),
        # who, and where
        ("B", "stack 1 has blue as the lowest", "blue_box on stack1"),
        ("B", "blue box on green, both on the floor at stack 1",
         "blue_box on green_box, green_box on stack1"),
        ("B", "The red can should be in the middle stack.", "red_cylinder above stack1"),
        ("C", "Orange: to the right of stack 0 and to the left of stack 3.",
         "at least 1 of orange_box above stack1 or stack2 or stack3, "
         "at least 1 of orange_box above stack0 or stack1 or stack2"),
        ("B", "the cylinder in the last stack and the ball in the first",
         "red_cylinder above stack2, yellow_sphere above stack0"),
        ("C", "Brown just left of pink, in the very next stack.",
         "brown_box left of pink_cylinder, brown_box next to pink_cylinder"),
        # what is said beside
        ("C", "brown box is not next to the pink cylinder, they react",
         "brown_box not next to pink_cylinder"),
        ("C", "Orange must be not above brown, the brown is fragile.",
         "orange_box not above brown_box"),
        ("C", "By lunch the pink one should be sitting on the orange box.",
         "pink_cylinder on orange_box"),
        ("A", "keep the yellow and the green out of stack 0, the baby reaches there",
         "yellow_box not above stack0, green_box not above stack0"),
        ("A", "REQ-01: cyan box directly on red box. REQ-02: red box on the floor at stack 0.",
         "cyan_box on red_box, red_box on stack0"),
        ("B", "We had a collision yesterday, therefore: sphere and cylinder not in adjacent "
         "stacks.", "yellow_sphere not next to red_cylinder"),
    ],
)  # fmt: skip
def test_what_strangers_mean(scene: str, text: str, meaning: str) -> None:
    assert read(scene, text) == meaning


@pytest.mark.parametrize(
    ("scene", "text"),
    [
        # which of them is at the bottom?
        ("A", "Make a tower of red, blue and green in stack 1."),
        ("A", "tower of red and blue"),
        # a question
        ("A", "Can stack 1 carry all five of them?"),
        ("A", "Can stack 1 hold three blocks?"),
        # two of whom?
        ("A", "red and two in stack 1"),
        ("A", "red and blue left of stack 0"),
        # what are they, and what is taken for a remark?
        ("A", "I want a pyramid, red on blue"),
        # what is denied?
        ("A", "!(green on blue) && (red above blue)"),
        ("C", "white over brown, not quite touching"),
        ("A", "red on blue, they interleave"),
        ("A", "red on blue, the boss cancelled this"),
        ("A", "red on blue. I was joking."),
        ("A", "red on blue, not the red that is fragile"),
        ("A", "forbidden: red on blue"),
    ],
)
def test_what_is_not_clear_is_asked_back(scene: str, text: str) -> None:
    with pytest.raises(PlannerError):
        read(scene, text)


@pytest.mark.parametrize("denial", ["not", "never"])
@pytest.mark.parametrize(
    "text",
    [
        "the red box on the blue box",
        "put red on blue and green in stack 2",
        "See to it that at least one of the blocks is in stack 0.",
        "keep the yellow out of stack 0, the baby reaches there",
        "red in stack 0, green anywhere but there",
        "exactly one of red, blue and green is in stack 1",
        "from bottom to top in stack 1: red, blue, green",
        "Sort it so that the right stack holds blue, by lunch",
        "nothing on red, and yellow left of cyan",
    ],
)
def test_a_denial_is_never_lost(text: str, denial: str) -> None:
    meant = read("A", text)
    words = text.split()
    for at in range(len(words) + 1):
        denied = " ".join((*words[:at], denial, *words[at:]))
        try:
            told = read("A", denied)
        except PlannerError:
            continue
        assert told != meant, denied
