# SPDX-License-Identifier: Apache-2.0
"""What the motion node has found impossible in one run, and plans without it.

Motions are optimised for a whole plan before anything moves. So a plan that is refused costs no
look: another one is made for the same scene, without the refused move.
"""

from __future__ import annotations

from collections.abc import Callable
from typing import Final

from tamp_runtime.motion_report import Excludes, MotionReason, MotionReport, MotionState

from ..goals.goal import Goal
from ..search import SearchResult
from ..search.possible import Exclusion
from ..settings import Settings
from .plan import Plan
from .scene import Scene
from .scene_plan import given_plan_in, plan_in, uncover_in

#: So many refusals in one scene; then it is given up like any other motion that fails.
MOST: Final = 60


class PossibleMoves:
    """The moves that were refused, in order.

    Attributes:
        given: another planner's plan, which is taken in place of the first search.
        just_refused: whether the newest plan was.
        first_refused: the first plan in the present scene that was; shortest, had it been possible.
    """

    def __init__(self, settings: Settings, cancelled: Callable[[], bool]) -> None:
        self._settings, self._cancelled = settings, cancelled
        self._exclusions: list[Exclusion] = []
        self.just_refused = False
        self.given = ""
        self.first_refused: Plan | None = None
        self._again = True

    def refused(self, plan: Plan, report: MotionReport) -> Exclusion | None:
        """The exclusion that a report on a plan comes to, if the plan can be made without it."""
        self.just_refused = False
        if report.state != MotionState.FAILED or report.reason != MotionReason.INFEASIBLE:
            return None
        if report.moves_done or len(self._exclusions) >= MOST:
            return None
        exclusion = exclusion_of(plan, report)
        if exclusion is not None:
            if not self._exclusions:
                self.first_refused = plan
            self._exclusions.append(exclusion)
            self.just_refused = True
        return exclusion

    def plan(self, scene: Scene, goal: Goal) -> SearchResult:
        """The plan that was given, the first time; then a shortest one without what was refused.

        Raises:
            PlannerError: as the search; GivenPlanError where the plan that was given does not hold;
                ImpossibleError where only refused moves lead to the goal.
        """
        if self.given:
            text, self.given = self.given, ""
            return given_plan_in(scene, text, goal, self._settings)
        return plan_in(scene, goal, self._settings, self._cancelled, self._exclusions)

    def uncover(self, scene: Scene, goal: Goal | None) -> SearchResult:
        """The fewest moves that uncover what is hidden; see :func:`uncover_in`."""
        return uncover_in(scene, goal, self._settings, self._cancelled, self._exclusions)

    def forget_once(self) -> bool:
        """Forgets all, once: poses that are seen anew may be possible. False: not again."""
        again, self._again = self._again, False
        if again:
            self._exclusions.clear()
            self.just_refused = False
        return again


def exclusion_of(plan: Plan, report: MotionReport) -> Exclusion | None:
    """What the refusal of a plan excludes; None where the motion node does not tell."""
    if report.excludes not in set(Excludes) or report.move >= len(plan.moves):
        return None
    move, state = plan.moves[report.move], plan.states[report.move]
    block, kind = state[move.source][-1], Excludes(report.excludes)
    unit = f"{1000 * report.violation:.0f} mm missing"
    reason = f"{report.constraint}, {unit} ({report.bound} of the {report.phase or 'way'})"
    source, under = move.source, state[move.source][:-1]
    target, onto = move.target, state[move.target]
    if kind is Excludes.TAKING:
        return Exclusion(block, source=source, under=under, reason=reason)
    if kind is Excludes.PUTTING:
        return Exclusion(block, target=target, onto=onto, reason=reason)
    only = state if kind is Excludes.SCENE else None
    return Exclusion(block, source, under, target, onto, only, reason)
