# SPDX-License-Identifier: Apache-2.0
"""Goals as people write them: orders, lists, numbers, negation, politeness, typos."""

from __future__ import annotations

import pytest

from planner_node.errors import PlannerError
from planner_node.goals import parse_goal, resolve_goal

#: Scenes without and with two things that are called alike.
PLAIN = ("blue_box", "cyan_box", "green_box", "red_box", "yellow_box")
MIXED = ("blue_box", "green_box", "red_box", "red_cylinder", "yellow_sphere")


def read(text: str, names: tuple[str, ...] = PLAIN, stack_count: int = 3) -> str:
    return str(resolve_goal(parse_goal(text), names, stack_count))


RED_ON_BLUE = "red_box on blue_box"


@pytest.mark.parametrize(
    "text",
    [
        "Put red on blue.",
        "Could you please put the red block on the blue one?",
        "I'd like red to be on top of blue, please",
        "i want the red box to be on the blue box",
        "red should sit on blue!",
        "the red one goes onto the blue one",
        "on the blue block goes the red one",
        "On top of blue, please put red",
        "on blue put red",
        "stack red onto blue",
        "make sure that red is directly on blue",
        "let red be on blue",
        "blue directly under red",
        "pick up the red block and put it on blue",
        "Take red. Put it on the blue block.",
        "take red and put on blue",
        "hello robot, move the red cube on top of the blue cube, thank you",
        "red must be standing on blue now",
        "We need to have red on blue",
        "red has to be right on top of blue",
        "build a tower with red on blue",
        "the red block, please, on the blue one",
        "red upon blue",
        "blue supports red",
    ],
)
def test_one_relation_in_many_words(text: str) -> None:
    assert read(text) == RED_ON_BLUE


@pytest.mark.parametrize(
    "text",
    [
        "red on bleu", "rde on blue", "redd on blue", "red on bluee", "pleas put red on blue",
        "putt red on blue", "red onn blue", "red onto teh blue blok", "red box on blue boxx",
        "plaese put teh red bock on blue", "read on blue",
    ],
)  # fmt: skip
def test_typos_are_read_as_what_they_are_like(text: str) -> None:
    assert read(text) == RED_ON_BLUE


@pytest.mark.parametrize(
    ("text", "meaning"),
    [
        ("red abvoe green", "red_box above green_box"),
        ("red belwo green", "green_box above red_box"),
        ("yelow lef of gren", "yellow_box left of green_box"),
        ("cyan rihgt of blue", "blue_box left of cyan_box"),
        ("red in stak 1", "red_box above stack1"),
        ("red nxet to blue", "red_box next to blue_box"),
    ],
)
def test_typos_in_relations(text: str, meaning: str) -> None:
    assert read(text) == meaning


