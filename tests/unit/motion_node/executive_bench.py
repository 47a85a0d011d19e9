# SPDX-License-Identifier: Apache-2.0
"""An executive with its neighbours."""

from __future__ import annotations

import threading
from collections.abc import Callable, Iterator

import numpy as np
from simulated_arm import HOME_Q, OPEN, PLAN, FakePlanner, SimulatedArm, planned
from tamp_runtime.motion_report import MotionReport

from motion_node.execution.condition import Condition
from motion_node.execution.corrections import Correct
from motion_node.execution.executive import Executive
from motion_node.execution.follow import Follower
from motion_node.execution.last_look import Sightings
from motion_node.execution.plan import Plan
from motion_node.execution.settings import ExecutionSettings
from motion_node.planner import Motion


def rest_of(now: Motion, at: float) -> Motion:
    """What is left of a motion, as a correction that changes nothing."""
    return planned(now.trajectory.cut(at, now.trajectory.duration))


class Bench:
    """An executive with its neighbours, and what it reported."""

    def __init__(self, arm: SimulatedArm | None = None) -> None:
        self.arm, self.planner = arm or SimulatedArm(), FakePlanner()
        self.reports: list[MotionReport] = []
        self.stop, self.plan = threading.Event(), PLAN
        self.planners: Iterator[FakePlanner | None] = iter(lambda: self.planner, 0)
        self.settings = ExecutionSettings()
        self.conflict, self.suggestion = "", ""
        self.in_the_way: Callable[[float], str] = lambda _at: ""
        self.follower = Follower(self.arm, self.arm.send, self.settings)
        self.condition = Condition(
            self.arm, lambda: self.follower.grip, HOME_Q, OPEN, lambda q: np.array([*q, 0.5])
        )
        self.sightings = Sightings()
        self.correct: Correct = lambda now, at, _graph: rest_of(now, at)
        self.executive = Executive(
            lambda: next(self.planners),
            self.arm,
            self.follower,
            self.condition,
            lambda: self.settings,
            lambda: self.conflict,
            suggest=lambda *_: self.suggestion,
            in_the_way=lambda _plan, _motion, at: self.in_the_way(at),
            sightings=self.sightings,
            correct=lambda *asked: self.correct(*asked[3:]),
        )

    def carry_out(self, plan: Plan = PLAN) -> MotionReport:
        """Carries the two moves out; the report that ends them, and how the arm is then."""
        self.reports.clear()
        self.executive.carry_out(plan, self.stop, self.reports.append)
        ends = [report for report in self.reports if report.state.ended]
        assert ends == self.reports[-1:], "there is one end, and nothing after it"
        assert self.executive.report == ends[0]
        return self.condition.told_in(ends[0])

    def when(
        self, phase: str, move: int, action: Callable[[], object], progress: float = 0
    ) -> None:
        """Does something as soon as that phase is reported."""

        def there() -> bool:
            report = self.executive.report
            return (report.phase, report.move) == (phase, move) and report.progress > progress

        self.arm.when(there, action)
