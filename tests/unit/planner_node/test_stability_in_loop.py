# SPDX-License-Identifier: Apache-2.0
"""The closed loop plans by what stands on what, as it is told to, and says so."""

from __future__ import annotations

import pytest
from loop_bench import LoopBench, sighting_of

from planner_node.loop import Outcome, Status, plan_in, scene_in
from planner_node.settings import Settings
from scene_graph import SceneObject, Stacks, split_object_name

#: Two moves are enough for "green on stack1", by way of the sphere.
START: Stacks = (("green_box",), ("blue_box",), ("red_sphere",))


def achieve(goal: str, **settings: str) -> tuple[LoopBench, Outcome]:
    bench = LoopBench(**settings)
    bench.stacks = START
    return bench, bench.achieve(goal)


def test_a_longer_plan_is_carried_out_that_puts_nothing_on_the_sphere() -> None:
    bench, outcome = achieve("green on stack1")
    assert outcome.status == Status.SUCCESS
    (plan,) = bench.plans
    assert len(plan.moves) == outcome.moves_planned == 4
    assert not any("red_sphere" in stack[:-1] for state in plan.states for stack in state)
    why = (
        "2 moves longer than the shortest plan, which puts blue_box on red_sphere "
        "(it would roll off)"
    )
    assert outcome.message.endswith(f"; the plan was {why}")
    assert why in bench.messages()


def test_where_shapes_do_not_matter_the_shortest_plan_is_carried_out() -> None:
    bench, outcome = achieve("green on stack1", stability="ignore")
    assert outcome.status == Status.SUCCESS
    assert outcome.message.endswith("[- | green_box | red_sphere blue_box]")
    assert [len(plan.moves) for plan in bench.plans] == [2]


@pytest.mark.parametrize("stability", ["avoid", "require"])
def test_what_cannot_stand_is_refused_before_anything_moves(stability: str) -> None:
    bench, outcome = achieve("blue on red", stability=stability)
    assert (outcome.status, outcome.module) == (Status.UNREACHABLE, "planner")
    assert outcome.message.startswith(
        "'blue_box on red_sphere' is not possible: blue_box cannot stand on red_sphere, it would "
        "roll off; stability:=ignore plans it all the same"
    )
    assert (bench.plans, outcome.moves_executed) == ([], 0)


@pytest.mark.parametrize(("ratio", "unstable"), [(1.5, True), (2.5, False)])
def test_sizes_that_are_seen_decide_and_how_much_wider_is_too_wide(
    ratio: float, unstable: bool
) -> None:
    widths = {"green_box": 0.06, "blue_box": 0.03, "red_sphere": 0.04}
    seen = sighting_of(START)
    objects = tuple(
        SceneObject(name, *split_object_name(name), size=(width, width, 0.04))
        for name, width in sorted(widths.items())
    )
    graph = type(seen.graph)(objects, seen.graph.relations, seen.graph.places)
    scene = scene_in(type(seen)(graph))
    goal = LoopBench.read("green on blue")(START)
    found = plan_in(scene, goal, Settings(max_width_ratio=ratio), lambda: False)
    assert len(found.moves) == 1
    assert [item.block for item in found.unstable] == ["green_box"] * unstable
