# SPDX-License-Identifier: Apache-2.0
from __future__ import annotations

import random

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from planner_states import (
    NAMES,
    distance,
    neighbours,
    random_state,
    relation_holds,
    relations_between,
)

from planner_node.errors import (
    ContradictoryGoalError,
    SearchCancelledError,
    SearchLimitError,
    UnreachableError,
)
from planner_node.goals import Count, Goal, complete_goal
from planner_node.search import (
    ALGORITHMS,
    Limits,
    Problem,
    SearchResult,
    State,
    make_plan,
    search,
    successors,
)
from planner_node.search.a_star import moves_left
from planner_node.search.limits import POLL_INTERVAL
from planner_node.search.patterns import pattern_space
from scene_graph import Relation, Stacks

FOUR = NAMES[:4]


def check_plan(initial: Stacks, goal: Goal, result: SearchResult) -> None:
    """A plan is a chain of legal moves from the initial state to one that fulfils the goal."""
    assert result.states[0] == initial
    assert len(result.moves) == len(result.states) - 1
    for before, move, after in zip(result.states, result.moves, result.states[1:]):
        assert after in set(neighbours(before))
        assert len(after[move.target]) == len(before[move.target]) + 1
        assert len(after[move.source]) == len(before[move.source]) - 1
    assert holds(goal, result.states[-1])


@st.composite
def problems(draw: st.DrawFn) -> tuple[Stacks, Goal]:
    """Four blocks on one to three stacks, and a partial goal, often an impossible one."""
    stack_count = draw(st.sampled_from((1, 2, 3)))
    initial = random_state(FOUR, stack_count, random.Random(draw(st.integers(0, 10_000))))
    bases = tuple(f"stack{index}" for index in range(stack_count))
    one = relations_between(FOUR, bases)
    relations = draw(st.lists(one, min_size=1, max_size=4, unique=True))
    if not draw(st.booleans()):
        return initial, Goal(tuple(relations))
    counted = tuple(draw(st.lists(one, min_size=2, max_size=4, unique=True)))
    least = draw(st.integers(0, len(counted)))
    most = draw(st.integers(least, len(counted)))
    count = Count("a number of them", counted, least, most)
    return initial, Goal(tuple(relations[1:]), (count,))


def holds(goal: Goal, state: Stacks) -> bool:
    counts = all(
        item.least <= sum(relation_holds(state, one) for one in item.relations) <= item.most
        for item in goal.counts
    )
    return counts and all(relation_holds(state, item) for item in goal.relations)


@pytest.mark.parametrize("algorithm", ALGORITHMS)
@settings(max_examples=100)
@given(problem=problems())
def test_plans_for_partial_goals_are_shortest(algorithm: str, problem: tuple[Stacks, Goal]) -> None:
    initial, goal = problem
    shortest = distance(initial, lambda state: holds(goal, state))
    if shortest is None:
        with pytest.raises((UnreachableError, ContradictoryGoalError)):
            make_plan(initial, goal, algorithm=algorithm)
        # The search proves it by itself, too.
        with pytest.raises(UnreachableError):
            search(initial, goal, algorithm=algorithm)
    else:
        result = make_plan(initial, goal, algorithm=algorithm)
        assert len(result.moves) == shortest
        check_plan(initial, goal, result)


@pytest.mark.parametrize("algorithm", ALGORITHMS)
@pytest.mark.parametrize("seed", range(15))
def test_plans_for_complete_goals_are_shortest(algorithm: str, seed: int) -> None:
    rng = random.Random(seed)
    names = NAMES[:5]
    initial, target = random_state(names, 3, rng), random_state(names, 3, rng)
    result = make_plan(initial, complete_goal(target), algorithm=algorithm)
    assert len(result.moves) == distance(initial, lambda state: state == target)
    assert result.states[-1] == target
    check_plan(initial, complete_goal(target), result)


@settings(max_examples=200)
@given(problems())
def test_the_bound_of_a_star_never_promises_too_much(problem: tuple[Stacks, Goal]) -> None:
    initial, goal = problem
    shortest = distance(initial, lambda state: holds(goal, state))
    encoded = Problem(initial, goal)
    bound = moves_left(encoded)
    if shortest is not None:
        assert bound(encoded.start) <= shortest
    for successor, _ in successors(encoded.start):
        assert bound(encoded.start) - bound(successor) <= 1


def test_a_star_looks_at_fewer_states_than_breadth_first() -> None:
    initial: Stacks = (NAMES, (), ())
    goal = complete_goal(((), NAMES, ()))
    expanded = {
        name: make_plan(initial, goal, algorithm=name).expanded
        for name in ("a_star", "breadth_first")
    }
    assert 10 * expanded["a_star"] < expanded["breadth_first"]


