# SPDX-License-Identifier: Apache-2.0
"""What is seen while the arm moves, against what the plan predicts at that instant."""

from __future__ import annotations

import math
from dataclasses import replace
from typing import Any

import pytest
from hypothesis import assume, given
from hypothesis import strategies as st
from posed_scenes import FRAME, SECOND, Instant, Point, centre, frame, instants, plan_of
from tamp_runtime.motion_report import MotionReport, MotionState

from planner_node.loop import Plan, Sighting
from planner_node.loop.expectation import NUDGED
from planner_node.loop.plan_watch import PlanSight, PlanWatch, Sight
from scene_graph import GraphStatus, Move, Stacks, all_moves

NAMES = ("red_box", "green_box", "blue_box", "yellow_box", "cyan_box")
START: Stacks = (("red_box", "blue_box"), ("green_box",), ())
MOVES = (Move(0, 2), Move(0, 1), Move(2, 1))
#: Where each block may be put by somebody: beside the places, between them, on them, in the air.
SOMEWHERE = st.tuples(st.floats(0.4, 0.6), st.floats(-0.2, 0.2), st.floats(0.02, 0.3))


@st.composite
def plans(draw: st.DrawFn) -> Plan:
    """Random moves in a random state of up to five blocks."""
    names = draw(st.permutations(NAMES))[: draw(st.integers(1, 5))]
    cuts = sorted(draw(st.tuples(*[st.integers(0, len(names))] * 2)))
    stacks = names[: cuts[0]], names[cuts[0] : cuts[1]], names[cuts[1] :]
    state = [list(stack) for stack in stacks]
    moves = []
    for _ in range(draw(st.integers(1, 4))):
        move = draw(st.sampled_from([move for move in all_moves(3) if state[move.source]]))
        state[move.target].append(state[move.source].pop())
        moves.append(move)
    return plan_of(tuple(map(tuple, stacks)), tuple(moves))


def watch_all(watch: PlanWatch, plan: Plan, late: int = 0) -> None:
    """All goes as predicted; the reports are late, and stamped late."""
    reports: list[MotionReport] = []
    for instant in instants(plan):
        if instant.begins:
            reports.append(instant.report(plan, late))
        while reports and reports[0].stamp <= instant.stamp:
            watch.hear(reports.pop(0))
        watch.see(instant.frame())


@given(plans(), st.integers(0, 3))
def test_frames_as_predicted_never_contradict_at_whatever_phase(plan: Plan, late: int) -> None:
    watch = PlanWatch(plan)
    watch_all(watch, plan, late * FRAME)
    assert watch.contradiction == ""


