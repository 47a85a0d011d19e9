# SPDX-License-Identifier: Apache-2.0
"""Goals of the demo and the benchmark, and their texts."""

import json

from planner_node.goals import parse_goal, resolve_goal
from sim_node.layouts import random_layout
from tamp_bringup.task import Failure, TaskResult, goal_text, random_goal

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