def test_an_unknown_algorithm_comes_with_the_known_ones() -> None:
    goal = Goal((Relation("red_box", "up", "stack1"),))
    with pytest.raises(ValueError, match="no search algorithm 'magic'; known: auto, breadth_first"):
        make_plan((("red_box",), ()), goal, algorithm="magic")


def test_an_algorithm_of_ones_own_is_used_by_its_name(monkeypatch: pytest.MonkeyPatch) -> None:
    def first_move(problem: Problem, _limits: Limits) -> list[State]:
        return [problem.start, next(successors(problem.start))[0]]

    monkeypatch.setitem(ALGORITHMS, "first_move", first_move)
    goal = Goal((Relation("red_box", "up", "stack1"),))
    assert len(make_plan((("red_box",), ()), goal, algorithm="first_move").moves) == 1


def test_a_goal_that_holds_needs_no_moves() -> None:
    state: Stacks = (("red_box", "blue_box"), ())
    goal = Goal((Relation("blue_box", "up", "red_box"),))
    result = make_plan(state, goal)
    assert (result.moves, result.states, result.expanded) == ((), (state,), 0)


def test_two_stacks_cannot_change_the_order_and_that_is_proven() -> None:
    initial: Stacks = (("red_box", "blue_box", "green_box"), ())
    for goal in (
        Goal((Relation("red_box", "up", "blue_box"), Relation("blue_box", "up", "stack0"))),
        complete_goal((("blue_box", "red_box", "green_box"), ())),
    ):
        with pytest.raises(UnreachableError) as caught:
            make_plan(initial, goal)
        assert 0 < caught.value.expanded <= 8
        assert "all reachable states were searched" in str(caught.value)


def test_blocks_that_the_goal_does_not_mention_are_not_told_apart() -> None:
    initial: Stacks = (("red_box", "blue_box", *NAMES[3:]), ("green_box",), ())
    on_two = (Relation("red_box", "up", "stack0"), Relation("red_box", "up", "stack1"))
    with pytest.raises(UnreachableError) as caught:
        search(initial, Goal(on_two), algorithm="breadth_first")
    # One block among six like it: 6 places times C(8, 2) heights of three stacks.
    assert caught.value.expanded == 6 * 28


def test_what_no_arrangement_fulfils_is_proven_without_a_search() -> None:
    names = tuple(f"block{index}" for index in range(12))
    in_a_circle = (
        Relation(names[0], "left", names[1]),
        Relation(names[1], "left", names[2]),
        Relation(names[2], "left", names[3]),
    )
    with pytest.raises(UnreachableError, match="no arrangement of these blocks") as caught:
        search((names, (), ()), Goal(in_a_circle))
    assert caught.value.expanded == 0


@pytest.mark.parametrize("algorithm", ALGORITHMS)
def test_every_algorithm_stops_when_it_is_cancelled(algorithm: str) -> None:
    rng = random.Random(1)
    names = tuple(f"block{index}" for index in range(9))
    initial, target = random_state(names, 3, rng), random_state(names, 3, rng)
    with pytest.raises(SearchCancelledError):
        search(initial, complete_goal(target), cancelled=lambda: True, algorithm=algorithm)


@pytest.mark.parametrize("algorithm", ALGORITHMS)
def test_the_search_is_deterministic(algorithm: str) -> None:
    rng = random.Random(2)
    names = NAMES[:5]
    initial, target = random_state(names, 3, rng), random_state(names, 3, rng)
    goal = Goal(complete_goal(target).relations[1:4])
    first = search(initial, goal, algorithm=algorithm)
    pattern_space.cache_clear()
    again = search(initial, goal, algorithm=algorithm)
    assert (first.moves, first.expanded) == (again.moves, again.expanded)


def test_the_bound_is_told_from_a_proof() -> None:
    rng = random.Random(1)
    initial, target = random_state(NAMES, 3, rng), random_state(NAMES, 3, rng)
    with pytest.raises(SearchLimitError) as caught:
        make_plan(initial, complete_goal(target), max_expansions=3)
    assert caught.value.expanded == 3
    assert "max_expansions" in str(caught.value)


def test_a_search_can_be_cancelled_soon() -> None:
    circle = zip(NAMES, (*NAMES[1:], NAMES[0]))
    goal = Goal(tuple(Relation(a, "up", b) for a, b in circle))
    polls = 0

    def cancelled() -> bool:
        nonlocal polls
        polls += 1
        return polls > 2

    with pytest.raises(SearchCancelledError) as caught:
        search((NAMES, (), ()), goal, cancelled=cancelled, algorithm="breadth_first")
    assert caught.value.expanded == 2 * POLL_INTERVAL


def test_a_goal_about_a_block_that_is_not_there_is_unreachable() -> None:
    with pytest.raises(UnreachableError):
        make_plan((("red_box",), ()), Goal((Relation("red_box", "up", "green_box"),)))
