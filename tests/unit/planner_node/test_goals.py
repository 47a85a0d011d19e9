# SPDX-License-Identifier: Apache-2.0
from __future__ import annotations

import random

from planner_states import NAMES, all_states, random_state, relation_holds

from planner_node.goals import ABOVE, LEFT_OF, ON, Goal, GoalRelation, complete_goal
from scene_graph import up_relations

THREE = NAMES[:3]


def test_relations_mean_what_they_say() -> None:
    places = (*THREE, "stack0", "stack1", "stack2", "stack5")
    for state in all_states(THREE, 3):
        for subject in THREE:
            for object_ in places:
                for predicate in (ON, ABOVE, LEFT_OF):
                    if predicate == LEFT_OF and object_ not in THREE:
                        continue
                    expected = relation_holds(state, subject, predicate, object_)
                    assert GoalRelation(subject, predicate, object_).holds(state) == expected


def test_a_complete_goal_holds_in_its_state_only() -> None:
    rng = random.Random(0)
    for _ in range(20):
        target = random_state(THREE, 3, rng)
        goal = complete_goal(target)
        assert [state for state in all_states(THREE, 3) if goal.holds(state)] == [target]
        assert goal.state(THREE, 3) == target


def test_a_partial_or_impossible_goal_has_no_single_state() -> None:
    red, green, blue = THREE
    on_base = GoalRelation(red, ON, "stack0")
    assert Goal((on_base,)).state(THREE, 3) is None
    circle = (GoalRelation(green, ON, blue), GoalRelation(blue, ON, green))
    assert Goal((on_base, *circle)).state(THREE, 3) is None
    full = (on_base, GoalRelation(green, ON, red), GoalRelation(blue, ON, green))
    assert Goal(full).state(THREE, 3) == ((red, green, blue), (), ())
    assert Goal((*full, GoalRelation(red, LEFT_OF, blue))).state(THREE, 3) is None


def test_above_becomes_the_chain_of_relations_in_the_scene() -> None:
    red, green, blue = THREE
    state = ((red, green, blue), (), ())
    goal = Goal((GoalRelation(blue, ABOVE, red),))
    assert {str(item) for item in goal.witnesses(state)} == {
        "blue_box up green_box",
        "green_box up red_box",
    }
    assert complete_goal(state).witnesses(state) == up_relations(state)


def test_a_goal_speaks_of_blocks_not_of_places() -> None:
    assert Goal((GoalRelation("red_box", ON, "stack0"),)).names == {"red_box"}
