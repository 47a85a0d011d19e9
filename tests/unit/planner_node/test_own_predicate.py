# SPDX-License-Identifier: Apache-2.0
"""A predicate that a user adds is asked for, planned for and told like those that are there."""

from __future__ import annotations

import random
from collections.abc import Iterator
from itertools import pairwise

import pytest
from planner_states import NAMES, distance, random_state

from planner_node import ALGORITHMS, make_plan, parse_goal, resolve_goal
from planner_node.errors import InvalidGoalError
from planner_node.goals import check_contradictions
from scene_graph import PREDICATES, Predicate, Stacks


@pytest.fixture(autouse=True)
def next_to() -> Iterator[None]:
    PREDICATES.add(
        Predicate(
            "beside",
            lambda subject, object_: abs(subject.stack - object_.stack) == 1,
            phrases=("right beside", "beside"),
            inverse_phrases=("has beside it",),
            takes_place=False,
        )
    )
    yield
    PREDICATES.remove("beside")


def are_neighbours(state: Stacks, first: str, second: str) -> bool:
    return any(
        {first, second} & set(one) and {first, second} & set(other)
        for one, other in pairwise(state)
        if not {first, second} <= set(one) and not {first, second} <= set(other)
    )


def test_it_is_parsed_and_told() -> None:
    goal = resolve_goal(parse_goal("red is right beside blue, blue has beside it green"), NAMES)
    assert str(goal) == "red_box right beside blue_box, green_box right beside blue_box"


def test_it_is_among_the_known_ones_and_refuses_places() -> None:
    with pytest.raises(InvalidGoalError, match="right of, right beside, has beside it"):
        parse_goal("make a tower")
    with pytest.raises(InvalidGoalError, match="'beside' relates two blocks"):
        parse_goal("red beside stack0")


@pytest.mark.parametrize("algorithm", ALGORITHMS)
@pytest.mark.parametrize("seed", range(10))
def test_it_is_planned_for_by_every_algorithm(algorithm: str, seed: int) -> None:
    initial = random_state(NAMES[:4], 3, random.Random(seed))
    goal = resolve_goal(parse_goal("red beside green, blue on red"), NAMES[:4])
    found = make_plan(initial, goal, algorithm=algorithm)

    def holds(state: Stacks) -> bool:
        on = any(pair == ("red_box", "blue_box") for stack in state for pair in pairwise(stack))
        return on and are_neighbours(state, "red_box", "green_box")

    assert len(found.moves) == distance(initial, holds)
    assert holds(found.states[-1])


def test_nothing_is_said_about_what_it_excludes() -> None:
    goal = resolve_goal(parse_goal("red beside blue, red on blue, red beside red"), NAMES)
    check_contradictions(goal, 3)
