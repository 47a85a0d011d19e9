# SPDX-License-Identifier: Apache-2.0
"""The closed loop where towers of the front row hide what stands behind them."""

from __future__ import annotations

import math
from dataclasses import replace

from loop_bench import LoopBench, fail
from tamp_runtime.motion_report import MotionReason

from planner_node.goals import Goal
from planner_node.loop import Sighting, Status, plan_for, scene_in
from planner_node.loop.plan_watch import PlanWatch
from planner_node.search import SearchResult
from scene_graph import (
    HIDDEN,
    GraphStatus,
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
    split_object_name,
    up_relations,
)

EDGE = 0.045
_X = (0.58, 0.42)
_BARE = in_rows(tuple((x, y, 0.0) for x in _X for y in (-0.15, 0.0, 0.15)), (1.45, 0.0, 0.85))
PLACES = tuple(
    replace(
        near,
        clear=tuple(0.1 if far.index == near.index + 3 else math.inf for far in _BARE),
    )
    for near in _BARE
)
#: Behind three blocks nothing of one is seen.
START: Stacks = (("red_box", "blue_box", "green_box"), (), (), ("yellow_box",), (), ())


class RowsBench(LoopBench):
    """A world of two rows, of which a camera sees what no tower of three hides."""

    def look(self) -> None:
        shown = tuple(
            (hidden_name(i),) if i >= 3 and len(self.stacks[i - 3]) >= 3 and len(stack) <= 1
            else stack
            for i, stack in enumerate(self.stacks)
        )  # fmt: skip
        status = GraphStatus.HIDDEN if hidden_places(shown) else GraphStatus.CONFIDENT
        graph = SceneGraph(
            tuple(
                SceneObject(
                    name,
                    *((HIDDEN, "box") if is_hidden(name) else split_object_name(name)),
                    (*PLACES[i].position_world[:2], (level + 0.5) * EDGE),
                    size=(EDGE,) * 3,
                )
                for i, stack in enumerate(shown)
                for level, name in enumerate(stack)
            ),
            up_relations(shown) | front_relations(shown, rows_of(PLACES)),
            PLACES,
        )
        self.scenes.receive(Sighting(graph, status, "hidden", self.clock.ros_now(), "world"))


def bench_of(stacks: Stacks, *behaviours: object, **settings: object) -> RowsBench:
    bench = RowsBench(*behaviours, **settings)  # type: ignore[arg-type]
    bench.stacks = stacks
    return bench


def test_what_is_hidden_is_uncovered_before_the_goal_is_planned_for() -> None:
    bench = bench_of(START)
    outcome = bench.achieve("yellow in front of red")
    assert outcome.status == Status.SUCCESS, outcome.message
    assert outcome.message.endswith("; 1 move was made to see what stands behind others")
    assert [len(plan.moves) for plan in bench.plans] == [1, 3]
    assert (outcome.moves_planned, outcome.moves_executed, outcome.replans) == (4, 4, 0)
    assert outcome.causes == ()
    assert any(
        message.startswith("first what hides stack3 is moved aside") for message in bench.messages()
    )


def test_a_goal_that_names_nothing_hidden_and_holds_needs_no_look() -> None:
    outcome = bench_of(START).achieve("green on blue")
    assert outcome.status == Status.ALREADY_TRUE
    assert outcome.moves_executed == 0


def test_of_what_is_hidden_nothing_is_said_before_it_was_seen() -> None:
    bench = bench_of(START)
    outcome = bench.achieve("nothing on yellow, green on blue")
    assert outcome.status == Status.SUCCESS, outcome.message
    assert len(bench.plans) == 2, "it was uncovered, and green put back"


def test_a_name_that_no_block_has_is_told_once_all_is_seen() -> None:
    bench = bench_of(START)
    outcome = bench.achieve("pink on red")
    assert outcome.status == Status.UNKNOWN_OBJECT
    assert "there is no 'pink'" in outcome.message
    assert "yellow_box" in outcome.message
    assert len(bench.plans) == 1


def test_a_goal_that_hides_a_block_is_confirmed_by_what_was_seen_before() -> None:
    seen: Stacks = (("red_box", "blue_box"), ("green_box",), (), ("yellow_box",), (), ())
    bench = bench_of(seen)
    outcome = bench.achieve("yellow on stack3, red on stack0, blue on red, green on blue")
    assert outcome.status == Status.SUCCESS, outcome.message
    assert outcome.moves_executed == 1
    assert outcome.final is not None and outcome.final.stacks == bench.stacks


def test_what_cannot_be_moved_aside_is_moved_another_way() -> None:
    bench = bench_of(START, fail(MotionReason.GRASP_LOST, "the block slipped"))
    outcome = bench.achieve("yellow in front of red")
    assert outcome.status == Status.SUCCESS, outcome.message
    assert outcome.replans == 1


def test_each_move_is_looked_at_where_that_is_wanted() -> None:
    bench = bench_of(START, verify="each_move")
    outcome = bench.achieve("yellow in front of red, green on yellow")
    assert outcome.status == Status.SUCCESS, outcome.message


def test_a_goal_that_makes_no_sense_is_refused_before_anything_moves() -> None:
    for text, status in (
        (
            "red in front of blue, blue in front of green, green in front of red",
            Status.CONTRADICTORY_GOAL,
        ),
        ("red on the left stack", Status.INVALID_GOAL),
    ):
        bench = bench_of(START)
        outcome = bench.achieve(text)
        assert outcome.status == status, outcome.message
        assert not bench.plans


def shown(stacks: Stacks, stamp: int) -> Sighting:
    bench = bench_of(stacks)
    bench.look()
    assert bench.scenes.newest is not None
    return replace(bench.scenes.newest, stamp=stamp)


def watch_of(stacks: Stacks) -> PlanWatch:
    """Over a plan that moves the top of the first stack to the last place."""
    move = Move(0, 5)
    scene = scene_in(shown(stacks, 1), may_hide=True)
    found = SearchResult((move,), (scene.stacks, apply_move(scene.stacks, move)), 0, 0.0)
    return PlanWatch(plan_for(scene, Goal(()), found, 1))


def test_a_block_that_comes_into_view_where_blocks_were_hidden_is_no_surprise() -> None:
    watch = watch_of(START)
    both: Stacks = (START[0], (), (), ("yellow_box", "orange_box"), (), ())  # of two one is seen
    assert not any(watch.see(shown(both, stamp)) for stamp in range(2, 9))


def test_a_block_that_comes_to_a_place_that_was_seen_to_be_empty_is_one() -> None:
    watch = watch_of(START)
    added: Stacks = (START[0], (), (), (), ("pink_box",), ())
    assert any(watch.see(shown(added, stamp)) for stamp in range(2, 9))
    assert "pink_box is seen on stack4" in watch.contradiction


def test_a_block_that_a_tower_hides_is_not_missed() -> None:
    seen: Stacks = (("red_box", "blue_box"), ("green_box",), (), ("yellow_box",), (), ())
    move = Move(1, 0)
    scene = scene_in(shown(seen, 1))
    found = SearchResult((move,), (seen, apply_move(seen, move)), 0, 0.0)
    watch = PlanWatch(plan_for(scene, Goal(()), found, 1))
    for stamp in range(2, 9):
        watch.see(shown(apply_move(seen, move), stamp))
    assert "yellow_box" not in watch.contradiction
