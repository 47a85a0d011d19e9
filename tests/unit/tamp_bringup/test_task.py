# SPDX-License-Identifier: Apache-2.0
"""Goals of the demo and the benchmark, and their texts."""

import json

import pytest

from planner_node.errors import PlannerError
from planner_node.goals import parse_goal, resolve_goal
from scene_graph import SceneGraph
from sim_node.layouts import random_layout
from tamp_bringup.task import (
    Failure,
    SceneForGoalError,
    TaskResult,
    goal_text,
    random_goal,
    scene_for_goal,
)
from tamp_bringup.task_runner import goal_holds

NAMES = ["red_box", "green_box", "blue_box", "pink_box", "cyan_box", "brown_box"]


def test_a_goal_text_says_the_whole_state() -> None:
    for seed in range(20):
        state = random_goal(NAMES, seed)
        goal = resolve_goal(parse_goal(goal_text(state)), NAMES)
        assert goal.holds(state)
        assert goal.state(NAMES, 3) == state


def test_a_goal_uses_the_blocks_of_the_start_and_is_drawn_apart_from_it() -> None:
    same = 0
    for seed in range(50):
        start = random_layout(seed, 6)
        names = [name for stack in start for name in stack]
        goal = random_goal(names, seed)
        assert sorted(name for stack in goal for name in stack) == sorted(names)
        same += goal == start
    assert same <= 2  # by chance one in 20,160


def test_the_order_of_the_names_does_not_change_the_goal() -> None:
    assert random_goal(NAMES, 3) == random_goal(NAMES[::-1], 3)


def test_a_result_can_be_written() -> None:
    result = TaskResult(
        False, "red on blue", [["a", "up", "b"]], [], 3, 2, 1, {"total": 1.0}, Failure("x", "y")
    )
    content = json.loads(json.dumps(result.to_json()))
    assert content["failure"] == {"module": "x", "reason": "y"}
    assert content["moves_executed"] == 2


@pytest.mark.parametrize("seed", [0, 3, 500])
@pytest.mark.parametrize(
    ("goal", "colors"),
    [
        ("red on blue", {"red", "blue"}),
        ("the pink box left of cyan, orange block above pink", {"pink", "cyan", "orange"}),
        ("red_box on stack2", {"red"}),
        ("nothing on red, three blocks in stack1", {"red"}),
    ],
)
def test_fault_17_a_goal_gets_a_scene_that_has_its_blocks(
    goal: str, colors: set[str], seed: int
) -> None:
    found, blocks = scene_for_goal(goal, seed)
    names = {name for stack in random_layout(found, blocks) for name in stack}
    assert {f"{color}_box" for color in colors} <= names
    assert found >= seed
    for earlier in range(seed, found):  # it is the first one
        others = {name for stack in random_layout(earlier, blocks) for name in stack}
        assert not {f"{color}_box" for color in colors} <= others


def test_a_scene_that_has_the_blocks_is_left_as_it_was_asked_for() -> None:
    names = [name for stack in random_layout(7, 4) for name in stack]
    assert scene_for_goal(f"{names[0]} on {names[1]}", 7, 4) == (7, 4)
    assert scene_for_goal("", 7, 4) == (7, 4)
    assert scene_for_goal("", 7) == (7, 5)


def test_a_goal_of_many_blocks_gets_as_many() -> None:
    goal = "red on blue, green on red, pink on green, cyan on pink, brown on cyan"
    assert scene_for_goal(goal, 0)[1] == 6


@pytest.mark.parametrize(
    ("goal", "blocks", "sentence"),
    [
        ("red on mauve", None, "'mauve' is in no scene"),
        ("red cylinder on blue", None, "it has boxes"),
        ("red on blue, green on red, pink on green", 3, "names 4 blocks, the scene has 3"),
        ("red on blue, green on pink, brown on cyan, purple on orange", None, "names 8 blocks"),
    ],
)
def test_fault_17_a_goal_without_a_scene_is_refused_in_a_sentence(
    goal: str, blocks: int | None, sentence: str
) -> None:
    with pytest.raises(SceneForGoalError, match=sentence):
        scene_for_goal(goal, 0, blocks)
    with pytest.raises(PlannerError):
        scene_for_goal("box on red", 0, blocks)


def test_fault_17_of_a_block_that_is_not_there_nothing_holds() -> None:
    assert not goal_holds("red on blue", SceneGraph((), frozenset()))
