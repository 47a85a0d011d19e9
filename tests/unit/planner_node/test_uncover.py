# SPDX-License-Identifier: Apache-2.0
"""What is hidden is uncovered with the fewest moves, and what was seen is remembered."""

from __future__ import annotations

import math
import random
from collections.abc import Iterator
from dataclasses import replace

import pytest
from tamp_runtime.motion_report import MotionReport, MotionState

from planner_node.errors import NotConfidentError
from planner_node.goals import Goal, parse_goal, resolve_goal
from planner_node.loop import Scene, plan_for
from planner_node.loop.recall import recall
from planner_node.search import SearchResult, make_plan
from planner_node.search.limits import Limits
from planner_node.search.possible import Exclusion
from planner_node.search.stability import Figure, Stability
from planner_node.search.uncover import Sight, uncover
from scene_graph import (
    HIDDEN,
    Move,
    SceneGraph,
    SceneObject,
    Stacks,
    apply_move,
    front_relations,
    hidden_name,
    hidden_places,
    in_rows,
    is_hidden,
    rows_of,
    up_relations,
)

EDGE = 0.045
#: A tower of two hides nothing, one of three does.
CLEAR = 0.1
NAMES = ("red_box", "blue_box", "green_box", "yellow_box")
_X = (0.58, 0.42)
_BARE = in_rows(tuple((x, y, 0.0) for x in _X for y in (-0.15, 0.0, 0.15)), (1.45, 0.0, 0.85))
PLACES = tuple(
    replace(
        near,
        clear=tuple(
            CLEAR if (near.row, far.row) == (0, 1) and near.column == far.column else math.inf
            for far in _BARE
        ),
    )
    for near in _BARE
)
ROWS = rows_of(PLACES)


def sight_of(stacks: Stacks) -> Sight:
    return Sight(PLACES, {name: EDGE for stack in stacks for name in stack})


def found(stacks: Stacks, **more: object) -> SearchResult:
    return uncover(stacks, sight_of(stacks), Limits(stacks, Goal(())), **more)  # type: ignore[arg-type]


def covered(state: Stacks, hidden: tuple[int, ...]) -> bool:
    """Whether a tower of three stands before a place, told without the code under test."""
    return any(len(state[place - 3]) * EDGE > CLEAR for place in hidden)


def fewest(state: Stacks) -> int | None:
    """By brute force: moves of blocks until no tower stands before what is hidden."""
    hidden = hidden_places(state)
    layer, seen, depth = [state], {state}, 0
    while layer:
        if any(not covered(item, hidden) for item in layer):
            return depth
        layer = [new for old in layer for new in _after(old) if new not in seen]
        seen.update(layer)
        depth += 1
    return None


def _after(state: Stacks) -> Iterator[Stacks]:
    for p in range(6):
        for q in range(6):
            if p == q or not state[p] or is_hidden(state[p][-1]):
                continue
            if not state[q] or not is_hidden(state[q][-1]):
                yield apply_move(state, Move(p, q))


def test_a_tower_is_taken_down_to_where_it_hides_nothing() -> None:
    state: Stacks = (("red_box", "blue_box", "green_box"), (), (), (hidden_name(3),), (), ())
    plan = found(state)
    assert len(plan.moves) == 1
    assert plan.moves[0].source == 0
    assert not covered(plan.states[-1], (3,))
    assert plan.note == (
        "first what hides stack3 is moved aside (red_box, blue_box, green_box on stack0), to see "
        "what stands there"
    )


def test_it_takes_as_few_moves_as_brute_force() -> None:
    rng = random.Random(5)
    names = (*NAMES, "pink_box", "cyan_box")
    tried = 0
    while tried < 40:
        stacks: list[list[str]] = [[] for _ in PLACES]
        for name in rng.sample(names, len(names)):
            stacks[rng.choice((0, 0, 1, 1, 2, 3, 4, 5))].append(name)
        for place in (3, 4, 5):
            if len(stacks[place - 3]) * EDGE > CLEAR:
                stacks[place] = [hidden_name(place)]
        state = tuple(map(tuple, stacks))
        if not hidden_places(state):
            continue
        tried += 1
        plan = found(state)
        assert len(plan.moves) == fewest(state)
        assert not covered(plan.states[-1], hidden_places(state))


def test_of_equally_few_moves_those_are_taken_that_serve_the_goal() -> None:
    state: Stacks = (("red_box", "blue_box", "green_box"), ("yellow_box",), (), (hidden_name(3),),
                     (), ())  # fmt: skip
    goal = resolve_goal(parse_goal("green behind yellow, green left of yellow"), NAMES, 6).on(ROWS)
    plan = found(state, rate=lambda stacks: -len(goal.fulfilled_by(stacks)))
    assert len(plan.moves) == 1
    plan = found(
        state,
        rate=lambda stacks: float(stacks[5] != ("green_box",)),
    )
    assert plan.moves == (Move(0, 5),)


def test_moves_that_the_arm_cannot_make_are_not_made() -> None:
    state: Stacks = (("red_box", "blue_box", "green_box"), (), (), (hidden_name(3),), (), ())
    excluded = [Exclusion("green_box", source=0, under=("red_box", "blue_box"), reason="no grasp")]
    with pytest.raises(NotConfidentError, match="no moves of the blocks that are seen"):
        found(state, exclusions=excluded)


