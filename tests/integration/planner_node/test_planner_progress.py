# SPDX-License-Identifier: Apache-2.0
"""How progress is shown to people: lines in a file, a bar in a terminal."""

from __future__ import annotations

import io

from builtin_interfaces.msg import Time
from planner_neighbours import scene_message
from tamp_interfaces.action import AchieveGoal
from tamp_interfaces.msg import MotionStatus, Move, SymbolicPlan

from planner_node.cli.plan_text import describe_plan
from planner_node.cli.progress import ProgressPrinter

Feedback = AchieveGoal.Feedback

PLAN = SymbolicPlan(
    plan_id="abc",
    initial=scene_message((("red_box",), ()), Time()),
    moves=[Move(source=0, target=1, object_name="red_box")],
)
STATES = [scene_message(((), ("red_box",)), Time())]


class Terminal(io.StringIO):
    def isatty(self) -> bool:
        return True


def moving(progress: float, phase: str = "pick", plan: bool = True) -> AchieveGoal.Feedback:
    motion = MotionStatus(
        state=MotionStatus.EXECUTING,
        moves_total=1,
        phase=phase,
        object_name="red_box",
        progress=progress,
    )
    if not plan:  # all feedback but the first on a plan
        later = SymbolicPlan(plan_id=PLAN.plan_id)
        return Feedback(stage=Feedback.EXECUTING, motion=motion, plan=later)
    return Feedback(stage=Feedback.EXECUTING, motion=motion, plan=PLAN, states=STATES)


def test_progress_prints_what_is_new() -> None:
    stream = io.StringIO()
    printer = ProgressPrinter(stream)
    for _ in range(2):
        printer.show(Feedback(stage=Feedback.PERCEIVING, message="reading the goal"))
    for progress in (0.1, 0.2):
        printer.show(moving(progress))
    printer.show(moving(0.3, "place", plan=False))
    printer.finish()
    assert stream.getvalue().splitlines() == [
        "perceive  reading the goal",
        "execute   move 1 of 1: pick red_box",
        *[f"{'':9} {line}" for line in describe_plan(PLAN, STATES)],
        "execute   move 1 of 1: place red_box",
    ]


def test_a_terminal_gets_a_bar_that_makes_room_for_the_next_line() -> None:
    stream = Terminal()
    printer = ProgressPrinter(stream)
    printer.show(moving(0.5))
    assert stream.getvalue().endswith("[###############---------------]  50%")
    printer.finish()
    assert stream.getvalue().endswith("\r\033[K")