@pytest.mark.parametrize(
    ("text", "meaning"),
    [
        ("red on blue on green", "red_box on blue_box, blue_box on green_box"),
        ("red left of blue left of green", "red_box left of blue_box, blue_box left of green_box"),
        ("red on blue left of green", "red_box on blue_box, blue_box left of green_box"),
        ("red on blue in stack 1", "red_box on blue_box, blue_box above stack1"),
        ("red on blue and left of green", "red_box on blue_box, red_box left of green_box"),
        ("red on blue, then green on red", "red_box on blue_box, green_box on red_box"),
        ("red on blue. green on red", "red_box on blue_box, green_box on red_box"),
        ("red & blue in stack 1", "red_box above stack1, blue_box above stack1"),
        (
            "red, blue and green in stack 2",
            "red_box above stack2, blue_box above stack2, green_box above stack2",
        ),
        ("red and blue on stack1", "red_box above stack1, blue_box above stack1"),
        ("red left of blue and green", "red_box left of blue_box, red_box left of green_box"),
        (
            "red on blue, green and yellow in stack1",
            "red_box on blue_box, green_box above stack1, yellow_box above stack1",
        ),
        ("move red to stack 1", "red_box above stack1"),
        ("put red into stack two", "red_box above stack2"),
        ("red in the left stack", "red_box above stack0"),
        ("red on the rightmost place", "red_box on stack2"),
        ("red in the middle stack", "red_box above stack1"),
        ("red next to blue", "red_box next to blue_box"),
        ("red underneath blue", "blue_box above red_box"),
        ("red on the left of blue", "red_box left of blue_box"),
        ("put red on stack 2 and yellow on top of it", "red_box on stack2, yellow_box on red_box"),
        (
            "move red to stack 0. after that, put blue on it",
            "red_box above stack0, blue_box on red_box",
        ),
        ("red on blue and green on it", "red_box on blue_box, green_box on red_box"),
        (
            "red is next to blue and left of it",
            "red_box next to blue_box, red_box left of blue_box",
        ),
        ("on stack1 put red, on stack 2 the blue box", "red_box on stack1, blue_box on stack2"),
        ("put red and blue in stack1", "red_box above stack1, blue_box above stack1"),
        ("my students want to see red on blue", "red_box on blue_box"),
        ("red shoud be ontop of blue", "red_box on blue_box"),
        ("make a tower: red on blue", "red_box on blue_box"),
        ("in stack 0 I want red and blue", "red_box above stack0, blue_box above stack0"),
        (
            "make a pile in stack 2 with red on the bottom, blue in the middle and green on top",
            "red_box on stack2, blue_box on red_box, green_box on blue_box",
        ),
        (
            "build a tower on stack 0: red at the bottom, then blue, then green on top",
            "red_box on stack0, blue_box on red_box, green_box on blue_box",
        ),
        ("from left to right: red, blue", "red_box left of blue_box"),
        ("neither red nor blue in stack 1", "red_box not above stack1, blue_box not above stack1"),
        (
            "I do not want red or blue in stack2",
            "red_box not above stack2, blue_box not above stack2",
        ),
        ("can yuo put redbox on blue", "red_box on blue_box"),
        ("for the next trial we need red on blue", "red_box on blue_box"),
        ("put on the blue box the red box", "red_box on blue_box"),
        (
            "red and blue in stack 1, everything else in stack 2",
            "red_box above stack1, blue_box above stack1, cyan_box above stack2, "
            "green_box above stack2, yellow_box above stack2",
        ),
        (
            "all blocks except the red one in stack 0",
            "blue_box above stack0, cyan_box above stack0, green_box above stack0, "
            "yellow_box above stack0",
        ),
        ("from bottom to top: red, blue, green", "blue_box on red_box, green_box on blue_box"),
        (
            "a tower in stack 1 from bottom to top: red, the blue box and green",
            "red_box on stack1, blue_box on red_box, green_box on blue_box",
        ),
        (
            "build one tower, from top to bottom red, blue and green",
            "blue_box on green_box, red_box on blue_box",
        ),
        ("red on stack1 and blue on it", "red_box on stack1, blue_box on red_box"),
        ("red on stack1 and on it the blue one", "red_box on stack1, blue_box on red_box"),
        ("the goal for my class: red on blue", "red_box on blue_box"),
        ("take red to stack 1", "red_box above stack1"),
        ("keep red out of stack 1", "red_box not above stack1"),
        ("red is not allowed next to blue", "red_box not next to blue_box"),
        ("red at the bottom of stack 1", "red_box on stack1"),
        ("red and blue both in stack 1", "red_box above stack1, blue_box above stack1"),
        (
            "red on blue, both in stack 1",
            "red_box on blue_box, red_box above stack1, blue_box above stack1",
        ),
        (
            "red next to blue, green left of both",
            "red_box next to blue_box, green_box left of red_box, green_box left of blue_box",
        ),
        (
            "red on blue and blue on green, all three in stack 1",
            "red_box on blue_box, blue_box on green_box, red_box above stack1, "
            "blue_box above stack1, green_box above stack1",
        ),
        ("red to left of blue", "red_box left of blue_box"),
    ],
)
def test_orders_and_lists(text: str, meaning: str) -> None:
    assert read(text) == meaning


@pytest.mark.parametrize(
    ("text", "meaning"),
    [
        ("red not on blue", "red_box not on blue_box"),
        ("don't put red on blue", "red_box not on blue_box"),
        ("red must not be above blue", "red_box not above blue_box"),
        ("red isn't left of blue", "red_box not left of blue_box"),
        ("never put red on blue, please", "red_box not on blue_box"),
        ("red on blue but not left of green", "red_box on blue_box, red_box not left of green_box"),
        ("red not in stack 1", "red_box not above stack1"),
        ("red not below blue", "blue_box not above red_box"),
    ],
)
def test_negation(text: str, meaning: str) -> None:
    assert read(text) == meaning


