# SPDX-License-Identifier: Apache-2.0
"""Follows a motion to its end, and stands before a grasp until the block was seen there."""

from __future__ import annotations

from collections.abc import Callable

from tamp_runtime.motion_report import MotionReason

from ..planner import Motion
from ..timing.trajectory import Interval, Trajectory
from .arm_state import ArmStates
from .errors import ExecutionError
from .follow import Follower
from .last_look import GIVES_UP, LastLook, grasp_ahead


class MotionRun:
    """One motion.

    Args:
        arm: where the arm's states arrive.
        look: whether the next block was seen; None: the plan is not watched.
        on_progress: told the motion and its time after each joint state.
        say: told a sentence where the arm stands and waits.
        stopped: whether to stop, where the hand is empty.
    """

    def __init__(
        self,
        follower: Follower,
        arm: ArmStates,
        look: LastLook | None,
        on_progress: Callable[[Motion, float], None],
        say: Callable[[str], None],
        stopped: Callable[[], bool],
    ) -> None:
        self._follower, self._arm, self._look = follower, arm, look
        self._on_progress, self._say, self._stopped = on_progress, say, stopped

    def run(self, motion: Motion) -> bool:
        """True when the arm has arrived at its end; False once it is to stop, still under way.

        Raises:
            ExecutionError: if it does not go as it should, or the next block is not seen.
        """
        follower, trajectory, begins = self._follower, motion.trajectory, 0.0

        def on_progress(_trajectory: Trajectory, at: float) -> None:
            self._on_progress(motion, begins + at)

        def leaves() -> bool:
            return self._may_stop() or self._is_unseen(trajectory)

        while True:
            if follower.follow(trajectory, on_progress, leaves):
                return True
            grasp = grasp_ahead(trajectory, follower.time)
            if self._may_stop() or grasp is None or self._look is None:
                return False
            follower.stand_before(grasp)
            if not self._wait_until_seen(grasp):
                return False
            self._look.close(grasp.phase.move)
            begins += grasp.start
            trajectory = trajectory.cut(grasp.start, trajectory.duration)

    def _may_stop(self) -> bool:
        return self._stopped() and self._follower.empty_handed

    def _is_unseen(self, trajectory: Trajectory) -> bool:
        state = self._arm.newest()
        if self._look is None or state is None:
            return False
        return self._look.is_missing(self._follower, trajectory, state)

    def _wait_until_seen(self, grasp: Interval) -> bool:
        """False: it is to stop."""
        assert self._look is not None
        name, move = grasp.phase.object_name, grasp.phase.move
        self._say(f"looking whether {name} is where it is to be taken")
        first: float | None = None
        for state in self._follower.states():
            if self._stopped():
                return False
            first = state.stamp if first is None else first
            if self._look.allows(move, state, state.stamp - first):
                break
            if state.stamp - first > GIVES_UP:
                raise ExecutionError(
                    MotionReason.UNSEEN,
                    f"{name} was not seen for {GIVES_UP:g} s where it is to be taken",
                    recoverable=True,
                )
        self._say(f"picking {name}")
        return True
