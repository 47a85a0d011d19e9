# SPDX-License-Identifier: Apache-2.0
"""What the planner makes of what the motion node reports, and of its silence."""

from __future__ import annotations

import threading

import pytest
from loop_bench import START, FakeClock, sighting_of
from tamp_runtime.motion_report import ArmPlace, MotionReport, MotionState

from planner_node.errors import MotionBusyError, MotionSilentError
from planner_node.goals import complete_goal
from planner_node.loop import Clock, MotionLink, Plan, plan_for, scene_in
from planner_node.loop.plan_watch import PlanSight, Sight
from planner_node.search import make_plan
from planner_node.settings import Settings

SECOND = 1_000_000_000
OPTIMISING, EXECUTING = MotionState.OPTIMISING, MotionState.EXECUTING
SUCCEEDED, IDLE = MotionState.SUCCEEDED, MotionState.IDLE


class Linked:
    """A link, its clock, and the other end of its topic."""

    def __init__(self) -> None:
        self.clock = FakeClock()
        self.settings = Settings(motion_accept_timeout=20.0, motion_silence_timeout=10.0)
        self.published: list[Plan] = []
        self.stopped: list[str] = []
        self.sights: list[tuple[str, PlanSight]] = []
        self.audience = 1
        self.link = MotionLink(self.settings, self, self.clock.ros_now, self.clock)

    def publish(self, plan: Plan) -> None:
        self.published.append(plan)

    def publish_sight(self, plan_id: str, sight: PlanSight) -> None:
        self.sights.append((plan_id, sight))

    def publish_stop(self, plan_id: str) -> None:
        self.stopped.append(plan_id)

    def subscribers(self) -> int:
        return self.audience

    def start(self) -> str:
        """Starts a plan and returns its name."""
        scene = scene_in(sighting_of(START))
        goal = complete_goal(((), (), ("green_box", "red_box", "blue_box")))
        plan = plan_for(scene, goal, make_plan(START, goal), self.clock.ros_now())
        self.link.start(plan)
        return plan.plan_id

    def report(self, plan_id: str, state: MotionState, stamp: int = 0) -> None:
        self.link.receive(MotionReport(plan_id=plan_id, state=state, stamp=stamp))

    def is_busy(self) -> bool:
        try:
            self.link.check_free()
        except MotionBusyError:
            return True
        return False

    def follow(self) -> MotionReport | None:
        return self.link.follow(lambda _: None, lambda: False)


def test_a_plan_keeps_it_busy_until_its_end_is_reported() -> None:
    linked = Linked()
    assert not linked.is_busy()
    plan_id = linked.start()
    with pytest.raises(MotionBusyError, match=f"{plan_id}.*not taken up yet"):
        linked.link.check_free()
    linked.report(plan_id, EXECUTING)
    with pytest.raises(MotionBusyError, match=f"{plan_id}.*EXECUTING"):
        linked.link.check_free()
    linked.report(plan_id, SUCCEEDED)
    assert not linked.is_busy()


def test_a_foreign_plan_keeps_it_busy_until_it_ends() -> None:
    linked = Linked()
    linked.report("foreign", EXECUTING)
    with pytest.raises(MotionBusyError, match="foreign, which this planner does not follow"):
        linked.link.check_free()
    linked.report("another", SUCCEEDED)
    assert linked.is_busy()
    linked.report("foreign", SUCCEEDED)
    assert not linked.is_busy()


def test_a_foreign_plan_is_over_when_the_motion_node_is_idle_or_silent() -> None:
    linked = Linked()
    linked.report("foreign", EXECUTING)
    linked.report("", IDLE)
    assert not linked.is_busy()
    linked.report("foreign", EXECUTING)
    linked.clock.seconds += 9.9
    assert linked.is_busy()
    linked.clock.seconds += 0.2
    assert not linked.is_busy()


def test_every_report_is_told_and_the_last_is_the_outcome() -> None:
    linked = Linked()
    plan_id = linked.start()
    states = [OPTIMISING, EXECUTING, SUCCEEDED]
    remaining = list(states)
    linked.clock.on_wait = lambda: linked.report(plan_id, remaining.pop(0))
    told: list[MotionState] = []
    end = linked.link.follow(lambda report: told.append(report.state), lambda: False)
    assert told == states
    assert end is not None and end.state == SUCCEEDED


