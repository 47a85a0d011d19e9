# SPDX-License-Identifier: Apache-2.0
"""What goes out as PDDL is the problem that was asked: a planner for any PDDL solves it alike."""

from __future__ import annotations

import random
from dataclasses import replace

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from pddl_reader import Task
from planner_states import NAMES, distance, random_state, relation_holds, relations_between

from planner_node import Figure, Stability
from planner_node.errors import ImpossibleError, UnknownObjectError, UnreachableError
from planner_node.goals import Count, Goal, complete_goal
from planner_node.search.peers.given_plan import checked_plan
from planner_node.search.peers.pddl import pddl_of
from planner_node.search.possible import Exclusion, plan_avoiding
from planner_node.search.stable import make_stable_plan
from scene_graph import BOX, PREDICATES, SPHERE, Predicate, Relation, Spot, Stacks

THREE = NAMES[:3]


@st.composite
def problems(draw: st.DrawFn) -> tuple[Stacks, Goal]:
    """Three blocks on two or three places, and any goal, often an impossible one."""
    places = draw(st.sampled_from((2, 3)))
    initial = random_state(THREE, places, random.Random(draw(st.integers(0, 10_000))))
    bases = tuple(f"stack{index}" for index in range(places))
    one = relations_between(THREE, bases)
    relations = draw(st.lists(one, min_size=1, max_size=3, unique=True))
    if not draw(st.booleans()):
        return initial, Goal(tuple(relations))
    counted = tuple(draw(st.lists(one, min_size=2, max_size=3, unique=True)))
    least = draw(st.integers(0, len(counted)))
    count = Count("a number of them", counted, least, draw(st.integers(least, len(counted))))
    return initial, Goal(tuple(relations[1:]), (count,))


def holds(goal: Goal, state: Stacks) -> bool:
    counts = all(
        item.least <= sum(relation_holds(state, one) for one in item.relations) <= item.most
        for item in goal.counts
    )
    return counts and all(relation_holds(state, item) for item in goal.relations)


@settings(max_examples=40, deadline=None)
@given(problems())
def test_any_goal_is_solved_with_as_few_moves(problem: tuple[Stacks, Goal]) -> None:
    initial, goal = problem
    told = pddl_of(initial, goal)
    task = Task(told.domain, told.problem)
    assert task.requirements == [":strips", ":typing"]
    found = task.cheapest()
    shortest = distance(initial, lambda state: holds(goal, state))
    if shortest is None:
        assert found is None
        return
    assert found is not None
    steps = found[1]
    assert sum(step[0] == "move" for step in steps) == shortest
    plan = checked_plan("\n".join(f"({' '.join(step)})" for step in steps), initial, goal)
    assert len(plan.moves) == shortest
    assert holds(goal, plan.states[-1])


@pytest.mark.parametrize("seed", range(6))
def test_a_complete_goal_needs_nothing_but_moves(seed: int) -> None:
    rng = random.Random(seed)
    initial, target = random_state(NAMES[:4], 3, rng), random_state(NAMES[:4], 3, rng)
    told = pddl_of(initial, complete_goal(target))
    found = Task(told.domain, told.problem).cheapest()
    assert found is not None
    assert {step[0] for step in found[1]} <= {"move"}
    assert found[0] == distance(initial, lambda state: state == target)


def test_a_predicate_of_ones_own_goes_out_too() -> None:
    def level(subject: Spot, object_: Spot) -> bool:
        return subject.stack != object_.stack and subject.level == object_.level

    initial: Stacks = (("red_box", "green_box"), (), ("blue_box",))
    PREDICATES.add(Predicate("level", level, phrases=("level with",), takes_place=False))
    try:
        goal = Goal((Relation("green_box", "level", "blue_box"),))
        told = pddl_of(initial, goal)
        found = Task(told.domain, told.problem).cheapest()
    finally:
        PREDICATES.remove("level")
    assert found is not None
    assert [step for step in found[1] if step[0] == "move"] == [
        ("move", "green_box", "red_box", "stack1")
    ]


FIGURES = {
    "red_box": Figure(BOX, 0.04, 0.04),
    "blue_box": Figure(BOX, 0.08, 0.08),
    "green_box": Figure(SPHERE, 0.04, 0.04),
}


@pytest.mark.parametrize("require", [False, True])
@pytest.mark.parametrize("seed", range(8))
def test_what_is_unstable_is_left_out_or_costs_more(seed: int, require: bool) -> None:
    rng = random.Random(seed)
    initial, target = random_state(THREE, 2, rng), random_state(THREE, 2, rng)
    goal, stability = complete_goal(target), Stability(FIGURES, require)
    told = pddl_of(initial, goal, stability)
    found = Task(told.domain, told.problem).cheapest()
    ways = [] if found is None else [step for step in found[1] if step[0] == "move"]
    try:
        ours = make_stable_plan(initial, goal, stability)
    except UnreachableError:
        assert found is None
        return
    assert found is not None
    assert len(ways) == len(ours.moves)
    text = "\n".join(f"({' '.join(step)})" for step in ways)
    assert len(checked_plan(text, initial, goal, stability).unstable) == len(ours.unstable)


@pytest.mark.parametrize("seed", range(8))
def test_moves_that_the_arm_cannot_make_are_left_out(seed: int) -> None:
    rng = random.Random(seed)
    initial, target = random_state(THREE, 3, rng), random_state(THREE, 3, rng)
    goal = complete_goal(target)
    exclusions: list[Exclusion] = []
    for _ in range(4):  # each time the first move of what would be done
        try:
            ours = plan_avoiding(initial, goal, exclusions)
        except ImpossibleError:
            ours = None
        told = pddl_of(initial, goal, exclusions=exclusions)
        found = Task(told.domain, told.problem).cheapest()
        assert (found is None) == (ours is None)
        if ours is None or found is None or not ours.moves:
            return
        assert found[0] == len(ours.moves)
        move, state = ours.moves[0], ours.states[0]
        block, under = state[move.source][-1], state[move.source][:-1]
        every = Exclusion(block, move.source, under, move.target, state[move.target])
        exclusions.append(replace(every, state=state if rng.random() < 0.5 else None))


def test_names_that_pddl_cannot_have_get_others() -> None:
    initial: Stacks = (("Rote Kiste", "rote-kiste", "7", "spot-1-1"), (), ())
    told = pddl_of(initial, Goal((Relation("7", "up", "stack1"),)))
    found = Task(told.domain, told.problem).cheapest()
    assert found is not None
    text = "\n".join(f"({' '.join(step)})" for step in found[1])
    assert len(checked_plan(text, initial, Goal((Relation("7", "up", "stack1"),))).moves) == 2
    assert set(told.names.values()) == {*initial[0], "stack0", "stack1", "stack2"}


def test_what_is_not_there_is_named() -> None:
    with pytest.raises(UnknownObjectError, match="no pink_box; there are red_box"):
        pddl_of((("red_box",), ()), Goal((Relation("pink_box", "up", "red_box"),)))
