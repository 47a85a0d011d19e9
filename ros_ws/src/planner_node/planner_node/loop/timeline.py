# SPDX-License-Identifier: Apache-2.0
"""Which step of a plan was under way when, as far as the motion node's reports tell."""

from __future__ import annotations

from typing import Final

from tamp_runtime.motion_report import MotionReport, MotionState

#: A step may have begun this much before the report that says so was stamped: that comes late, and
#: the times are those of different nodes [ns].
LATE: Final = 500_000_000
#: What it put down has come to rest this much after the report that it ended [ns].
SETTLED: Final = 200_000_000


class Timeline:
    """The steps of a plan of n moves: 2k is the pick of move k, 2k + 1 its place, 2n the way home.

    Attributes:
        off_course: the motion node has given the plan up, or does something else first; what is
            predicted of the plan says nothing any more.
    """

    def __init__(self, moves: int) -> None:
        self._moves = moves
        self._begun: list[tuple[int, int]] = [(0, 0)]
        self.off_course = False

    @property
    def newest(self) -> int:
        """The last step that was heard of."""
        return self._begun[-1][0]

    def note(self, report: MotionReport) -> None:
        """Takes a report on the plan."""
        if report.state.ended:
            self.off_course = True
        if report.state != MotionState.EXECUTING or not report.phase:
            return
        if report.phase == "home" and report.moves_done < self._moves:
            self.off_course = True
            return
        step = 2 * self._moves
        if report.phase != "home":
            step = 2 * report.move + (report.phase == "place")
        if step > self.newest:
            self._begun.append((step, report.stamp))

    def steps_at(self, stamp: int) -> range:
        """The steps that may have been under way at a time [ns]; those between were, too."""
        first, last = self._begun[0][0], self._begun[0][0]
        for step, begun in self._begun[1:]:
            if begun + SETTLED < stamp:
                first = step
            if begun - LATE <= stamp:
                last = step
        return range(first, last + 1)