def test_following_stops_when_asked_to() -> None:
    linked = Linked()
    linked.start()
    assert linked.link.follow(lambda _: None, lambda: True) is None


@pytest.mark.parametrize(
    ("audience", "taken_up", "limit", "sentence"),
    [
        (0, False, 5.0, "nobody subscribes to symbolic_plan"),
        (1, False, 20.0, "no motion_status arrives"),
        (1, True, 10.0, "reports nothing any more"),
    ],
)
def test_silence_ends_the_plan(audience: int, taken_up: bool, limit: float, sentence: str) -> None:
    linked = Linked()
    linked.audience = audience
    plan_id = linked.start()
    if taken_up:
        linked.report(plan_id, EXECUTING)
    with pytest.raises(MotionSilentError, match=sentence) as caught:
        linked.follow()
    assert (caught.value.plan_id, caught.value.taken_up) == (plan_id, taken_up)
    assert linked.clock.seconds == pytest.approx(1000.0 + limit, abs=0.06)
    assert not linked.is_busy()


def test_fault_5_a_plan_that_an_idle_motion_node_has_not_taken_up_is_published_again() -> None:
    linked = Linked()
    plan_id = linked.start()
    linked.report("", IDLE)  # on its way when the plan came
    assert len(linked.published) == 1
    for _ in range(30):
        linked.clock.seconds += 0.1
        linked.report("", IDLE)
    assert {plan.plan_id for plan in linked.published} == {plan_id}
    assert len(linked.published) == 1 + 3  # at most once a second
    linked.report(plan_id, OPTIMISING)
    linked.clock.seconds += 1.5
    linked.report("", IDLE)
    assert len(linked.published) == 1 + 3


def test_fault_5_a_plan_that_was_given_up_is_not_published_again() -> None:
    linked = Linked()
    linked.start()
    linked.clock.seconds += 20.1
    linked.report("", IDLE)
    assert len(linked.published) == 1


def test_a_plan_that_is_being_stopped_is_not_published_again() -> None:
    linked = Linked()
    linked.link.stop(linked.start())
    linked.clock.seconds += 2.0
    linked.report("", IDLE)
    assert len(linked.published) == 1


def test_a_motion_node_that_was_there_a_moment_ago_may_be_starting_again() -> None:
    linked = Linked()
    linked.report("", IDLE)
    linked.audience = 0
    linked.start()
    linked.clock.on_wait = lambda: None
    with pytest.raises(MotionSilentError):
        linked.follow()
    # It was heard just before, so it gets the time to take the plan up once it is silent for long.
    assert linked.clock.seconds >= 1000.0 + linked.settings.motion_silence_timeout


def test_fault_13_a_plan_that_a_talking_motion_node_passes_over_is_told_from_silence() -> None:
    linked = Linked()
    linked.start()

    def beat() -> None:
        if linked.clock.seconds % 1.0 < 0.05:
            linked.report("", IDLE)

    linked.clock.on_wait = beat
    with pytest.raises(
        MotionSilentError, match="motion_status arrives, but says nothing of it"
    ) as e:
        linked.follow()
    assert (e.value.taken_up, e.value.speaks, e.value.untouched) == (False, True, True)


def test_fault_13_a_motion_node_that_is_not_heard_at_all_may_have_carried_the_plan_out() -> None:
    linked = Linked()
    linked.start()
    with pytest.raises(
        MotionSilentError, match=r"no motion_status arrives.*nobody knows"
    ) as caught:
        linked.follow()
    assert (caught.value.speaks, caught.value.untouched) == (False, False)


def test_fault_13_a_plan_that_is_being_stopped_is_not_to_be_stopped_once_more() -> None:
    linked = Linked()
    plan_id = linked.start()
    with pytest.raises(MotionBusyError, match="ros2 run planner_node stop"):
        linked.link.check_free()
    linked.link.stop(plan_id)
    with pytest.raises(MotionBusyError, match="is being stopped; wait until the arm rests"):
        linked.link.check_free()


def test_fault_1_a_foreign_plan_is_told_with_what_to_do() -> None:
    linked = Linked()
    linked.report("foreign", EXECUTING)
    with pytest.raises(MotionBusyError, match="ros2 run planner_node stop"):
        linked.link.check_free()
    linked.link.check_own()  # achieve_goal stops it


