# SPDX-License-Identifier: Apache-2.0
"""A goal in a scene of which some colours are in doubt: done in every reading, or asked about."""

from __future__ import annotations

from collections import deque

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from loop_bench import in_doubt, sighting_of

from planner_node.errors import AmbiguousObjectError, NeedsAnswerError, UnknownObjectError
from planner_node.goals import Goal, ResolveGoal, parse_goal, resolve_goal
from planner_node.loop import Answers, Scene, certain_goal, plan_in, scene_in
from planner_node.loop.readings import Readings, doubts_in, readings_of, renamed
from planner_node.search import SearchResult
from planner_node.settings import Settings
from scene_graph import ONE_ROW, Stacks, all_moves, apply_move


def scene_of(stacks: Stacks, **alternatives: str) -> Scene:
    return scene_in(Readings().named(in_doubt(sighting_of(stacks), **alternatives)))


def reading_of(text: str) -> ResolveGoal:
    parsed = parse_goal(text)
    return lambda seen, rows=ONE_ROW: resolve_goal(
        parsed, [name for stack in seen for name in stack], len(seen), rows
    )


def search(scene: Scene, goal: Goal) -> SearchResult:
    return plan_in(scene, goal, Settings(), lambda: False)


def goal_in(text: str, scene: Scene) -> Goal:
    return certain_goal(reading_of(text), scene, search)


#: The orange box may be red, too.
STACKS: Stacks = (("blue_box", "orange_box"), ("green_box",), ("yellow_box",))
SCENE = scene_of(STACKS, orange_box="red")


@pytest.mark.parametrize(
    "text", ["green on blue", "clear stack0", "nothing on blue", "three blocks in stack1"]
)
def test_a_goal_that_does_not_depend_on_the_colour_is_that_of_a_scene_without_doubt(
    text: str,
) -> None:
    certain = scene_of(STACKS)
    assert (
        search(SCENE, goal_in(text, SCENE)).moves == search(certain, goal_in(text, certain)).moves
    )


def test_a_block_is_named_by_its_shape_where_its_colour_is_in_doubt() -> None:
    stacks: Stacks = (("blue_box", "orange_cylinder"), ("green_box",), ())
    goal = goal_in("the cylinder on green", scene_of(stacks, orange_cylinder="red"))
    assert [str(item) for item in goal.relations] == ["orange_cylinder up green_box"]


@pytest.mark.parametrize("color", ["orange", "red"])
def test_what_a_block_is_called_is_asked_where_the_goal_needs_it(color: str) -> None:
    with pytest.raises(NeedsAnswerError) as caught:
        goal_in(f"{color} on green", SCENE)
    assert caught.value.doubt.colors == ("orange", "red")
    assert str(caught.value).startswith("is the block on top of stack0 (orange_box) orange or red?")


def test_a_name_that_another_block_certainly_has_is_asked_as_well() -> None:
    scene = scene_of((("blue_box", "orange_box"), ("red_box",), ()), orange_box="red")
    with pytest.raises(NeedsAnswerError):
        goal_in("red on blue", scene)


@pytest.mark.parametrize("text", ["pink on blue", "box on blue"])
def test_what_makes_no_sense_in_any_reading_is_refused_as_ever(text: str) -> None:
    with pytest.raises((UnknownObjectError, AmbiguousObjectError)):
        goal_in(text, SCENE)


def test_what_can_be_done_in_all_readings_at_once_is_done() -> None:
    scene = scene_of((("blue_box", "orange_box"), ("red_box",), ()), orange_box="red")
    found = search(scene, goal_in("every red block in stack2", scene))
    assert sorted(found.states[-1][2]) == ["orange_box", "red_box"]


def test_what_cannot_be_done_in_all_readings_at_once_is_asked() -> None:
    scene = scene_of((("blue_box", "orange_box"), ("red_box",), ()), orange_box="red")
    with pytest.raises(NeedsAnswerError):
        goal_in("every red block on blue", scene)


def test_answers_settle_one_question_after_the_other() -> None:
    stacks: Stacks = (("blue_box", "orange_box"), ("purple_box",), ())
    left = {"orange_box": "red", "purple_box": "magenta"}
    told: list[tuple[str, str]] = []

    def settle(doubt: object, color: str) -> None:
        name = doubt.name  # type: ignore[attr-defined]
        told.append((name, color))
        del left[name]

    answers = Answers("It is purple, orange", settle, lambda: scene_of(stacks, **left), search)
    scene = scene_of(stacks, **left)
    with pytest.raises(NeedsAnswerError) as caught:
        Answers("", settle, lambda: scene, search).goal_in(scene, reading_of("orange on purple"))
    asked_first = caught.value.doubt.name
    if asked_first == "orange_box":
        answers = Answers("orange, purple", settle, lambda: scene_of(stacks, **left), search)
    _, goal = answers.goal_in(scene, reading_of("orange on purple"))
    assert [str(item) for item in goal.relations] == ["orange_box up purple_box"]
    assert sorted(told) == [("orange_box", "orange"), ("purple_box", "purple")]


def test_an_answer_that_is_none_of_the_colours_asks_once_more() -> None:
    answers = Answers("green", lambda *_: None, lambda: SCENE, search)
    with pytest.raises(NeedsAnswerError, match="'green' does not answer this: is the block"):
        answers.goal_in(SCENE, reading_of("orange on green"))


def fewest_moves(scene: Scene, text: str) -> int | None:
    """By trying all states: until the goal holds in each reading, read by itself."""
    readings = list(readings_of(doubts_in(scene.graph), scene.names))
    goals = [reading_of(text)(renamed(scene.stacks, reading)) for reading in readings]
    queue, seen = deque([(scene.stacks, 0)]), {scene.stacks}
    while queue:
        state, count = queue.popleft()
        if all(goal.holds(renamed(state, reading)) for goal, reading in zip(goals, readings)):
            return count
        for move in all_moves(len(state)):
            if not state[move.source]:
                continue
            after = apply_move(state, move)
            if after not in seen:
                seen.add(after)
                queue.append((after, count + 1))
    return None


@settings(max_examples=25, deadline=None)
@given(
    st.permutations(["red_box", "orange_box", "blue_box", "green_box"]),
    st.tuples(st.integers(0, 4), st.integers(0, 4)),
    st.sampled_from(
        ["green on blue", "every red block in stack0", "nothing on blue", "no red block in stack1",
         "every red block above green", "every orange block left of blue"]
    ),
)  # fmt: skip
def test_plans_are_right_in_all_readings_and_none_is_shorter(
    order: list[str], cuts: tuple[int, int], text: str
) -> None:
    first, second = sorted(cuts)
    stacks = (tuple(order[:first]), tuple(order[first:second]), tuple(order[second:]))
    scene = scene_of(stacks, orange_box="red")
    try:
        wanted = fewest_moves(scene, text)
    except (UnknownObjectError, AmbiguousObjectError):
        wanted = None
    try:
        found = search(scene, goal_in(text, scene))
    except NeedsAnswerError:
        assert wanted is None
        return
    assert len(found.moves) == wanted
