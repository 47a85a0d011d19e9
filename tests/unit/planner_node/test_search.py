# SPDX-License-Identifier: Apache-2.0
from __future__ import annotations

import random

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from planner_states import NAMES, distance, neighbours, random_state, relation_holds

from planner_node.errors import (
    ContradictoryGoalError,
    SearchCancelledError,
    SearchLimitError,
    UnreachableError,
)
from planner_node.goals import ABOVE, LEFT_OF, ON, Goal, GoalRelation, complete_goal
from planner_node.planning import make_plan
from planner_node.search import POLL_INTERVAL, SearchResult, search
from scene_graph import Stacks

FOUR = NAMES[:4]


def check_plan(initial: Stacks, goal: Goal, result: SearchResult) -> None:
    """A plan is a chain of legal moves from the initial state to one that fulfils the goal."""
    assert result.states[0] == initial
    assert len(result.moves) == len(result.states) - 1
    for before, move, after in zip(result.states, result.moves, result.states[1:]):
        assert after in set(neighbours(before))
        assert len(after[move.target]) == len(before[move.target]) + 1
        assert len(after[move.source]) == len(before[move.source]) - 1
    for item in goal.relations:
        assert relation_holds(result.states[-1], item.subject, item.predicate, item.object)


@settings(max_examples=200)
@given(st.data())
def test_plans_for_partial_goals_are_shortest(data: st.DataObject) -> None:
    stack_count = data.draw(st.sampled_from((1, 2, 3)))
    rng = random.Random(data.draw(st.integers(0, 10_000)))
    initial = random_state(FOUR, stack_count, rng)
    bases = tuple(f"stack{index}" for index in range(stack_count))
    relations = data.draw(
        st.lists(
            st.one_of(
                st.builds(
                    GoalRelation,
                    st.sampled_from(FOUR),
                    st.sampled_from((ON, ABOVE)),
                    st.sampled_from((*FOUR, *bases)),
                ),
                st.builds(
                    GoalRelation, st.sampled_from(FOUR), st.just(LEFT_OF), st.sampled_from(FOUR)
                ),
            ),
            min_size=1,
            max_size=4,
            unique=True,
        )
    )
    goal = Goal(tuple(relations))
    shortest = distance(
        initial,
        lambda state: all(
            relation_holds(state, item.subject, item.predicate, item.object) for item in relations
        ),
    )
    if shortest is None:
        with pytest.raises((UnreachableError, ContradictoryGoalError)):
            make_plan(initial, goal)
        # The search proves it by itself, too.
        with pytest.raises(UnreachableError):
            search(initial, goal)
    else:
        result = make_plan(initial, goal)
        assert len(result.moves) == shortest
        check_plan(initial, goal, result)


@pytest.mark.parametrize("seed", range(40))
def test_plans_for_complete_goals_are_shortest(seed: int) -> None:
    rng = random.Random(seed)
    names = NAMES[:5]
    initial, target = random_state(names, 3, rng), random_state(names, 3, rng)
    result = make_plan(initial, complete_goal(target))
    assert len(result.moves) == distance(initial, lambda state: state == target)
    assert result.states[-1] == target
    check_plan(initial, complete_goal(target), result)


def test_a_goal_that_holds_needs_no_moves() -> None:
    state: Stacks = (("red_box", "blue_box"), ())
    goal = Goal((GoalRelation("blue_box", ON, "red_box"),))
    result = make_plan(state, goal)
    assert (result.moves, result.states, result.expanded) == ((), (state,), 0)


def test_two_stacks_cannot_change_the_order_and_that_is_proven() -> None:
    initial: Stacks = (("red_box", "blue_box", "green_box"), ())
    for goal in (
        Goal((GoalRelation("red_box", ON, "blue_box"), GoalRelation("blue_box", ON, "stack0"))),
        complete_goal((("blue_box", "red_box", "green_box"), ())),
    ):
        with pytest.raises(UnreachableError) as caught:
            make_plan(initial, goal)
        assert 0 < caught.value.expanded <= 8
        assert "all reachable states were searched" in str(caught.value)


def test_blocks_that_the_goal_does_not_mention_are_not_told_apart() -> None:
    initial: Stacks = (("red_box", "blue_box", *NAMES[3:]), ("green_box",), ())
    on_two = (GoalRelation("red_box", ON, "stack0"), GoalRelation("red_box", ON, "stack1"))
    with pytest.raises(UnreachableError) as caught:
        search(initial, Goal(on_two))
    # One block among six like it: 6 places times C(8, 2) heights of three stacks.
    assert caught.value.expanded == 6 * 28


def test_the_bound_is_told_from_a_proof() -> None:
    rng = random.Random(1)
    initial, target = random_state(NAMES, 3, rng), random_state(NAMES, 3, rng)
    with pytest.raises(SearchLimitError) as caught:
        make_plan(initial, complete_goal(target), max_expansions=10)
    assert caught.value.expanded == 10
    assert "max_expansions" in str(caught.value)


def test_a_search_can_be_cancelled_soon() -> None:
    circle = zip(NAMES, (*NAMES[1:], NAMES[0]))
    goal = Goal(tuple(GoalRelation(a, ON, b) for a, b in circle))
    polls = 0

    def cancelled() -> bool:
        nonlocal polls
        polls += 1
        return polls > 2

    with pytest.raises(SearchCancelledError) as caught:
        search((NAMES, (), ()), goal, cancelled=cancelled)
    assert caught.value.expanded == 2 * POLL_INTERVAL


def test_a_goal_about_a_block_that_is_not_there_is_unreachable() -> None:
    with pytest.raises(UnreachableError):
        make_plan((("red_box",), ()), Goal((GoalRelation("red_box", ON, "green_box"),)))
