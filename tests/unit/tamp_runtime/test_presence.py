# SPDX-License-Identifier: Apache-2.0
"""Two nodes of one role are noticed; one that takes another's place is not taken for a second."""

from hypothesis import given
from hypothesis import strategies as st
from tamp_runtime.presence import GONE_SECONDS, Roster


class _Time:
    def __init__(self) -> None:
        self.now = 0.0

    def __call__(self) -> float:
        return self.now


def test_two_that_live_at_once_are_two() -> None:
    clock = _Time()
    roster = Roster(clock)
    for identity in ("a", "b", "a"):
        roster.note("sim_node", identity)
        clock.now += 0.5
    assert roster.crowded() == ("sim_node",)


def test_one_that_takes_the_place_of_a_stopped_one_is_alone() -> None:
    clock = _Time()
    roster = Roster(clock)
    for identity in ("a", "a", "b", "b", "b"):
        roster.note("sim_node", identity)
        clock.now += 0.5
        assert roster.crowded() == ()


def test_a_second_one_that_leaves_is_forgotten() -> None:
    clock = _Time()
    roster = Roster(clock)
    for identity in ("a", "b", "a", "b"):
        roster.note("planner_node", identity)
        clock.now += 0.5
    clock.now += GONE_SECONDS
    roster.note("planner_node", "a")
    assert roster.crowded() == ()


@given(st.lists(st.sampled_from(["sim_node", "planner_node", "motion_node"]), max_size=30))
def test_one_of_each_is_never_a_crowd(roles: list[str]) -> None:
    clock = _Time()
    roster = Roster(clock)
    for role in roles:
        roster.note(role, f"the only {role}")
        clock.now += 0.1
        assert roster.crowded() == ()
