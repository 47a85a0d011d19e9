# SPDX-License-Identifier: Apache-2.0
"""The independent check finds every kind of defect in a plan, and stands before what is told."""

from __future__ import annotations

import random
import subprocess
import sys

import pytest
from hypothesis import given
from hypothesis import strategies as st
from planner_states import NAMES, random_state, relation_holds, relations_between

from planner_node.goals import Count, Goal, complete_goal
from planner_node.search import ALGORITHMS, Limits, Problem, State, make_plan, successors
from planner_node.validator import InvalidPlanError, validate_plan
from scene_graph import Move, Relation, Stacks

START: Stacks = (("red_box", "blue_box"), (), ("green_box",))
GOAL = Goal((Relation("red_box", "up", "green_box"),))
RIGHT = (Move(0, 1), Move(0, 2))


def test_a_right_plan_passes() -> None:
    validate_plan(START, GOAL, RIGHT)


@pytest.mark.parametrize(
    ("moves", "step", "words"),
    [
        ((Move(0, 1),), 1, "'red_box on green_box' is not true"),
        ((Move(1, 0), *RIGHT), 0, "takes from an empty place"),
        ((*RIGHT[:1], Move(2, 2)), 1, "ends where it starts"),
        ((Move(0, 3),), 0, "names no place of the table"),
        ((Move(-1, 1),), 0, "names no place of the table"),
    ],
)
def test_a_wrong_plan_is_refused_with_its_step(
    moves: tuple[Move, ...], step: int, words: str
) -> None:
    with pytest.raises(InvalidPlanError, match=words) as caught:
        validate_plan(START, GOAL, moves)
    assert caught.value.step == step
    assert caught.value.status == "INTERNAL_ERROR"


def test_states_that_the_moves_do_not_lead_to_are_refused() -> None:
    states = make_plan(START, GOAL).states
    validate_plan(START, GOAL, RIGHT, states)
    with pytest.raises(InvalidPlanError, match="the state after 1 moves"):
        validate_plan(START, GOAL, RIGHT, (states[0], states[0], states[2]))
    with pytest.raises(InvalidPlanError, match="comes with 2 states"):
        validate_plan(START, GOAL, RIGHT, states[:2])


@given(
    st.integers(0, 1000),
    relations_between(NAMES[:4], ("stack0", "stack1", "stack2")),
)
def test_a_relation_is_read_as_it_is_meant(seed: int, relation: Relation) -> None:
    state = random_state(NAMES[:4], 3, random.Random(seed))
    if relation_holds(state, relation):
        validate_plan(state, Goal((relation,)), ())
    else:
        with pytest.raises(InvalidPlanError):
            validate_plan(state, Goal((relation,)), ())


def test_a_block_that_is_not_there_fulfils_nothing() -> None:
    with pytest.raises(InvalidPlanError):
        validate_plan(START, Goal((Relation("white_box", "left", "green_box"),)), ())


def test_a_count_is_read_as_it_is_meant() -> None:
    state: Stacks = (("red_box", "blue_box", "green_box"), (), ())
    above = tuple(Relation(name, "above", "stack0") for name in NAMES[:3])
    for least in range(4):
        for most in range(least, 4):
            goal = Goal((), (Count("some in stack0", above, least, most),))
            if most == 3:
                validate_plan(state, goal, ())
            else:
                with pytest.raises(InvalidPlanError, match="'some in stack0' is not true"):
                    validate_plan(state, goal, ())


def test_the_plan_of_a_defective_search_is_not_given_out(monkeypatch: pytest.MonkeyPatch) -> None:
    def defective(problem: Problem, _limits: Limits) -> list[State]:
        return [problem.start, next(successors(problem.start))[0]]

    monkeypatch.setitem(ALGORITHMS, "defective", defective)
    with pytest.raises(InvalidPlanError):
        make_plan(START, complete_goal(((), ("blue_box", "red_box"), ("green_box",))),
                  algorithm="defective")  # fmt: skip


def test_it_does_not_need_the_search() -> None:
    code = """
import sys, types, importlib.util
package = types.ModuleType("planner_node")
package.__path__ = list(importlib.util.find_spec("planner_node").submodule_search_locations)
sys.modules["planner_node"] = package
import planner_node.validator
assert not [name for name in sys.modules if name.startswith("planner_node.search")]
"""
    subprocess.run([sys.executable, "-c", code], check=True)
