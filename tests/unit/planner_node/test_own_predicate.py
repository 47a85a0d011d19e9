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
def far_from() -> Iterator[None]:
    PREDICATES.add(
        Predicate(
            "far",
            lambda subject, object_: abs(subject.stack - object_.stack) >= 2,
            phrases=("right away from", "away from"),
            inverse_phrases=("has away from it",),
            takes_place=False,
        )
    )
    yield
    PREDICATES.remove("far")


def are_apart(state: Stacks, first: str, second: str) -> bool:
    """On three places: at both ends."""
    return {first, second} & set(state[0]) != set() != {first, second} & set(state[2])


def test_it_is_parsed_and_told() -> None:
    goal = resolve_goal(
        parse_goal("red is right away from blue, blue has away from it green"), NAMES
    )
    assert str(goal) == "red_box right away from blue_box, green_box right away from blue_box"


def test_it_is_among_the_known_ones_and_refuses_places() -> None:
    with pytest.raises(InvalidGoalError, match="next to, right away from, has away from it"):
        parse_goal("make a tower")
    with pytest.raises(InvalidGoalError, match="'away from' relates two blocks"):
        parse_goal("red away from stack0")


@pytest.mark.parametrize("algorithm", ALGORITHMS)
@pytest.mark.parametrize("seed", range(10))
def test_it_is_planned_for_by_every_algorithm(algorithm: str, seed: int) -> None:
    initial = random_state(NAMES[:4], 3, random.Random(seed))
    goal = resolve_goal(parse_goal("red away from green, blue on red"), NAMES[:4])
    found = make_plan(initial, goal, algorithm=algorithm)

    def holds(state: Stacks) -> bool:
        on = any(pair == ("red_box", "blue_box") for stack in state for pair in pairwise(stack))
        return on and are_apart(state, "red_box", "green_box")

    assert len(found.moves) == distance(initial, holds)
    assert holds(found.states[-1])


def test_nothing_is_said_about_what_it_excludes() -> None:
    goal = resolve_goal(parse_goal("red away from blue, red on blue, red away from red"), NAMES)
    check_contradictions(goal, 3)
