# SPDX-License-Identifier: Apache-2.0
"""Whether what happened was noticed before the arm took the next block, by what the nodes say."""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from typing import Final

from tamp_runtime.motion_report import MotionReason, MotionReport, MotionState

from motion_node.timing.time_paths import TimingSettings

#: Before a block is taken fingers have been closing for at least so long: what happens meanwhile
#: happens during this grasp, and before the next one [ns].
CLOSING: Final = round(1e9 * TimingSettings().close_seconds)


def grasps(reports: Iterable[MotionReport]) -> list[int]:
    """When blocks were taken [ns]: where a move's place begins for the first time."""
    taken: dict[tuple[str, int], int] = {}
    for report in reports:
        if report.state is MotionState.EXECUTING and report.phase == "place":
            taken.setdefault((report.plan_id, report.move), report.stamp)
    return sorted(taken.values())


def carried_between(reports: Iterable[MotionReport], begin: int, end: int) -> frozenset[str]:
    """The blocks that were in the hand at some moment between two [ns]."""
    carried, held = set(), ""
    for report in reports:
        if report.stamp > end:
            break
        if report.stamp >= begin:
            carried.add(held)
        held = report.held or (report.object_name if report.phase == "place" else "")
        if report.stamp >= begin:
            carried.add(held)
    return frozenset({*carried, held} - {""})


def noticed_at(reports: Sequence[MotionReport], stops: Iterable[int], after: int) -> int | None:
    """When something was first found to be wrong after a moment [ns]; None: it was not.

    That is where the planner asks the arm to stop, the motion node gives a plan up, or, at the
    latest, another plan than that of this moment is begun.

    Args:
        reports: of the motion node, in order.
        stops: when the planner asked for a stop [ns].
    """
    found = [stamp for stamp in stops if stamp > after]
    plan_id = next((item.plan_id for item in reversed(reports)
                    if item.plan_id and item.stamp <= after), "")  # fmt: skip
    for report in reports:
        if report.stamp <= after or not report.plan_id or report.plan_id.startswith("home-"):
            continue
        given_up = report.state is MotionState.EXECUTING and report.phase == "home"
        given_up = given_up and report.moves_done < report.moves_total
        if (
            given_up
            or report.state is MotionState.FAILED
            or (plan_id and report.plan_id != plan_id)
        ):
            found.append(report.stamp)
            break
    return min(found, default=None)


def grasps_after(
    reports: Iterable[MotionReport], after: int, passed: int = 0, under_way: bool = False
) -> list[int]:
    """When blocks were taken after a moment [ns], in grasps that began after it.

    Args:
        under_way: also in the one whose fingers were closing then.
        passed: the first of them, as many as belong to what happened: a block slips out of the
            hand that has just taken it, or fingers that are jammed do not take it.
    """
    since = after if under_way or passed else after + CLOSING
    return [stamp for stamp in grasps(reports) if stamp > since][passed:]


def noticed_in_time(
    reports: Sequence[MotionReport],
    stops: Iterable[int],
    after: int,
    passed: int = 0,
    under_way: bool = False,
) -> bool | None:
    """Whether it was noticed before the next block was taken; None where neither came.

    Args: see :func:`grasps_after`.
    """
    later = grasps_after(reports, after, passed, under_way)
    noticed = noticed_at(reports, stops, after)
    if noticed is None:
        return False if later else None
    return not later or noticed < later[0]


def grasps_lost(reports: Iterable[MotionReport]) -> int:
    """How many plans ended with a grasp that was lost."""
    return len({report.plan_id for report in reports
                if report.state is MotionState.FAILED
                and report.reason is MotionReason.GRASP_LOST})  # fmt: skip
