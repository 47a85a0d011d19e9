# SPDX-License-Identifier: Apache-2.0
"""Follows a motion to its end: corrected for blocks that are moved, and with a last look."""

from __future__ import annotations

from collections.abc import Callable

from tamp_runtime.motion_report import MotionReason

from ..planner import Motion
from ..timing.trajectory import Interval, Trajectory
from .arm_state import ArmStates
from .corrections import Corrections, needs_a_stop
from .errors import ExecutionError
from .follow import Follower
from .last_look import GIVES_UP, OVER, LastLook, grasp_ahead


class MotionRun:
    """One motion.

    Args:
        arm: where the arm's states arrive.
        look: whether the next block was seen; None: the plan is not watched.
        corrections: of the motion for blocks that are moved; None: there are none.
        on_progress: told the motion, its time, and how much time other motions took before it,
            after each joint state.
        say: told a sentence where the arm stands and waits.
        stopped: whether to stop, where the hand is empty.

    Attributes:
        motion: what is under way: the one that was begun, or what it was corrected to.
    """

    def __init__(
        self,
        motion: Motion,
        follower: Follower,
        arm: ArmStates,
        look: LastLook | None,
        corrections: Corrections | None,
        on_progress: Callable[[Motion, float, float], None],
        say: Callable[[str], None],
        stopped: Callable[[], bool],
    ) -> None:
        self.motion = motion
        self._follower, self._arm = follower, arm
        self._look, self._corrections = look, corrections
        self._on_progress, self._say, self._stopped = on_progress, say, stopped
        # What is left of the motion, from when on, and what was before it [s].
        self._left, self._from, self._before = motion.trajectory, 0.0, 0.0

    def run(self) -> bool:
        """True when the arm has arrived at its end; False once it is to stop, still under way.

        Raises:
            ExecutionError: if it does not go as it should, or the next block is not seen.
        """
        follower, moving = self._follower, False
        while not follower.follow(self._left, self._tell, self._leaves, moving):
            if self._may_stop():
                return False
            moving = self._is_corrected()
            if not moving and not self._stood():
                return False
        return True

    @property
    def _time(self) -> float:
        return self._from + self._follower.time

    def _tell(self, _trajectory: Trajectory, _at: float) -> None:
        self._on_progress(self.motion, self._time, self._before)

    def _leaves(self) -> bool:
        return self._may_stop() or self._may_correct() or self._is_unseen()

    def _may_stop(self) -> bool:
        # Where the fingers are letting go of a block the arm stands: it is put down then.
        follower = self._follower
        return self._stopped() and (follower.empty_handed or not follower.interval.gripping)

    def _may_correct(self) -> bool:
        return self._corrections is not None and self._corrections.is_due(self.motion, self._time)

    def _is_corrected(self) -> bool:
        """Goes over to a correction, if one is due."""
        if self._corrections is None or not self._may_correct():
            return False
        found = self._corrections.take()
        self._before += found.begins
        self.motion, self._left, self._from = found.motion, found.motion.trajectory, 0.0
        return True

    def _is_unseen(self) -> bool:
        state = self._arm.newest()
        if self._look is None or state is None:
            return False
        return self._look.is_missing(self._follower, self._left, state)

    def _stood(self) -> bool:
        """Stands at the next block until it is seen, above it if the hand hides it; False: stop."""
        grasp = grasp_ahead(self._left, self._follower.time)
        assert grasp is not None and self._look is not None
        self._follower.stand_before(grasp)
        if not self._wait_until_seen(grasp, self._look):
            return False
        self._look.close(grasp.phase.move)
        self._from += grasp.start
        self._left = self._left.cut(grasp.start, self._left.duration)
        return True

    def _wait_until_seen(self, grasp: Interval, look: LastLook) -> bool:
        name, move = grasp.phase.object_name, grasp.phase.move
        self._say(f"looking whether {name} is where it is to be taken")
        first: float | None = None
        way = self._left.interval_at(grasp.start - 1e-6)
        over, risen = max(way.start, grasp.start - OVER), False
        for state in self._follower.states():
            if self._stopped():
                return False
            if self._corrections and name in {item.name for item in self._corrections.wanted}:
                raise needs_a_stop(name, "the hand is there already")
            first = state.stamp if first is None else first
            if look.allows(move, state, state.stamp - first):
                break
            if not risen and look.is_hidden(move, first):
                risen = True
                self._follower.go_along(self._left.back(grasp.start, over))
                continue
            if state.stamp - first > GIVES_UP:
                raise ExecutionError(
                    MotionReason.UNSEEN,
                    f"{name} was not seen for {GIVES_UP:g} s where it is to be taken",
                    recoverable=True,
                )
        if risen:
            self._follower.go_along(self._left.back(over, grasp.start))
        self._say(f"picking {name}")
        return True
