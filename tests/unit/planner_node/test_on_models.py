# SPDX-License-Identifier: Apache-2.0
"""One search on any action model: it finds what brute force finds, whatever states are."""

from __future__ import annotations

from collections.abc import Callable, Sequence

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from planner_node.action_models import (
    ActionModel,
    AmbiguousTransitionError,
    ObservedModel,
    StacksModel,
    apply_to_graph,
)
from planner_node.search.code_distance import CodeDistanceAStar
from planner_node.search.on_models import (
    ModelPlan,
    NoModelPlanError,
    a_star_on,
    both_ends_on,
    breadth_first_on,
)
from scene_graph import Move, Stacks, all_moves, apply_move, up_relations

Search = Callable[[ActionModel[Stacks], Stacks, Stacks], ModelPlan[Stacks]]
SEARCHES: tuple[Search, ...] = (breadth_first_on, both_ends_on, a_star_on)
NAMES = ("red_box", "green_box", "blue_box", "yellow_box")


def random_state(rng: np.random.Generator, count: int) -> Stacks:
    stacks: list[list[str]] = [[], [], []]
    for name in rng.permutation(NAMES[:count]):
        stacks[rng.integers(3)].append(str(name))
    return tuple(map(tuple, stacks))


def distance(start: Stacks, goal: Stacks) -> int:
    """By Floyd-like growth of a set of states, with the other form of the rules."""
    reached, depth = {up_relations(start)}, 0
    while up_relations(goal) not in reached:
        grown = set(reached)
        for relations in reached:
            for move in all_moves(3):
                try:
                    grown.add(apply_to_graph(relations, move))
                except ValueError:
                    continue
        reached, depth = grown, depth + 1
    return depth


def observed(states: Sequence[Stacks]) -> list[tuple[Stacks, Move, Stacks]]:
    return [(s, m, apply_move(s, m)) for s in states for m in all_moves(3) if s[m.source]]


@settings(max_examples=20, deadline=None)
@given(seed=st.integers(0, 2**31), count=st.integers(1, 3))
def test_every_search_finds_a_shortest_plan(seed: int, count: int) -> None:
    rng = np.random.default_rng(seed)
    start, goal = random_state(rng, count), random_state(rng, count)
    for search in SEARCHES:
        plan = search(StacksModel(), start, goal)
        state = start
        for move, after in zip(plan.moves, plan.states[1:], strict=True):
            state = apply_move(state, move)
            assert state == after
        assert state == goal
        assert len(plan.moves) == distance(start, goal)


@pytest.mark.parametrize("search", SEARCHES)
def test_a_model_that_observed_everything_plans_like_the_rules(search: Search) -> None:
    start: Stacks = (("red_box", "green_box"), (), ())
    rules, states = StacksModel(), {start}
    while more := {s for o in rules.successors(list(states)) for _, s in o} - states:
        states |= more
    model = ObservedModel(observed(list(states)))
    for goal in states:
        assert len(search(model, start, goal).moves) == distance(start, goal)


@pytest.mark.parametrize("search", SEARCHES)
def test_a_goal_of_other_blocks_is_not_reached_and_the_search_ends(search: Search) -> None:
    with pytest.raises(NoModelPlanError) as caught:
        search(StacksModel(), (("red_box",), (), ()), (("blue_box",), (), ()))
    assert caught.value.exhausted


def test_a_search_gives_up_at_its_bound() -> None:
    start: Stacks = ((NAMES), (), ())
    goal: Stacks = ((), (), tuple(reversed(NAMES)))
    with pytest.raises(NoModelPlanError, match="allow more") as caught:
        breadth_first_on(StacksModel(), start, (("pink_box",), *goal[1:]), 30)
    assert not caught.value.exhausted


def test_a_star_with_a_bound_on_what_is_left_stays_shortest_and_asks_less() -> None:
    start: Stacks = (NAMES, (), ())
    goal: Stacks = ((), tuple(reversed(NAMES)), ())

    def elsewhere(state: Stacks) -> int:
        return sum(name not in goal[1] or name not in state[1] for name in NAMES)

    blind = a_star_on(StacksModel(), start, goal)
    told = a_star_on(StacksModel(), start, goal, moves_left=elsewhere)
    assert len(told.moves) == len(blind.moves) == 4
    assert told.expanded < blind.expanded


def test_codes_are_searched_by_how_many_bits_differ_from_the_goal() -> None:
    """One move turns one of eight bits; only the first six can be turned back and forth."""
    moves = all_moves(3)
    table = [
        (bytes([s]), moves[bit], bytes([s ^ (1 << bit)])) for s in range(64) for bit in range(6)
    ]
    model = ObservedModel(table)
    informed = CodeDistanceAStar(1)(model, b"\x00", b"\x07")
    blind = breadth_first_on(model, b"\x00", b"\x07")
    assert len(informed.moves) == len(blind.moves) == 3
    assert informed.expanded < blind.expanded
    with pytest.raises(ValueError, match="one or more"):
        CodeDistanceAStar(0)


def test_states_that_share_a_code_are_refused() -> None:
    with pytest.raises(AmbiguousTransitionError, match="share a code"):
        ObservedModel([(b"a", Move(0, 1), b"b"), (b"a", Move(0, 1), b"c")])


def test_a_code_of_no_state_is_taken_for_the_one_state_most_like_it() -> None:
    codes = [b"\x00\x00", b"\x0f\x0f", b"\xf0\xf0"]
    model = ObservedModel((codes[i], Move(0, 1), codes[(i + 1) % 3]) for i in range(3))
    for code in codes:
        assert model.nearest(code) == code
        turned = bytes([code[0] ^ 0b00011000, code[1]])
        assert model.nearest(turned) == code
    between = b"\x0f\x00"
    assert model.nearest(between) == between
    assert ObservedModel[bytes](()).nearest(b"\x01") == b"\x01"