@pytest.mark.parametrize(
    ("text", "meaning"),
    [
        ("the sphere on a red block", "at least 1 of yellow_sphere on red_box or red_cylinder"),
        ("a red block on blue", "at least 1 of red_box, red_cylinder on blue_box"),
        ("a box in stack 1", "at least 1 of blue_box, green_box, red_box above stack1"),
        (
            "three blocks in stack1",
            "exactly 3 of blue_box, green_box, red_box, red_cylinder, yellow_sphere above stack1",
        ),
        (
            "at least two boxes on stack1",
            "at least 2 of blue_box, green_box, red_box above stack1",
        ),
        ("at most one box in stack 0", "at most 1 of blue_box, green_box, red_box above stack0"),
        ("every red block in stack1", "red_box above stack1, red_cylinder above stack1"),
        ("all boxes left of the sphere", ", ".join(
            f"{name} left of yellow_sphere" for name in MIXED[:3]
        )),
        ("the red blocks on stack1", "red_box above stack1, red_cylinder above stack1"),
        ("both red blocks in stack1", "red_box above stack1, red_cylinder above stack1"),
        ("no red block on blue", "red_box not on blue_box, red_cylinder not on blue_box"),
        ("sphere not on a red block", ", ".join(
            f"yellow_sphere not on red_{shape}" for shape in ("box", "cylinder")
        )),
        ("ball on the green cube", "yellow_sphere on green_box"),
    ],
)  # fmt: skip
def test_numbers_and_kinds(text: str, meaning: str) -> None:
    assert read(text, MIXED) == meaning


NOTHING_ON_RED = ", ".join(
    f"{name} not above red_box" for name in ("blue_box", "cyan_box", "green_box", "yellow_box")
)
NOTHING_IN_TWO = ", ".join(f"{name} not above stack2" for name in PLAIN)


@pytest.mark.parametrize(
    ("text", "meaning"),
    [
        ("nothing on red", NOTHING_ON_RED),
        ("clear red", NOTHING_ON_RED),
        ("red should be clear", NOTHING_ON_RED),
        ("there should be nothing on red", NOTHING_ON_RED),
        ("make sure nothing is on top of the red block", NOTHING_ON_RED),
        ("clear stack2", NOTHING_IN_TWO),
        ("stack 2 empty", NOTHING_IN_TWO),
        ("keep stack2 free", NOTHING_IN_TWO),
        ("no blocks in stack2", NOTHING_IN_TWO),
        ("nothing on stack2", NOTHING_IN_TWO),
        ("leave stack2 empty, please", NOTHING_IN_TWO),
        ("don't leave anything in stack 2", NOTHING_IN_TWO),
        ("keep red and stack2 clear", f"{NOTHING_ON_RED}, {NOTHING_IN_TWO}"),
        ("red clear and in stack 0", f"{NOTHING_ON_RED}, red_box above stack0"),
        ("clear stack2 and red", f"{NOTHING_IN_TWO}, {NOTHING_ON_RED}"),
        ("clear stack2, red on blue", f"{NOTHING_IN_TWO}, red_box on blue_box"),
    ],
)
def test_nothing(text: str, meaning: str) -> None:
    assert read(text) == meaning


@pytest.mark.parametrize(
    "text",
    [
        "red or blue in stack1", "if red is on blue, green on yellow", "swap red and blue",
        "red on it", "red left of blue and green on it", "red, blue in stack1 and green on it",
        "put it on blue", "red near blue", "red on purple", "red on the table",
        "build something nice", "red on blue unless green is clear", "put red there",
        "red left of blue on stack1", "red next to blue next to green",
        "red on blue not on green", "put red first on blue last", "red on nothing",
        "red half on blue", "not every block on red", "red between blue and green", "red on top",
        "red left of blue and green, yellow on cyan", "red on stack 7", "only red on blue",
        "rad on white", "red on the first place", "red on a different block",
        "red on blue on green, both in stack1", "forbidden: red on blue",
        "from bottom to top: red", "from top to bottom: red, blue on green",
        "avoid this: red on blue", "red at the bottom of blue", "exchange red with blue",
        "red away from blue", "red on the block that blue is on", "as many as possible on stack1",
        "take red", "two red blocks on two blue blocks",
        "red level with yellow, green above blue", "red same as blue, green on yellow",
        "everything else in stack1", "red at the bottom", "red at the bottom, blue on top of it",
        "red on top", "neither red on blue nor green", "red or blue not on green",
         "red above or below blue", "red on blue instead of green",
    ],
)  # fmt: skip
def test_what_is_not_understood_is_asked_back(text: str) -> None:
    with pytest.raises(PlannerError) as caught:
        read(text)
    assert caught.value.status in ("INVALID_GOAL", "UNKNOWN_OBJECT", "AMBIGUOUS_OBJECT")
