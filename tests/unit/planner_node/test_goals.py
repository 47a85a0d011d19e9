# SPDX-License-Identifier: Apache-2.0
from __future__ import annotations

import random

import pytest
from planner_states import NAMES, all_states, random_state, relation_holds

from planner_node.errors import GoalImageError
from planner_node.goals import Goal, complete_goal, goal_of_picture
from scene_graph import Relation

THREE = NAMES[:3]


def test_relations_mean_what_they_say() -> None:
    places = (*THREE, "stack0", "stack1", "stack2", "stack5")
    relations = [
        Relation(subject, predicate, object_)
        for subject in THREE
        for object_ in places
        for predicate in ("up", "above", "left")
        if predicate != "left" or object_ in THREE
    ]
    for state in all_states(THREE, 3):
        for relation in relations:
            assert Goal((relation,)).holds(state) == relation_holds(state, relation)


def test_a_goal_is_told_in_the_words_that_people_use() -> None:
    goal = Goal((Relation("red_box", "up", "blue_box"), Relation("red_box", "left", "green_box")))
    assert str(goal) == "red_box on blue_box, red_box left of green_box"


def test_a_complete_goal_holds_in_its_state_only() -> None:
    rng = random.Random(0)
    for _ in range(20):
        target = random_state(THREE, 3, rng)
        goal = complete_goal(target)
        assert [state for state in all_states(THREE, 3) if goal.holds(state)] == [target]
        assert goal.state(THREE, 3) == target


def test_a_partial_or_impossible_goal_has_no_single_state() -> None:
    red, green, blue = THREE
    on_base = Relation(red, "up", "stack0")
    assert Goal((on_base,)).state(THREE, 3) is None
    circle = (Relation(green, "up", blue), Relation(blue, "up", green))
    assert Goal((on_base, *circle)).state(THREE, 3) is None
    full = (on_base, Relation(green, "up", red), Relation(blue, "up", green))
    assert Goal(full).state(THREE, 3) == ((red, green, blue), (), ())
    assert Goal((*full, Relation(red, "left", blue))).state(THREE, 3) is None


def test_a_goal_speaks_of_blocks_not_of_places() -> None:
    assert Goal((Relation("red_box", "up", "stack0"),)).names == {"red_box"}


def test_a_picture_is_a_complete_goal() -> None:
    shown = (("red_box",), ("blue_box",), ())
    assert goal_of_picture(shown, (("red_box", "blue_box"), (), ())) == complete_goal(shown)


@pytest.mark.parametrize(
    ("shown", "sentences"),
    [
        (
            (("red_box",), ("pink_box",), ()),
            ("blue_box, green_box missing in the image", "pink_box not in the scene"),
        ),
        ((("red_box",), ("blue_box", "green_box")), ("shows 2 stacks", "scene has 3")),
    ],
)
def test_a_picture_of_something_else_is_no_goal(
    shown: tuple[tuple[str, ...], ...], sentences: tuple[str, ...]
) -> None:
    with pytest.raises(GoalImageError) as caught:
        goal_of_picture(shown, (("red_box", "blue_box"), ("green_box",), ()))
    assert all(sentence in str(caught.value) for sentence in sentences)