@given(plans(), st.integers(0, 3))
def test_of_every_frame_it_is_told_whether_the_next_block_is_where_it_is_to_be_taken(
    plan: Plan, late: int
) -> None:
    watch, begun = PlanWatch(plan), 0
    reports: list[MotionReport] = []
    for instant in instants(plan):
        if instant.begins:
            reports.append(instant.report(plan, late * FRAME))
        while reports and reports[0].stamp <= instant.stamp:
            watch.hear(reports.pop(0))
            begun = instant.stamp
        watch.see(instant.frame())
        # Just after a step has begun the block may still be in the hand.
        settled = not reports and instant.stamp > begun + 3 * FRAME
        if settled and not instant.step % 2 and instant.step < 2 * len(plan.moves):
            assert watch.sight == PlanSight(instant.stamp, instant.step // 2, Sight.SEEN)


@given(plans(), st.floats(0.016, 0.1), st.floats(0.0, math.tau), st.floats(0.0, 1.0))
def test_a_block_that_is_not_where_it_is_to_be_taken_is_never_said_to_be_there(
    plan: Plan, away: float, angle: float, visible: float
) -> None:
    """Unless it is told where it is."""
    watch, name = PlanWatch(plan, patience=99), plan.blocks[0]
    for instant in instants(plan):
        if instant.step:
            break
        if instant.begins:
            watch.hear(instant.report(plan))
        x, y, z = standing(instant, name)
        there = (x + away * math.cos(angle), y + away * math.sin(angle), z)
        assert not watch.see(instant.frame({name: there}, visible=visible))
        assert watch.sight is not None
        if watch.sight.sight is Sight.SEEN:
            assert [item.position_world for item in watch.sight.moved] == [there]
            assert away <= NUDGED


def test_what_nothing_can_be_made_of_and_what_may_contradict_the_plan_is_doubtful() -> None:
    _, watch, course = course_of(2)
    assert watch_sees(watch, course[0].frame()) is Sight.SEEN
    nothing = {name: None for name in NAMES}
    assert watch_sees(watch, course[1].frame(nothing)) is Sight.DOUBTFUL
    x, y, z = centre(1, 0)
    assert watch_sees(watch, course[2].frame({"green_box": (x + 0.018, y, z)})) is Sight.DOUBTFUL
    hidden: dict[str, Any] = {"moved": {"red_box": None}, "hidden": (1.0, 1.0, 1.0)}
    assert watch_sees(watch, course[3].frame(**hidden)) is Sight.HIDDEN
    assert watch_sees(watch, course[4].frame()) is Sight.SEEN


def watch_sees(watch: PlanWatch, seen: Sighting) -> Sight | None:
    assert not watch.see(seen)
    return watch.sight.sight if watch.sight else None


@given(plans(), st.integers(0, 3), st.floats(0.0, 0.0105), st.floats(0.0, math.tau))
def test_a_block_that_hardly_moved_contradicts_nothing(
    plan: Plan, late: int, away: float, angle: float
) -> None:
    name = plan.scene.graph.names[0]
    watch = PlanWatch(plan)
    for instant in instants(plan):
        if instant.begins:
            watch.hear(instant.report(plan, late))
        moved = {}
        if name != instant.held:
            x, y, z = standing(instant, name)
            moved[name] = (x + away * math.cos(angle), y + away * math.sin(angle), z)
        watch.see(instant.frame(moved))
    assert watch.contradiction == ""


def standing(instant: Instant, name: str) -> Point:
    return next(
        centre(index, stack.index(name))
        for index, stack in enumerate(instant.stacks)
        if name in stack
    )


@given(plans(), st.data())
def test_any_block_that_is_displaced_in_the_view_is_noticed(
    plan: Plan, data: st.DataObject
) -> None:
    course = list(instants(plan))
    begin = data.draw(st.integers(0, len(course) - 1))
    name = data.draw(st.sampled_from(plan.scene.graph.names))
    later = course[begin:]
    # It is not about to be taken, nor has it just been put down.
    around = [item for item in course if abs(item.stamp - course[begin].stamp) <= SECOND]
    assume(all(item.held != name for item in around))
    assume(len(later) >= 4)
    there = data.draw(SOMEWHERE)
    # Straight above where it stood it may be in the hand already.
    assume(math.dist(there[:2], standing(course[begin], name)[:2]) > 0.04)
    watch = PlanWatch(plan)
    for item in course[:begin]:
        if item.begins:
            watch.hear(item.report(plan))
        watch.see(item.frame())
    for item in later[:4]:
        if item.begins:
            watch.hear(item.report(plan))
        watch.see(item.frame({name: there}))
    if watch.nudged:  # it stands there as well
        assert watch.nudged.keys() == {name} and max(watch.nudged.values()) <= 1.1 * NUDGED
        return
    assert watch.contradiction.startswith(f"{name} was expected on ")
    assert ";" not in watch.contradiction


def course_of(step: int, count: int = 12) -> tuple[Plan, PlanWatch, list[Instant]]:
    """A watch over a plan that has come to a step, and the instants of this step."""
    plan = plan_of(START, MOVES)
    watch = PlanWatch(plan)
    left = []
    for instant in instants(plan, count):
        if instant.step > step:
            break
        if instant.begins:
            watch.hear(instant.report(plan))
        if instant.step < step:
            watch.see(instant.frame())
        else:
            left.append(instant)
    return plan, watch, left


def exchanged(instant: Instant, one: str, other: str) -> Sighting:
    names = {one: other, other: one}
    stacks = tuple(tuple(names.get(name, name) for name in stack) for stack in instant.stacks)
    return frame(stacks, instant.stamp, hidden=(0.7, 0.0, 0.0))


def test_two_blocks_that_changed_places_are_told_by_where_they_are_seen() -> None:
    _, watch, course = course_of(2)
    assert watch.see(exchanged(course[6], "green_box", "blue_box"))
    assert sorted(watch.contradiction.split("; ")) == [
        "blue_box was expected on stack2 and is seen on stack1 since move 2 of 3",
        "green_box was expected on stack1 and is seen on stack2 since move 2 of 3",
    ]


def test_one_frame_is_enough_that_perception_is_sure_of() -> None:
    _, watch, course = course_of(0)
    moved = {"green_box": (0.55, 0.02, 0.0225)}
    assert watch.see(course[0].frame(moved, status=GraphStatus.CONFIDENT, hidden=(0.0,) * 3))
    assert watch.contradiction == (
        "green_box was expected on stack1 and is seen 54 mm beside where it was to be "
        "since move 1 of 3"
    )


@pytest.mark.parametrize("step", [0, 1, 2])
def test_a_block_that_was_moved_a_little_is_told_once_it_rests(step: int) -> None:
    _, watch, course = course_of(step)
    x, y, z = centre(1, 0)
    for number, item in enumerate(course[4:8]):  # it still slides
        assert not watch.see(item.frame({"green_box": (x + 0.016 + 0.006 * number, y, z)}))
        assert watch.sight is not None and not watch.sight.moved
        assert watch.sight.sight is not Sight.SEEN
    there = (x + 0.04, y, z)
    for item in course[8:]:
        assert not watch.see(item.frame({"green_box": there}))
        told = watch.sight
    assert told is not None
    assert [(item.name, item.position_world) for item in told.moved] == [("green_box", there)]
    assert told.sight is (Sight.HIDDEN if step % 2 else Sight.SEEN)
    assert watch.nudged == {"green_box": pytest.approx(0.04)}


def test_a_block_that_the_plan_has_moved_already_is_not_to_be_moved_any_more() -> None:
    _, watch, course = course_of(2)
    x, y, z = centre(2, 0)
    for item in course[6:8]:
        watch.see(item.frame({"blue_box": (x + 0.04, y, z)}))
    assert watch.contradiction.startswith("blue_box was expected on stack2")


def test_a_single_frame_is_no_contradiction_that_is_not_plain() -> None:
    """The block is a little beside where it was, or hardly seen, or what is seen may be it."""
    x, y, z = centre(1, 0)
    odd: list[dict[str, Any]] = [
        {"moved": {"green_box": (x + 0.018, y, z)}},
        {"moved": {"green_box": centre(2, 3)}, "visible": 0.5},
        {"moved": {"green_box": None, "grey_box": (x, y, z)}},
    ]
    for fields in odd:
        _, watch, course = course_of(2)
        for number, item in enumerate(course):
            assert not watch.see(item.frame(**(fields if number % 2 else {})))


@pytest.mark.parametrize("there", [None, (0.5, 0.07, 0.0225), (0.62, 0.0, 0.0225)])
def test_what_is_plain_in_one_frame_waits_for_no_other(there: Point | None) -> None:
    _, watch, course = course_of(2)
    assert watch.see(course[6].frame({"green_box": there}))


@pytest.mark.parametrize("step", [0, 2, 4])
def test_a_block_that_may_just_have_been_taken_is_missed_in_two_frames_only(step: int) -> None:
    """The report that it was comes later than frames that do not show it in the hand."""
    plan, watch, course = course_of(step)
    name = plan.blocks[step // 2]
    over = course[0].hand
    hidden, seen_to = [0.0] * 3, [0.36] * 3
    hidden[over], seen_to[over] = 0.5, 0.25
    told = [
        watch.see(item.frame({name: None}, hidden=tuple(hidden), seen_to=tuple(seen_to)))
        for item in course[4:6]
    ]
    assert told == [False, True]
    _, watch, course = course_of(step)
    # No hand is near: it may have left with it.
    assert not watch.see(course[4].frame({name: None}, hidden=(0.0,) * 3))
    assert watch.sight is not None and watch.sight.sight is Sight.DOUBTFUL
    assert watch.see(course[5].frame({name: None}, hidden=(0.0,) * 3))


def test_a_block_is_missed_below_the_hand_but_not_behind_it() -> None:
    """The column is hidden from 0.1 m up: the lower one of two blocks would be seen."""
    fields: dict[str, Any] = {"hidden": (0.5, 0.5, 0.5), "seen_to": (0.1, 0.1, 0.1)}
    _, watch, course = course_of(2)
    assert watch.see(course[6].frame({"green_box": None}, **fields))
    _, watch, course = course_of(2 * len(MOVES))
    for item in course[6:-1]:
        assert not watch.see(item.frame({"blue_box": None}, **fields))  # on two others
    assert watch.see(course[-1].frame({"red_box": None}, **{**fields, "hidden": (0.0,) * 3}))


def test_a_block_that_fell_is_told_by_its_colour_and_by_where_it_lies() -> None:
    _, watch, course = course_of(2)
    lying = {"green_box": (0.55, 0.06, 0.02)}
    for item in course[6:8]:  # it may be a part of the arm, while the block is behind the hand
        hidden = (0.0, 0.5, 0.0)
        assert not watch.see(item.frame(fallen=lying, shape="cylinder", hidden=hidden))
    assert watch.see(course[8].frame(fallen=lying, shape="cylinder"))
    assert watch.contradiction.startswith("green_box was expected on stack1 and is seen 78 mm")


def test_a_block_that_lies_before_its_place_and_hides_it_is_believed_once_it_stays_there() -> None:
    """A part of the arm that looks like it does not stay."""
    _, watch, course = course_of(2)
    for index, item in enumerate(course[2:6]):
        passing = {"green_box": (0.62, -0.02 * index, 0.02)}
        assert not watch.see(item.frame(fallen=passing, hidden=(0.0, 0.11, 0.0)))
        assert watch.sight is not None and watch.sight.sight is Sight.DOUBTFUL
    lying: dict[str, Any] = {"fallen": {"green_box": (0.62, 0.03, 0.02)}, "hidden": (0.0, 0.1, 0.0)}
    assert [watch.see(item.frame(**lying)) for item in course[6:9]] == [False, False, True]


def test_a_block_that_is_measured_badly_where_it_stands_contradicts_nothing() -> None:
    _, watch, course = course_of(2)
    x, y, z = centre(1, 0)
    for item in course:
        assert not watch.see(item.frame(fallen={"green_box": (x + 0.01, y, z + 0.01)}))
        # Nor does a part of the arm that looks like a block that lies.
        assert not watch.see(item.frame(fallen={"grey_box": (x, y + 0.02, z + 0.1)}))


def test_a_block_of_which_the_hand_shows_a_part_contradicts_nothing() -> None:
    _, watch, course = course_of(2)
    x, y, z = centre(0, 0)
    for item in course:
        part = {"red_box": (x + 0.031, y, z + 0.01)}
        assert not watch.see(item.frame(fallen=part, hidden=(0.7, 0.0, 0.0)))
        assert watch.sight is not None and watch.sight.sight is Sight.HIDDEN


def test_of_two_blocks_that_look_alike_either_may_be_the_first() -> None:
    """The left one is named first: the names change hands as one is carried past the other."""
    stacks: Stacks = (("red_box",), ("red_box_2", "blue_box"), ())
    plan = plan_of(stacks, (Move(0, 2),))
    watch = PlanWatch(plan)
    other = {"red_box": "red_box_2", "red_box_2": "red_box"}
    *course, last = instants(plan)
    for item in course:
        if item.begins:
            watch.hear(item.report(plan))
        past = item.step > 1 or (item.step == 1 and item.hand == 2)
        seen = item.frame()
        if past:
            objects = tuple(
                replace(block, name=other.get(block.name, block.name))
                for block in seen.graph.objects
            )
            seen = replace(seen, graph=replace(seen.graph, objects=objects))
        assert not watch.see(seen), watch.contradiction
    assert watch.see(last.frame({"red_box": (0.5, 0.03, 0.3)}))


def test_a_block_that_is_gone_is_missed_only_where_nothing_hides_its_place() -> None:
    _, watch, course = course_of(2)
    for item in course[:6]:
        assert not watch.see(item.frame({"green_box": None}, hidden=(0.0, 0.1, 0.0)))
    assert watch.see(course[6].frame({"green_box": None}))
    assert watch.contradiction == (
        "green_box was expected on stack1 and is not seen any more since move 2 of 3"
    )


def test_a_block_that_is_gone_is_doubted_where_less_than_half_of_it_can_be_hidden() -> None:
    _, watch, course = course_of(2)
    falling: dict[str, Any] = {"moved": {"green_box": None}, "hidden": (0.0, 0.04, 0.0)}
    assert watch_sees(watch, course[6].frame(**falling)) is Sight.DOUBTFUL
    assert watch.see(course[7].frame(**falling))


def test_a_block_of_which_little_is_seen_contradicts_nothing() -> None:
    _, watch, course = course_of(2)
    for item in course:
        assert not watch.see(item.frame({"green_box": centre(2, 3)}, visible=0.2))


def test_nothing_is_seen_on_a_sheet_of_paper() -> None:
    _, watch, course = course_of(1)
    for item in course:
        nothing = {name: None for name in NAMES}
        assert not watch.see(item.frame(nothing, hidden=(1.0, 1.0, 1.0)))


def test_another_block_on_a_place_is_noticed_and_a_part_of_the_arm_is_not() -> None:
    _, watch, course = course_of(1)
    for item in course[:8]:
        assert not watch.see(item.frame({"grey_box": (0.437, 0.08, 0.3)}))
    for item in course[8:10]:
        watch.see(item.frame({"grey_box": centre(2, 1)}))
    assert not watch.contradiction  # two frames, in the air: it may still be the arm
    _, watch, course = course_of(1)
    # It may be the one in the hand, by another name.
    unseen: dict[str, Point | None] = {course[0].held: None, "grey_box": centre(1, 1)}
    assert [watch.see(item.frame(unseen)) for item in course[:2]] == [False, True]
    _, watch, course = course_of(1)
    assert watch.see(course[0].frame({"grey_box": centre(1, 1)}))
    assert watch.contradiction == (
        "grey_box is seen at (0.50, 0.00, 0.07) m since move 1 of 3, and was not there before"
    )


@pytest.mark.parametrize("step", [0, 2, 4])
def test_the_block_that_is_picked_is_watched_until_it_is_taken(step: int) -> None:
    plan, watch, course = course_of(step)
    name = plan.blocks[step // 2]
    for item in course[6:10]:
        x, y, z = standing(item, name)
        watch.see(item.frame({name: (x + 0.06, y, z)}))
    assert watch.contradiction.startswith(f"{name} was expected on ")


def test_after_the_last_move_the_goal_is_watched_on() -> None:
    plan, watch, course = course_of(2 * len(MOVES))
    for item in course[6:9]:
        watch.see(item.frame({"red_box": centre(0, 0)}))
    assert watch.contradiction == (
        "red_box was expected on green_box and is seen 150 mm beside where it was to be "
        "since the last move"
    )
    assert plan.states[-1][1] == ("green_box", "red_box", "blue_box")


def test_frames_of_before_and_those_of_a_plan_that_was_given_up_say_nothing() -> None:
    plan = plan_of(START, MOVES, stamp=5 * SECOND)
    watch = PlanWatch(plan)
    elsewhere: dict[str, Point | None] = {"green_box": centre(2, 0)}
    sure = GraphStatus.CONFIDENT
    assert not watch.see(frame(START, 5 * SECOND, elsewhere, sure))
    assert not watch.see(None)
    going_home = MotionReport(plan.plan_id, MotionState.EXECUTING, phase="home", moves_done=1)
    watch.hear(going_home)
    assert not watch.see(frame(START, 6 * SECOND, elsewhere, sure))


def test_more_patience_takes_as_many_times_as_many_frames() -> None:
    plan = plan_of(START, MOVES)
    watch = PlanWatch(plan, patience=3)
    course = [item for item in instants(plan) if item.step == 0]
    told = [watch.see(item.frame({"green_box": centre(2, 0)})) for item in course[:3]]
    assert told == [False, False, True]


def test_an_alarm_that_a_look_does_not_confirm_is_found_out() -> None:
    plan = plan_of(START, MOVES)
    watch = PlanWatch(plan)
    seen = plan.scene
    assert watch.is_as_predicted(seen, 0)
    assert not watch.is_as_predicted(seen, 1)
