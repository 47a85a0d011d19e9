# SPDX-License-Identifier: Apache-2.0
"""Feedback of achieve_goal as lines in the terminal, with a bar while the arm moves."""

from __future__ import annotations

import sys
from typing import Final, TextIO

from tamp_interfaces.action import AchieveGoal
from tamp_interfaces.msg import MotionStatus

from ..loop.report import Stage
from .plan_text import describe_plan

STAGES: Final[dict[int, str]] = {
    Stage.PERCEIVING: "perceive",
    Stage.PLANNING: "plan",
    Stage.OPTIMISING: "optimise",
    Stage.EXECUTING: "execute",
    Stage.CONFIRMING: "confirm",
    Stage.CANCELLING: "cancel",
}
BAR_WIDTH: Final = 30


class ProgressPrinter:
    """Prints what changed; on a terminal the bar moves in its line, elsewhere it is left out."""

    def __init__(self, stream: TextIO = sys.stdout) -> None:
        self._stream = stream
        self._shown: tuple[object, ...] = ()
        self._plan_id = ""
        self._bar_is_open = False

    def show(self, feedback: AchieveGoal.Feedback) -> None:
        """Prints what is new in a feedback."""
        motion = feedback.motion
        moving = feedback.stage == Stage.EXECUTING and motion.state == MotionStatus.EXECUTING
        step = (motion.move, motion.phase) if moving else feedback.message
        if (feedback.stage, step) != self._shown:
            self._shown = (feedback.stage, step)
            text = _describe_step(motion) if moving else feedback.message
            self._line(f"{STAGES.get(feedback.stage, '?'):9} {text}")
        # Moves and scenes come once a plan, later only its name.
        if feedback.plan.moves and feedback.plan.plan_id != self._plan_id:
            self._plan_id = feedback.plan.plan_id
            for line in describe_plan(feedback.plan, feedback.states):
                self._line(f"{'':9} {line}")
        if moving and self._stream.isatty():
            done = round(BAR_WIDTH * motion.progress)
            bar = "#" * done + "-" * (BAR_WIDTH - done)
            self._stream.write(f"\r{'':9} [{bar}] {motion.progress:4.0%}")
            self._stream.flush()
            self._bar_is_open = True

    def finish(self) -> None:
        """Ends an open bar, so that what follows starts in a line of its own."""
        if self._bar_is_open:
            self._stream.write("\r\033[K")
            self._bar_is_open = False

    def _line(self, text: str) -> None:
        self.finish()
        self._stream.write(text + "\n")
        self._stream.flush()


def _describe_step(motion: MotionStatus) -> str:
    step = f"move {min(motion.move + 1, motion.moves_total)} of {motion.moves_total}"
    return f"{step}: {motion.phase} {motion.object_name}".rstrip(": ")
