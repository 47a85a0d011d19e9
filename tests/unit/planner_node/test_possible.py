# SPDX-License-Identifier: Apache-2.0
"""Plans without excluded moves, by brute force over all sequences of moves."""

from __future__ import annotations

from collections import deque

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from planner_node.errors import ImpossibleError
from planner_node.goals import Goal, parse_goal, resolve_goal
from planner_node.search import make_plan
from planner_node.search.possible import Exclusion, plan_avoiding
from scene_graph import Stacks, all_moves, apply_move

START: Stacks = (("red_box", "blue_box"), ("green_box",), ())


def goal(text: str, stacks: Stacks = START) -> Goal:
    return resolve_goal(parse_goal(text), [name for stack in stacks for name in stack])


def shortest(start: Stacks, wanted: Goal, excluded: list[Exclusion]) -> int | None:
    """Length of a shortest plan, breadth first over stacks of names; None: there is none."""
    seen, queue = {start}, deque([(start, 0)])
    while queue:
        state, depth = queue.popleft()
        if wanted.holds(state):
            return depth
        for move in all_moves(len(state)):
            if state[move.source] and not any(item.forbids(state, move) for item in excluded):
                after = apply_move(state, move)
                if after not in seen:
                    seen.add(after)
                    queue.append((after, depth + 1))
    return None


def random_exclusion(rng: np.random.Generator, start: Stacks) -> Exclusion:
    """One that a random walk meets."""
    state = start
    for _ in range(int(rng.integers(0, 5))):
        moves = [move for move in all_moves(len(state)) if state[move.source]]
        state = apply_move(state, moves[rng.integers(len(moves))])
    moves = [move for move in all_moves(len(state)) if state[move.source]]
    move = moves[rng.integers(len(moves))]
    block, under = state[move.source][-1], state[move.source][:-1]
    onto = state[move.target]
    kinds = [
        Exclusion(block, source=move.source, under=under),
        Exclusion(block, target=move.target, onto=onto),
        Exclusion(block, move.source, under, move.target, onto),
        Exclusion(block, move.source, under, move.target, onto, state),
    ]
    return kinds[rng.integers(4)]


@settings(max_examples=60, deadline=None)
@given(seed=st.integers(0, 10_000))
def test_plans_are_shortest_among_those_that_are_left(seed: int) -> None:
    rng = np.random.default_rng(seed)
    excluded = [random_exclusion(rng, START) for _ in range(int(rng.integers(1, 12)))]
    wanted = goal(["red on green", "blue on stack2", "green on red, red on blue"][rng.integers(3)])
    length = shortest(START, wanted, excluded)
    if length is None:
        with pytest.raises(ImpossibleError) as failure:
            plan_avoiding(START, wanted, excluded)
        assert failure.value.excluded
        return
    found = plan_avoiding(START, wanted, excluded)
    assert len(found.moves) == length
    assert wanted.holds(found.states[-1])
    for state, move in zip(found.states, found.moves):
        assert not any(item.forbids(state, move) for item in excluded)


def test_without_exclusions_it_is_the_ordinary_length() -> None:
    wanted = goal("red on green, blue on red")
    assert len(plan_avoiding(START, wanted, []).moves) == len(make_plan(START, wanted).moves)


def test_an_impossible_goal_is_told_with_what_is_excluded_and_why() -> None:
    reason = "clearance of hand to wall, 12 mm missing (pose of the place)"
    excluded = [
        Exclusion(block, target=2, onto=(), reason=reason)
        for block in ("red_box", "blue_box", "green_box")
    ]
    with pytest.raises(ImpossibleError) as failure:
        plan_avoiding(START, goal("red on stack2"), excluded)
    assert f"red_box cannot be put on stack2: {reason}" in str(failure.value)
    assert failure.value.status == "MOTION_FAILED"


@pytest.mark.parametrize(
    ("exclusion", "words"),
    [
        (Exclusion("red_box", source=0, under=("blue_box",), reason="r"),
         "red_box cannot be taken from blue_box on stack0: r"),
        (Exclusion("red_box", 0, (), 1, ("blue_box",), reason="r"),
         "red_box cannot be moved from stack0 to blue_box on stack1: r"),
        (Exclusion("red_box", 0, (), 1, (), (("red_box",), ()), "r"),
         "red_box cannot be moved from stack0 to stack1 in [red_box | -]: r"),
    ],
)  # fmt: skip
def test_exclusions_read_as_sentences(exclusion: Exclusion, words: str) -> None:
    assert str(exclusion) == words