def test_nothing_is_put_on_a_sphere() -> None:
    state: Stacks = (("red_box", "blue_box", "green_box"), ("red_sphere",), ("blue_sphere",),
                     (hidden_name(3),), ("green_sphere",), ())  # fmt: skip
    spheres = {name: Figure("sphere", EDGE, EDGE) for name in
               ("red_sphere", "blue_sphere", "green_sphere")}  # fmt: skip
    assert found(state, stability=Stability(spheres)).moves == (Move(0, 5),)


def test_what_no_tower_hides_is_not_looked_for_for_ever() -> None:
    state: Stacks = (("red_box",), (), (), (hidden_name(3),), (), ())
    with pytest.raises(NotConfidentError, match="no stack is high enough to hide it"):
        found(state)


@pytest.mark.parametrize("text", ["red in front of blue", "blue behind red, green left of yellow"])
def test_plans_to_goals_of_rows_are_as_short_as_brute_force_finds(text: str) -> None:
    goal = resolve_goal(parse_goal(text), NAMES, 6).on(ROWS)
    rng = random.Random(3)
    for _ in range(20):
        stacks: list[list[str]] = [[] for _ in PLACES]
        for name in rng.sample(NAMES, 4):
            rng.choice(stacks).append(name)
        state = tuple(map(tuple, stacks))
        layer, seen, depth = [state], {state}, 0
        while not any(_told(text, item) for item in layer):
            layer = [new for old in layer for new in _after(old) if new not in seen]
            seen.update(layer)
            depth += 1
        assert len(make_plan(state, goal).moves) == depth


def _told(text: str, state: Stacks) -> bool:
    at = {name: index for index, stack in enumerate(state) for name in stack}
    front = at["red_box"] < 3 <= at["blue_box"]
    left = at["green_box"] % 3 < at["yellow_box"] % 3
    return front and (left or "left" not in text)


def scene_of(stacks: Stacks, heights: dict[str, float] | None = None) -> Scene:
    objects = []
    for index, stack in enumerate(stacks):
        x, y, top = PLACES[index].position_world
        for name in stack:
            height = (heights or {}).get(name, EDGE)
            color = HIDDEN if is_hidden(name) else name.split("_")[0]
            objects.append(
                SceneObject(
                    name, color, "box", (x, y, top + 0.5 * height), size=(EDGE, EDGE, height)
                )
            )
            top += height
    relations = up_relations(stacks) | front_relations(stacks, ROWS)
    graph = SceneGraph(tuple(objects), relations, PLACES)
    return Scene(graph, graph.stacks())


def after(before: Stacks, moves: tuple[Move, ...], seen: Scene) -> Scene:
    """What is made of a scene after a plan that was carried out."""
    states = [before]
    for move in moves:
        states.append(apply_move(states[-1], move))
    plan = plan_for(scene_of(before), Goal(()), SearchResult(moves, tuple(states), 0, 0.0), 1)
    done = MotionReport(plan.plan_id, MotionState.SUCCEEDED, moves_done=len(moves))
    return recall(seen, plan, done)


BEFORE: Stacks = (("red_box", "blue_box"), ("green_box",), (), ("yellow_box",), (), ())


def test_a_block_that_was_seen_before_it_was_hidden_is_remembered() -> None:
    seen = scene_of((("red_box", "blue_box", "green_box"), (), (), (hidden_name(3),), (), ()))
    scene = after(BEFORE, (Move(1, 0),), seen)
    assert scene.stacks == (("red_box", "blue_box", "green_box"), (), (), ("yellow_box",), (), ())
    assert not scene.hidden
    assert scene.graph.object("yellow_box").position_world[:2] == PLACES[3].position_world[:2]
    assert scene.graph.stacks() == scene.stacks


def test_nothing_is_remembered_that_does_not_fit_where_it_is_hidden() -> None:
    seen = scene_of(
        (("red_box", "blue_box", "green_box"), (), (), (hidden_name(3),), (), ()),
        {hidden_name(3): 0.03},
    )
    assert after(BEFORE, (Move(1, 0),), seen).hidden == (3,)


def test_nothing_is_remembered_where_something_else_is_seen_than_expected() -> None:
    seen = scene_of((("red_box", "green_box", "blue_box"), (), (), (hidden_name(3),), (), ()))
    assert after(BEFORE, (Move(1, 0),), seen).hidden == (3,)


def test_a_block_that_is_seen_elsewhere_is_not_taken_for_hidden() -> None:
    seen = scene_of(
        (("red_box", "blue_box", "green_box"), (), ("yellow_box",), (hidden_name(3),), (), ())
    )
    assert after(BEFORE, (Move(1, 0),), seen).hidden == (3,)


def test_what_was_never_seen_stays_hidden() -> None:
    before: Stacks = (("red_box", "blue_box", "green_box"), (), (), (hidden_name(3),), (), ())
    seen = scene_of((("red_box", "blue_box"), ("green_box",), (), (hidden_name(3),), (), ()))
    assert after(before, (Move(0, 1),), seen).hidden == (3,)