def test_a_stop_that_may_have_been_lost_is_repeated_while_the_plan_goes_on() -> None:
    linked = Linked()
    plan_id = linked.start()
    linked.report(plan_id, EXECUTING)
    linked.link.stop(plan_id)
    end = linked.clock.seconds + 10.0
    linked.clock.on_wait = lambda: linked.report(plan_id, EXECUTING)
    assert linked.link.follow(lambda _: None, lambda: linked.clock.seconds > end) is None
    assert linked.stopped == [plan_id] * 4


def test_whoever_cancels_does_not_wait_long_for_a_silent_motion_node() -> None:
    linked = Linked()
    plan_id = linked.start()
    linked.report(plan_id, EXECUTING)
    linked.link.stop(plan_id)
    with pytest.raises(MotionSilentError):
        linked.follow()
    assert linked.clock.seconds < 1000.0 + 10.0


def test_a_plan_that_nobody_follows_is_given_up_when_it_is_asked_for() -> None:
    linked = Linked()
    linked.start()
    assert linked.is_busy()
    linked.clock.seconds += 20.1
    assert not linked.is_busy()


@pytest.mark.parametrize(("plan_id", "state"), [("", IDLE), ("another", EXECUTING)])
def test_a_motion_node_that_does_something_else_has_lost_the_plan(
    plan_id: str, state: MotionState
) -> None:
    linked = Linked()
    linked.report(linked.start(), EXECUTING)
    linked.clock.on_wait = lambda: linked.report(plan_id, state)
    with pytest.raises(MotionSilentError, match="or it was restarted"):
        linked.follow()
    # Sooner, the report was on its way before the motion node took the plan up.
    assert linked.clock.seconds == pytest.approx(1000.5, abs=0.11)


def test_the_last_end_is_when_it_was_reported_but_never_in_the_future() -> None:
    linked = Linked()
    assert linked.link.last_end == 0
    now = linked.clock.ros_now()
    linked.report("foreign", SUCCEEDED, stamp=now - 5)
    assert linked.link.last_end == now - 5
    linked.report("foreign", SUCCEEDED, stamp=now + 10**12)
    assert linked.link.last_end == now
    linked.report("foreign", SUCCEEDED)
    assert linked.link.last_end == now


def test_a_stop_names_the_plan() -> None:
    linked = Linked()
    plan_id = linked.start()
    linked.link.stop(plan_id)
    assert linked.stopped == [plan_id]


def test_a_report_that_comes_again_does_not_say_how_the_arm_is_now() -> None:
    link = Linked().link
    moving = MotionReport("a", EXECUTING, arm=ArmPlace.MOVING, held="red_box", stamp=2 * SECOND)
    link.receive(moving)
    link.receive(MotionReport("a", SUCCEEDED, arm=ArmPlace.HOME, stamp=5 * SECOND))
    link.receive(moving)
    assert (link.newest.arm, link.newest.held) == (ArmPlace.HOME, "")


def test_a_clock_that_starts_anew_is_followed() -> None:
    link = Linked().link
    link.receive(MotionReport("a", SUCCEEDED, arm=ArmPlace.HOME, stamp=500 * SECOND))
    link.receive(MotionReport(arm=ArmPlace.MOVING, stamp=2 * SECOND))
    assert link.newest.arm == ArmPlace.MOVING


class SleepyClock(Clock):
    """Who waits does so until he is woken."""

    def __init__(self) -> None:
        self.waits = threading.Event()

    def wait(self, changed: threading.Condition, seconds: float) -> None:
        del seconds
        self.waits.set()
        changed.wait(120.0)


def test_who_follows_a_plan_looks_at_other_news_as_soon_as_he_is_woken() -> None:
    linked = Linked()
    clock = SleepyClock()
    linked.link = MotionLink(linked.settings, linked, lambda: 0, clock)
    linked.start()
    contradicted = threading.Event()
    ended = []
    follower = threading.Thread(
        target=lambda: ended.append(linked.link.follow(lambda _: None, contradicted.is_set)),
        daemon=True,
    )
    follower.start()
    assert clock.waits.wait(60.0)
    contradicted.set()
    linked.link.wake()
    follower.join(60.0)
    assert ended == [None]


def test_what_is_seen_is_told_of_the_plan_that_is_followed() -> None:
    linked, sight = Linked(), PlanSight(SECOND, 0, Sight.SEEN)
    linked.link.tell_sight(sight)
    assert linked.sights == []
    plan_id = linked.start()
    linked.link.tell_sight(sight)
    assert linked.sights == [(plan_id, sight)]
