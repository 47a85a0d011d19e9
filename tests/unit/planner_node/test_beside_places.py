# SPDX-License-Identifier: Apache-2.0
"""A block that stands beside the places is put on one, with as few moves as can be."""

from __future__ import annotations

import math
from collections import deque

import pytest
from hypothesis import given
from hypothesis import strategies as st
from loop_bench import LoopBench, fail, obey
from tamp_runtime.motion_report import MotionReason

from planner_node.errors import GivenPlanError
from planner_node.goals import Goal
from planner_node.loop import Scene, Sighting, Status, given_plan_in, plan_in, scene_in
from planner_node.settings import Settings
from scene_graph import (
    UP,
    Place,
    Relation,
    SceneGraph,
    SceneObject,
    Stacks,
    all_moves,
    apply_move,
    split_object_name,
    spots_of,
    up_relations,
)

EDGE = 0.045
COUNT = 3
PLACES = tuple(Place(i, (0.5, 0.15 * (i - 1), 0.0)) for i in range(COUNT))
BESIDE = Place(COUNT, (0.56, 0.08, 0.0), aside=True)
NAMES = ("red_box", "green_box", "blue_box", "yellow_box")


def seen(stacks: Stacks, stamp: int = 0) -> Sighting:
    """Of three places, and of what stands beside them, if anything does."""
    stacks = stacks if stacks[COUNT:] and stacks[COUNT] else stacks[:COUNT]
    places = (*PLACES, BESIDE)[: len(stacks)]
    objects = tuple(
        SceneObject(
            name,
            *split_object_name(name),
            (*places[i].position_world[:2], (level + 0.5) * EDGE),
            size=(EDGE,) * 3,
        )
        for i, stack in enumerate(stacks)
        for level, name in enumerate(stack)
    )
    return Sighting(
        SceneGraph(objects, up_relations(stacks), places), stamp=stamp, frame_id="world"
    )


class BesideBench(LoopBench):
    """A world in which the fourth stack is a block beside the places."""

    def look(self) -> None:
        self.scenes.receive(seen(self.stacks, self.clock.ros_now()))


def bench_of(stacks: Stacks, *behaviours: object, **settings: object) -> BesideBench:
    bench = BesideBench(*behaviours, **settings)  # type: ignore[arg-type]
    bench.stacks = stacks
    return bench


START: Stacks = (("red_box", "yellow_box"), ("green_box",), (), ("blue_box",))


@pytest.mark.parametrize("verify", ["end", "each_move"])
def test_it_is_fetched_and_the_answer_says_so(verify: str) -> None:
    bench = bench_of(START, *[obey] * 5, verify=verify)
    outcome = bench.achieve("yellow_box on blue_box")
    assert (outcome.status, outcome.replans, outcome.causes) == (Status.SUCCESS, 0, ())
    assert outcome.message.endswith(
        "; blue_box stood 71 mm beside the centre of stack1, and was fetched"
    ) or outcome.message.endswith(
        "; blue_box stood 92 mm beside the centre of stack2, and was fetched"
    )
    assert bench.stacks == (("red_box",), ("green_box",), ("blue_box", "yellow_box"), ())
    assert outcome.moves_planned == 2


def test_it_is_fetched_also_where_the_goal_holds_already() -> None:
    bench = bench_of(START)
    outcome = bench.achieve("yellow_box on red_box")
    assert (outcome.status, outcome.moves_planned) == (Status.SUCCESS, 1)
    assert not bench.stacks[COUNT]


def test_one_that_is_out_of_reach_is_refused_with_the_reason() -> None:
    refusal = fail(MotionReason.INFEASIBLE, "out of reach")
    bench = bench_of(START, refusal, refusal)
    outcome = bench.achieve("yellow_box on blue_box")
    assert outcome.status == Status.MOTION_FAILED
    assert "out of reach" in outcome.message
    assert bench.stacks == START


def test_another_planners_plan_has_to_put_it_on_a_place_and_nothing_in_its_stead() -> None:
    scene, settings = scene_in(seen(START)), Settings()
    goal = Goal((Relation("yellow_box", UP, "blue_box"),))
    found = given_plan_in(scene, "(3, 2)\n(0, 2)", goal, settings)
    assert len(found.moves) == 2
    with pytest.raises(GivenPlanError, match="blue_box not on stack3"):
        given_plan_in(scene, "(0, 3)", goal, settings)
    with pytest.raises(GivenPlanError, match="step 2 of the plan puts a block on stack3"):
        given_plan_in(scene, "(3, 2)\n(1, 3)\n(0, 2)", goal, settings)


@st.composite
def scenes(draw: st.DrawFn) -> tuple[Stacks, tuple[Relation, ...]]:
    names = draw(st.permutations(NAMES))[: draw(st.integers(2, 4))]
    aside, *others = names
    cuts = sorted(draw(st.tuples(*[st.integers(0, len(others))] * 2)))
    stacks = (others[: cuts[0]], others[cuts[0] : cuts[1]], others[cuts[1] :], (aside,))
    upper, lower = draw(st.permutations(names))[:2]
    wanted = (Relation(upper, UP, lower),) if draw(st.booleans()) else ()
    return tuple(map(tuple, stacks)), wanted


def fewest(stacks: Stacks, goal: Goal) -> int:
    """By trying everything, layer by layer."""
    queue, known = deque([(stacks, 0)]), {stacks}
    while queue:
        now, moves = queue.popleft()
        spots = spots_of(now)
        if not now[COUNT] and all(item.holds(spots) for item in goal.relations):
            return moves
        for move in all_moves(COUNT + 1):
            if move.target < COUNT and now[move.source]:
                after = apply_move(now, move)
                if after not in known:
                    known.add(after)
                    queue.append((after, moves + 1))
    raise AssertionError("everything is possible")


@given(scenes())
def test_plans_have_the_fewest_moves_and_put_nothing_beside_the_places(
    drawn: tuple[Stacks, tuple[Relation, ...]],
) -> None:
    stacks, relations = drawn
    goal, scene = Goal(relations), scene_in(seen(stacks))
    found = plan_in(scene, goal, Settings(), lambda: False)
    assert all(move.target < COUNT for move in found.moves)
    assert not found.states[-1][COUNT]
    assert goal.holds(found.states[-1])
    assert len(found.moves) == fewest(stacks, goal)


def test_a_goal_is_read_as_if_it_stood_on_a_place() -> None:
    scene: Scene = scene_in(seen(START))
    assert scene.aside == ("blue_box",)
    assert scene.on_places == (("red_box", "yellow_box", "blue_box"), ("green_box",), ())
    assert math.isclose(scene.graph.places[COUNT].position_world[0], 0.56)
