# SPDX-License-Identifier: Apache-2.0
"""Whether what happened was noticed before the arm took the next block."""

from __future__ import annotations

from typing import Any

from faults.moment_report import details, make_rows
from faults.noticing import (
    CLOSING,
    carried_between,
    grasps,
    grasps_lost,
    noticed_at,
    noticed_in_time,
)
from faults.random_moment import MomentResult, to_json
from tamp_runtime.motion_report import MotionReason, MotionReport, MotionState

EXECUTING, FAILED = MotionState.EXECUTING, MotionState.FAILED


#: In seconds: fingers close for less than one.
SECOND = 1_000_000_000


def said(stamp: int, phase: str, move: int, plan: str = "first", **fields: Any) -> MotionReport:
    return MotionReport(
        plan, fields.pop("state", EXECUTING), move=move, moves_done=move, moves_total=3,
        phase=phase, stamp=stamp * SECOND, **fields,
    )  # fmt: skip


def at(course: list[MotionReport], stops: list[int], after: int) -> int | None:
    """When it was noticed, all in seconds."""
    found = noticed_at(course, [SECOND * stop for stop in stops], SECOND * after)
    return None if found is None else found // SECOND


def in_time(course: list[MotionReport], stops: list[int], after: float, **more: Any) -> bool | None:
    return noticed_in_time(course, [SECOND * stop for stop in stops], int(SECOND * after), **more)


COURSE = [
    said(10, "pick", 0), said(20, "place", 0), said(25, "place", 0), said(30, "pick", 1),
    said(40, "place", 1), said(50, "pick", 2), said(60, "place", 2), said(70, "home", 3),
]  # fmt: skip


def test_a_block_is_taken_where_its_place_begins() -> None:
    assert grasps(COURSE) == [20 * SECOND, 40 * SECOND, 60 * SECOND]


def test_a_plan_that_goes_on_was_not_noticed_to_be_wrong() -> None:
    assert at(COURSE, [], 32) is None
    assert in_time(COURSE, [], 32) is False
    assert in_time(COURSE, [], 65) is None  # neither a grasp nor a word came


def test_a_stop_before_the_next_grasp_is_in_time() -> None:
    assert in_time(COURSE, [38], 32) is True
    assert in_time(COURSE, [41], 32) is False
    assert in_time(COURSE, [5, 38], 32) is True
    assert at(COURSE, [5], 32) is None  # of another moment


def test_a_motion_that_gives_up_has_noticed() -> None:
    course = [*COURSE[:4], said(36, "home", 1), said(39, "home", 1, state=FAILED)]
    assert at(course, [], 32) == 36
    assert in_time(course, [], 32) is True


def test_a_new_plan_is_the_latest_way_to_notice() -> None:
    course = [*COURSE, said(90, "pick", 0, "second"), said(99, "place", 0, "second")]
    assert at(course, [], 65) == 90
    assert in_time(course, [], 65) is True


def test_the_grasp_from_which_a_block_slips_is_not_the_next_one() -> None:
    course = [*COURSE[:5], said(42, "home", 1, state=FAILED)]
    assert in_time(course, [], 32) is False
    assert in_time(course, [], 32, passed=1) is True


def test_what_happens_while_fingers_close_happens_before_the_next_grasp() -> None:
    closing = 40 - 0.5 * CLOSING / SECOND
    assert in_time(COURSE, [50], closing) is True
    assert in_time(COURSE, [50], closing, under_way=True) is False
    assert in_time(COURSE, [], closing) is False
    assert in_time(COURSE, [50], 40 - 2 * CLOSING / SECOND) is False
    assert in_time(COURSE, [50], 60 - 0.5 * CLOSING / SECOND) is None  # there is no next one


def test_what_is_carried_is_known_from_before_and_from_what_comes() -> None:
    course = [said(20, "place", 0, object_name="red_box"), said(30, "pick", 1),
              said(40, "place", 1, object_name="blue_box")]  # fmt: skip
    assert carried_between(course, 22 * SECOND, 28 * SECOND) == {"red_box"}
    assert carried_between(course, 32 * SECOND, 38 * SECOND) == frozenset()
    assert carried_between(course, 28 * SECOND, 45 * SECOND) == {"red_box", "blue_box"}


def test_lost_grasps_are_counted_by_plan() -> None:
    lost = said(42, "home", 1, state=FAILED, reason=MotionReason.GRASP_LOST)
    assert grasps_lost([*COURSE[:5], lost, lost]) == 1


def record(kind: str, verify: str, seed: int, **fields: Any) -> dict[str, Any]:
    base = {"happened": kind != "nothing", "ending": "reached", "simulated_seconds": 20.0}
    base["in_time_of_any"] = fields.get("in_time")
    return to_json(MomentResult(kind, verify, 0, seed, "goal", **{**base, **fields}))


def rows_of(records: list[dict[str, Any]]) -> dict[tuple[str, str], Any]:
    return {(row.set, row.metric): row for row in make_rows(records)}


def test_a_refusal_that_names_no_block_of_what_happened_is_not_good() -> None:
    records = [
        record("push", "watch", 1, effect=True, in_time=True, latency=0.4, replans=1),
        record("push", "watch", 2, ending="refused", named=False, in_time=False),
        record("push", "watch", 3, in_time=False),  # made no difference: it was in the hand
    ]
    rows = rows_of(records)
    name = "disturbed at a random moment, verify watch"
    assert rows[name, "goal reached, or refused naming what happened"].value == 2 / 3
    assert rows[name, "goal reached, or refused naming what happened"].holds is False
    assert rows[name, "noticed before the next grasp"].value == 1 / 2
    assert rows[name, "noticed before the next grasp"].n == 2
    odd = details(records)
    assert [item["seed"] for item in odd["not_as_wanted"]] == [2]
    assert (
        odd["not_as_wanted"][0]["again"] == "make eval-disturbances KIND=push VERIFY=watch SEED=2"
    )


def test_undisturbed_tasks_are_compared_seed_by_seed() -> None:
    records = [
        record("nothing", "end", 1), record("nothing", "watch", 1, simulated_seconds=20.5),
        record("nothing", "end", 2, replans=1), record("nothing", "watch", 2),
        record("nothing", "end", 3, simulated_seconds=99.0),  # not run with watch yet
    ]  # fmt: skip
    rows = rows_of(records)
    ratio = rows["undisturbed, verify watch", "time of all tasks over that with verify end"]
    assert ratio.value == 40.5 / 40.0
    assert ratio.holds
    lost = rows[
        "undisturbed, verify watch", "grasps lost or blocks knocked: tasks that planned anew"
    ]
    assert (lost.value, lost.required, lost.holds) == (0, "<= 1", True)
