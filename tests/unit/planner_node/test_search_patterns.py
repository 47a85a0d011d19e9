# SPDX-License-Identifier: Apache-2.0
"""Search by patterns against brute force, and the laws that every plan keeps."""

from __future__ import annotations

import random
from functools import cache

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from planner_states import (
    NAMES,
    all_states,
    distance,
    neighbours,
    random_state,
    relation_holds,
    relations_between,
)

from planner_node.errors import UnreachableError
from planner_node.goals import Goal, complete_goal
from planner_node.search import Limits, Problem, make_plan, patterns_first, search
from planner_node.search.patterns import pattern_count, pattern_space
from planner_node.search.patterns_first import patterns_a_star
from scene_graph import (
    Move,
    Relation,
    Stacks,
    apply_move,
    left_relations,
    stacks_from_relations,
    up_relations,
)


@cache
def distances_from(initial: Stacks) -> dict[Stacks, int]:
    """Of every state, by brute force."""
    found, layer = {initial: 0}, [initial]
    while layer:
        following = []
        for state in layer:
            for after in neighbours(state):
                if after not in found:
                    found[after] = found[state] + 1
                    following.append(after)
        layer = following
    return found


def true_relations(state: Stacks) -> list[Relation]:
    names = [name for stack in state for name in stack]
    bases = [f"stack{place}" for place in range(len(state))]
    every = [
        Relation(one, predicate, other)
        for one in names
        for predicate in ("up", "above", "left")
        for other in (names if predicate == "left" else [*names, *bases])
    ]
    return [item for item in every if relation_holds(state, item)]


@pytest.mark.parametrize("places", [3, 4])
@settings(max_examples=60, deadline=None)
@given(seed=st.integers(0, 5), goal_seed=st.integers(0, 10_000), count=st.integers(1, 6))
def test_a_plan_for_some_relations_of_a_state_is_shortest(
    places: int, seed: int, goal_seed: int, count: int
) -> None:
    names = NAMES[:5]
    initial = random_state(names, places, random.Random(seed))
    rng = random.Random(goal_seed)
    told = true_relations(random_state(names, places, rng))
    goal = Goal(tuple(rng.sample(told, min(count, len(told)))))
    away = distances_from(initial)
    least = min(
        moves
        for state, moves in away.items()
        if all(relation_holds(state, item) for item in goal.relations)
    )
    assert len(make_plan(initial, goal).moves) == least


@pytest.mark.parametrize("seed", range(12))
def test_six_blocks_are_arranged_with_the_fewest_moves(seed: int) -> None:
    rng = random.Random(seed)
    initial, target = random_state(NAMES, 3, rng), random_state(NAMES, 3, rng)
    least = distance(initial, lambda state: state == target)
    for algorithm in ("patterns", "both_ends"):
        assert len(make_plan(initial, complete_goal(target), algorithm=algorithm).moves) == least


@pytest.mark.parametrize("seed", range(6))
def test_several_groups_give_the_length_that_other_algorithms_give(seed: int) -> None:
    rng = random.Random(seed)
    names = tuple(f"block{index}" for index in range(8))
    initial, target = random_state(names, 3, rng), random_state(names, 3, rng)
    for goal in (complete_goal(target), Goal(tuple(rng.sample(true_relations(target), 7)))):
        found = make_plan(initial, goal)
        assert len(found.moves) == len(make_plan(initial, goal, algorithm="a_star").moves)


@settings(max_examples=100, deadline=None)
@given(seed=st.integers(0, 10_000), count=st.integers(0, 5))
def test_a_part_of_a_goal_never_takes_longer_than_the_whole(seed: int, count: int) -> None:
    rng = random.Random(seed)
    names = tuple(f"block{index}" for index in range(7))
    initial, target = random_state(names, 3, rng), random_state(names, 3, rng)
    whole = complete_goal(target)
    part = Goal(tuple(rng.sample(whole.relations, count)))
    assert len(make_plan(initial, part).moves) <= len(make_plan(initial, whole).moves)


@settings(max_examples=100)
@given(seed=st.integers(0, 10_000))
def test_a_move_and_its_inverse_give_the_state_back(seed: int) -> None:
    rng = random.Random(seed)
    state = random_state(NAMES, 3, rng)
    source = rng.choice([place for place in range(3) if state[place]])
    target = rng.choice([place for place in range(3) if place != source])
    after = apply_move(state, Move(source, target))
    assert apply_move(after, Move(target, source)) == state


@settings(max_examples=100)
@given(seed=st.integers(0, 10_000))
def test_relations_give_the_stacks_that_they_were_read_from(seed: int) -> None:
    state = random_state(NAMES, 4, random.Random(seed))
    relations = up_relations(state) | left_relations(state)
    assert stacks_from_relations(relations, 4) == state
    assert up_relations(stacks_from_relations(relations, 4)) == up_relations(state)


@settings(max_examples=60, deadline=None)
@given(
    seed=st.integers(0, 100),
    relations=st.lists(
        relations_between(NAMES[:5], ("stack0", "stack1", "stack2")),
        min_size=2,
        max_size=6,
        unique=True,
    ),
)
def test_what_is_called_impossible_holds_in_no_state(seed: int, relations: list[Relation]) -> None:
    initial = random_state(NAMES[:5], 3, random.Random(seed))
    possible = any(
        all(relation_holds(state, item) for item in relations) for state in all_states(NAMES[:5], 3)
    )
    try:
        found = search(initial, Goal(tuple(relations)))
    except UnreachableError:
        assert not possible
    else:
        assert all(relation_holds(found.states[-1], item) for item in relations)


@pytest.mark.parametrize(("places", "named", "like"), [(3, 4, 0), (4, 3, 0), (3, 2, 2), (3, 0, 3)])
def test_patterns_are_all_arrangements(places: int, named: int, like: int) -> None:
    names = [*(str(index) for index in range(named)), *"x" * like]
    every = {
        tuple("".join("x" if name >= str(named) else name for name in stack) for stack in state)
        for state in all_states(tuple(str(index) for index in range(len(names))), places)
    }
    space = pattern_space(places, named, like)
    assert len(space) == pattern_count(places, named + like, like) == len(every)
    assert len(set(space.keys.tolist())) == len(space)
    shown = {
        tuple(
            "".join("x" if symbol == named else str(symbol) for symbol in stack)
            for stack in space.packing.stacks(key)
        )
        for key in space.keys.tolist()
    }
    if named:
        assert shown == every


@pytest.mark.parametrize("places", [3, 4, 5])
@pytest.mark.parametrize("seed", range(8))
def test_state_by_state_and_plainly_from_both_ends_plans_are_as_short(
    places: int, seed: int
) -> None:
    rng = random.Random(seed)
    names = tuple(f"block{index}" for index in range(7))
    initial, target = random_state(names, places, rng), random_state(names, places, rng)
    goal = complete_goal(target)
    limits = Limits(initial, goal)
    path = patterns_a_star(Problem(initial, goal), limits)
    assert len(path) - 1 == len(make_plan(initial, goal, algorithm="both_ends").moves)
    assert limits.expanded > 0


def test_where_it_takes_long_state_by_state_the_rest_is_done_in_layers(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    monkeypatch.setattr(patterns_first, "MOST_EXPANSIONS", 3)
    rng = random.Random(1)
    names = tuple(f"block{index}" for index in range(7))
    initial, target = random_state(names, 3, rng), random_state(names, 3, rng)
    found = make_plan(initial, complete_goal(target))
    assert found.expanded > 3
    shortest = make_plan(initial, complete_goal(target), algorithm="both_ends")
    assert len(found.moves) == len(shortest.moves)
