# SPDX-License-Identifier: Apache-2.0
from __future__ import annotations

from collections.abc import Iterable

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from planner_states import NAMES, all_states, relation_holds, relations_between

from planner_node.errors import ContradictoryGoalError
from planner_node.goals import (
    Goal,
    check_contradictions,
    find_contradiction,
    parse_goal,
    resolve_goal,
)
from planner_node.search import make_plan
from scene_graph import Relation

FOUR = NAMES[:4]
STATES = {stack_count: list(all_states(FOUR, stack_count)) for stack_count in (1, 2, 3)}


def check(text: str, stack_count: int = 3) -> None:
    check_contradictions(resolve_goal(parse_goal(text), FOUR), stack_count)


@pytest.mark.parametrize(
    ("text", "stack_count", "sentence"),
    [
        ("red on red", 3, "red_box cannot be on itself"),
        ("red left of red", 3, "red_box cannot be left of itself"),
        ("red below red", 3, "red_box cannot be above itself"),
        ("red below blue, red above blue", 3, "above itself"),
        ("stack0 below red, red on stack1", 3, "stack0 and stack1 would have to be one stack"),
        ("red on blue, blue on red", 3, "above itself"),
        ("red above blue, blue above green, green above red", 3, "above itself"),
        ("red on blue, red on green", 3, "directly on both blue_box and green_box"),
        ("red on blue, red on stack0", 3, "directly on both blue_box and stack0"),
        ("red on blue, green on blue", 3, "red_box and green_box cannot both stand"),
        ("red on stack1, green on stack1", 3, "red_box and green_box cannot both stand"),
        ("red on stack0, red above stack1", 3, "stack0 and stack1 would have to be one stack"),
        ("red on blue, red above stack0, blue above stack1", 3, "have to be one stack"),
        ("red left of blue, blue left of green", 2, "there are only 2 stacks"),
        ("red left of blue, blue left of green, green left of yellow", 3, "only 3 stacks"),
        ("red left of blue, blue left of red", 3, "would have to be left of itself"),
        ("red left of blue, red on blue", 3, "in one stack and apart"),
        ("red left of blue, red above green, blue above green", 3, "in one stack and apart"),
        ("red on stack2, red left of blue", 3, "there are only 3 stacks"),
        ("red on stack7", 3, "stack7 does not exist; there are stack0, stack1, stack2"),
        ("stack0 on red", 3, "stack0 is a place, it cannot be moved"),
        ("red on stack0, red above blue", 3, "the lowest place of its stack"),
        ("red on blue, green above blue, red above green", 3, "above itself"),
        ("red on stack0, red above green, blue above red", 3, "the lowest place of its stack"),
    ],
)
def test_contradictions_are_named(text: str, stack_count: int, sentence: str) -> None:
    with pytest.raises(ContradictoryGoalError, match=sentence):
        check(text, stack_count)


@pytest.mark.parametrize(
    "text",
    [
        "red on blue",
        "red on blue, red above blue",
        "red above blue, red above green",
        "red on blue, green above red, blue above yellow",
        "red left of blue, blue left of green, yellow on green",
        "red left of blue, red left of green",
        "red on stack0, blue in stack0, blue above red",
    ],
)
def test_what_can_be_built_is_no_contradiction(text: str) -> None:
    check(text)


def test_only_the_relations_that_exclude_one_another_are_named() -> None:
    with pytest.raises(ContradictoryGoalError) as caught:
        check("yellow left of red, red on blue, blue on green, green above red, yellow on stack0")
    assert caught.value.relations == (
        "red_box on blue_box",
        "blue_box on green_box",
        "green_box above red_box",
    )
    assert "green_box above red_box" in str(caught.value)


RELATIONS = relations_between(FOUR, ("stack0", "stack1", "stack2"))


@settings(max_examples=300)
@given(st.lists(RELATIONS, min_size=1, max_size=6), st.sampled_from((1, 2, 3)))
def test_nothing_that_some_state_fulfils_is_called_contradictory(
    relations: list[Relation], stack_count: int
) -> None:
    if find_contradiction(relations, stack_count) is None:
        return
    for state in STATES[stack_count]:
        assert not all(relation_holds(state, item) for item in relations)


def possible(relations: Iterable[Relation]) -> bool:
    wanted = list(relations)
    return any(all(relation_holds(state, item) for item in wanted) for state in STATES[3])


@settings(max_examples=100)
@given(st.lists(RELATIONS, min_size=1, max_size=6, unique=True))
def test_whatever_cannot_be_is_refused_with_a_smallest_choice_of_what_excludes_itself(
    relations: list[Relation],
) -> None:
    goal = Goal(tuple(relations))
    if possible(relations):
        make_plan(STATES[3][0], goal)
        return
    with pytest.raises(ContradictoryGoalError) as caught:
        make_plan(STATES[3][0], goal)
    named = [item for item in relations if item.words in caught.value.relations]
    assert len(named) == len(caught.value.relations)
    assert not possible(named)
    for item in named:
        assert possible(other for other in named if other != item)


@settings(max_examples=100)
@given(st.lists(RELATIONS, min_size=1, max_size=6))
def test_the_named_relations_exclude_one_another_by_themselves(
    relations: list[Relation],
) -> None:
    try:
        check_contradictions(Goal(tuple(dict.fromkeys(relations))), 3)
    except ContradictoryGoalError as error:
        named = [item for item in relations if item.words in error.relations]
        assert find_contradiction(named, 3) is not None
        for item in set(named):
            assert find_contradiction([other for other in named if other != item], 3) is None
