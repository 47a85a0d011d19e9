# SPDX-License-Identifier: Apache-2.0
"""No plan is shorter than what parts of the blocks need: brute force and exact search say so."""

from __future__ import annotations

import random

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from planner_states import NAMES, distance, random_state

from planner_node.errors import SearchCancelledError
from planner_node.goals import complete_goal
from planner_node.search import Limits, make_plan, part_bounds
from planner_node.search.part_bounds import PartBounds
from scene_graph import Stacks

MANY = 10**7


def ends(names: tuple[str, ...], places: int, seed: int) -> tuple[Stacks, Stacks]:
    rng = random.Random(seed)
    return random_state(names, places, rng), random_state(names, places, rng)


def table(places: int, size: int) -> int:
    """What makes groups of that size."""
    return part_bounds.pattern_count(places, size, 0) * places * (places - 1)


@given(
    places=st.integers(3, 4), size=st.integers(1, 4), blocks=st.integers(2, 5), seed=st.integers(0)
)
@settings(max_examples=60, deadline=None)
def test_no_plan_is_shorter(places: int, size: int, blocks: int, seed: int) -> None:
    initial, target = ends(NAMES[:blocks], places, seed)
    limits = Limits(initial, complete_goal(target))
    shortest = distance(initial, lambda state: state == target)
    assert shortest is not None
    with pytest.MonkeyPatch.context() as patch:
        patch.setattr(part_bounds, "TABLE", table(places, size))
        bounds = PartBounds(initial, target, limits)
        before = bounds.least
        assert before <= shortest
        bounds.raise_to(MANY, MANY, limits)
        assert before <= bounds.least <= shortest
        # Up to three groups are one part, which is searched to the end.
        if -(-blocks // size) <= 3:
            assert bounds.least == shortest


@pytest.mark.parametrize(
    ("blocks", "places", "size"), [(10, 3, 8), (9, 3, 4), (10, 4, 4), (9, 5, 6)]
)
@pytest.mark.parametrize("seed", range(4))
def test_one_part_of_all_blocks_needs_a_shortest_plan(
    monkeypatch: pytest.MonkeyPatch, blocks: int, places: int, size: int, seed: int
) -> None:
    monkeypatch.setattr(part_bounds, "TABLE", table(places, size))
    initial, target = ends(tuple(f"block{index}" for index in range(blocks)), places, seed)
    goal = complete_goal(target)
    limits = Limits(initial, goal, MANY)
    bounds = PartBounds(initial, target, limits)
    bounds.raise_to(MANY, MANY, limits)
    assert bounds.least == len(make_plan(initial, goal, MANY, algorithm="patterns").moves)


def test_it_is_raised_as_far_as_is_enough_and_as_it_may_be() -> None:
    initial, target = ends(tuple(f"block{index:02}" for index in range(20)), 3, 0)
    limits = Limits(initial, complete_goal(target), MANY)
    bounds = PartBounds(initial, target, limits)
    first = bounds.least
    bounds.raise_to(first, MANY, limits)
    assert (bounds.least, limits.expanded) == (first, 0)
    bounds.raise_to(first + 1, MANY, limits)
    assert bounds.least == first + 1
    few = 2 * part_bounds.CHUNK
    before = limits.expanded
    bounds.raise_to(MANY, few, limits)
    assert limits.expanded == before + few


def test_it_is_cancelled() -> None:
    initial, target = ends(tuple(f"block{index:02}" for index in range(20)), 3, 0)
    polls = 0

    def cancelled() -> bool:
        nonlocal polls
        polls += 1
        return polls > 5

    goal = complete_goal(target)
    bounds = PartBounds(initial, target, Limits(initial, goal))
    with pytest.raises(SearchCancelledError):
        bounds.raise_to(MANY, MANY, Limits(initial, goal, MANY, cancelled))
    assert polls == 6


@pytest.mark.parametrize(("places", "blocks"), [(2, 20), (17, 20), (3, 65)])
def test_what_there_is_no_room_for_is_told(places: int, blocks: int) -> None:
    assert not PartBounds.possible(places, blocks)
    assert PartBounds.possible(16, 64)
