# SPDX-License-Identifier: Apache-2.0
"""Plans that put nothing where it is unstable (5.4.2), by brute force over all arrangements."""

from __future__ import annotations

import random

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from planner_states import NAMES, State, random_state
from stable_states import best, placement, price, random_problem, rules

from planner_node import Figure, Goal, make_plan, make_stable_plan, parse_goal, resolve_goal
from planner_node.errors import (
    ContradictoryGoalError,
    ImpossibleError,
    SearchLimitError,
    UnstableError,
)
from planner_node.goals import complete_goal
from planner_node.search.possible import Exclusion
from scene_graph import Stacks

START: Stacks = (("green_box", "red_sphere"), ("blue_box",), ("pink_box",))
FIGURES = {name: Figure(name.split("_")[1], 0.045, 0.045) for stack in START for name in stack}


def goal(text: str, stacks: Stacks = START) -> Goal:
    return resolve_goal(parse_goal(text), [name for stack in stacks for name in stack])


@settings(max_examples=120, deadline=None)
@given(seed=st.integers(0, 10**6), require=st.booleans())
def test_as_little_as_possible_is_unstable_and_then_as_few_moves(seed: int, require: bool) -> None:
    figures, initial, wanted = random_problem(seed)
    expected = best(figures, initial, wanted, require)
    if expected is None:
        with pytest.raises((UnstableError, ContradictoryGoalError)):
            make_stable_plan(initial, wanted, rules(figures, require))
        return
    found = make_stable_plan(initial, wanted, rules(figures, require))
    prices = [
        (step, *pair, price(figures, *pair))
        for step, states in enumerate(zip(found.states, found.states[1:]))
        if None not in (pair := placement(*states))
    ]
    assert not any(cost is None for *_, cost in prices)
    assert (sum(cost or 0 for *_, cost in prices), len(found.moves)) == expected
    told = [(item.step, item.block, item.support) for item in found.unstable]
    assert told == [(step, *pair) for step, *pair, cost in prices if cost]
    longer = len(found.moves) - len(make_plan(initial, wanted).moves)
    assert bool(found.note) == (longer > 0 or bool(told))
    if longer > 0:
        assert found.note.startswith(f"{longer} move")


@settings(max_examples=40, deadline=None)
@given(seed=st.integers(0, 10**6), blocks=st.integers(1, 6), complete=st.booleans())
def test_boxes_of_one_size_get_the_plans_that_they_always_got(
    seed: int, blocks: int, complete: bool
) -> None:
    rng = random.Random(seed)
    initial = random_state(NAMES[:blocks], 3, rng)
    wanted = complete_goal(random_state(NAMES[:blocks], 3, rng))
    if not complete:
        wanted = Goal(wanted.relations[: max(1, blocks // 2)])
    plain = make_plan(initial, wanted)
    found = make_stable_plan(
        initial, wanted, rules({name: Figure("box", 0.05, 0.03) for name in NAMES})
    )
    assert (found.moves, found.expanded, found.note) == (plain.moves, plain.expanded, "")


def test_a_longer_plan_says_what_the_shortest_would_have_done() -> None:
    wanted = goal("blue on stack0, green on stack1")
    start: Stacks = (("green_box",), ("blue_box",), ("pink_box", "red_sphere"))
    assert len(make_plan(start, wanted).moves) == 3
    found = make_stable_plan(start, wanted, rules(FIGURES))
    assert len(found.moves) > 3
    extra = len(found.moves) - 3
    assert found.note.startswith(
        f"{extra} move{'s' if extra > 1 else ''} longer than the shortest plan, which puts "
    )
    assert "on red_sphere (it would roll off)" in found.note


@pytest.mark.parametrize("text", ["blue on red", "blue above red"])
def test_a_goal_that_cannot_stand_is_refused_by_name(text: str) -> None:
    with pytest.raises(UnstableError, match="blue_box cannot stand on red_sphere") as failure:
        make_stable_plan(START, goal(text), rules(FIGURES))
    assert failure.value.status == "UNREACHABLE"
    assert "stability:=ignore" in str(failure.value)
    assert make_stable_plan(START, goal(text), None).moves


def test_what_stands_so_already_may_stay() -> None:
    start: Stacks = (("red_sphere", "blue_box"), ("green_box",), ())
    wanted = goal("blue on red, green on stack2", start)
    figures = {"red_sphere": Figure("sphere", 0.04, 0.04)}
    assert len(make_stable_plan(start, wanted, rules(figures)).moves) == 1


def test_a_much_wider_block_is_put_where_the_goal_asks_for_it_unless_that_is_forbidden() -> None:
    figures = {**FIGURES, "blue_box": Figure("box", 0.08, 0.08)}
    wanted = goal("blue on pink")
    found = make_stable_plan(START, wanted, rules(figures))
    assert found.note == (
        "unstable, but no plan avoids it: blue_box on pink_box (it is 1.8 times as wide)"
    )
    with pytest.raises(UnstableError, match="'blue_box on pink_box' is not possible"):
        make_stable_plan(START, wanted, rules(figures, require=True))


def test_no_room_without_falling_is_proven() -> None:
    start: Stacks = tuple((f"{color}_box", f"{color}_sphere") for color in ("red", "green", "blue"))
    figures = {name: Figure(name.split("_")[1]) for stack in start for name in stack}
    wanted = goal("red box on green box", start)
    assert make_plan(start, wanted).moves
    with pytest.raises(UnstableError, match="all others were searched"):
        make_stable_plan(start, wanted, rules(figures))


@settings(max_examples=60, deadline=None)
@given(seed=st.integers(0, 10**6))
def test_moves_that_the_arm_cannot_make_are_avoided_as_well(seed: int) -> None:
    figures, initial, wanted = random_problem(seed, (3, 4))
    rng = random.Random(seed)
    where = {(name, place): rng.random() < 0.15 for name in figures for place in range(3)}
    excluded = [
        Exclusion(name, target=place, onto=(), reason="a wall")
        for (name, place), wall in where.items()
        if wall
    ]

    def allowed(before: State, after: State) -> bool:
        block, support = placement(before, after)
        place = [block in stack for stack in after].index(True)
        return support is not None or not where[block, place]

    expected = best(figures, initial, wanted, allowed=allowed)
    if expected is None:
        with pytest.raises((UnstableError, ImpossibleError, ContradictoryGoalError)):
            make_stable_plan(initial, wanted, rules(figures), excluded)
        return
    found = make_stable_plan(initial, wanted, rules(figures), excluded)
    assert (len(found.unstable), len(found.moves)) == expected
    assert all(map(allowed, found.states, found.states[1:]))


def test_a_search_that_ends_early_does_not_let_anything_fall() -> None:
    wanted = goal("blue on stack0, green on stack1")
    start: Stacks = (("green_box",), ("blue_box",), ("pink_box", "red_sphere"))
    with pytest.raises(SearchLimitError, match="the shortest plan puts"):
        make_stable_plan(start, wanted, rules(FIGURES), max_expansions=6, algorithm="a_star")
