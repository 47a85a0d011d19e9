# SPDX-License-Identifier: Apache-2.0
"""Another planner's plan is read as it was written, and refused with the step that fails."""

from __future__ import annotations

import pytest

from planner_node import Figure, Stability
from planner_node.errors import GivenPlanError
from planner_node.goals import Goal
from planner_node.search.peers.given_plan import checked_plan
from planner_node.search.peers.read_plan import read_moves
from scene_graph import BOX, SPHERE, Move, Relation, Stacks

START: Stacks = (("red_box", "blue_box"), (), ("green_box",))
GOAL = Goal((Relation("red_box", "up", "green_box"),))
RIGHT = [Move(0, 1), Move(0, 2)]


@pytest.mark.parametrize(
    "text",
    [
        "(move blue_box red_box stack1)\n(move red_box stack0 green_box)\n; cost = 2 (unit cost)\n",
        "0.000: (MOVE BLUE_BOX RED_BOX STACK1) [1.000]\n1.000: (MOVE RED_BOX STACK0 GREEN_BOX) [1]",
        "(0, 1)\n(0, 2)",
        "0 1\n\n# then\n0 2",
        "(0, 1) blue_box  [red_box | blue_box | green_box]\n(0, 2) red_box",
        "move(blue_box, red_box, stack1)\nmove(red_box, stack0, green_box)",
        "blue_box from red_box to stack1\nred_box from stack0 onto green_box",
        "(move blue_box red_box stack1)\n(move red_box stack0 green_box)\n(look stack0)\n"
        "(look-up stack0 stack1 spot-0-0 spot-0-1)\n(check-0-0 spot-0-0 spot-0-1)",
    ],
)
def test_a_plan_is_read(text: str) -> None:
    assert read_moves(text, START) == RIGHT
    assert checked_plan(text, START, GOAL).moves == tuple(RIGHT)


@pytest.mark.parametrize(
    ("text", "step", "words"),
    [
        ("(0, 1)\nput red on green", 1, "step 2 of the plan, 'put red on green', is not under"),
        ("(move blue_box stack0 stack1)", 0, "blue_box is not on stack0, but on red_box"),
        ("(move red_box stack0 stack1)", 0, "blue_box stands on red_box"),
        ("(0, 1)\n(0, 2)\n(0, 2)", 2, "stack0 is empty"),
        ("(0, 3)", 0, "no stack3; there are 3 stacks"),
        ("(-1, 1)", 0, "no stack-1"),
        ("(1, 1)", 0, "stack1 is empty"),
        ("(0, 0)", 0, "ends where it starts"),
        ("(0, 1) red_box", 0, "blue_box stands on red_box"),
        ("(0, 1) green_box", 0, "green_box is on stack2, not on stack0"),
        ("(move pink_box stack0 stack1)", 0, "no pink_box; there are blue_box"),
        ("(move stack0 stack1 stack2)", 0, "stack0 is a place"),
        ("(move blue_box red_box blue_box)", 0, "ends where it starts"),
        ("(0, 1)\n(2, 0)", 2, "'red_box on green_box' is not true"),
        ("(0, 2)\n(0, 2)", 2, "'red_box on green_box' is not true"),
        ("(move blue_box red_box stack1)\n(move red_box stack0 stack2)", 1, "green_box stands on"),
    ],
)
def test_a_plan_that_is_none_is_refused_with_its_step(text: str, step: int, words: str) -> None:
    with pytest.raises(GivenPlanError, match=words) as caught:
        checked_plan(text, START, GOAL)
    assert (caught.value.step, caught.value.status) == (step, "INVALID_PLAN")


def test_without_a_goal_a_plan_leads_where_it_leads() -> None:
    assert checked_plan("(0, 1)", START, None).states[-1] == (
        ("red_box",), ("blue_box",), ("green_box",)
    )  # fmt: skip


def test_what_falls_is_refused_and_what_stands_badly_is_told() -> None:
    figures = {
        "red_box": Figure(BOX, 0.08, 0.08),
        "green_box": Figure(BOX, 0.04, 0.04),
        "blue_box": Figure(SPHERE, 0.04, 0.04),
    }
    plan = checked_plan("0 1\n0 2", START, GOAL, Stability(figures))
    assert plan.note == "unstable: red_box on green_box (it is 2.0 times as wide)"
    with pytest.raises(GivenPlanError, match="puts red_box on green_box") as caught:
        checked_plan("0 1\n0 2", START, GOAL, Stability(figures, require=True))
    assert caught.value.step == 1
    with pytest.raises(GivenPlanError, match=r"move 2, .* puts red_box on blue_box"):
        checked_plan("0 1\n0 1", START, None, Stability(figures))
