# SPDX-License-Identifier: Apache-2.0
"""Before a look: nothing is carried out, and the arm rests at home with an empty hand.

An arm before the camera hides blocks, and one that moves changes what is seen.
"""

from __future__ import annotations

from collections.abc import Callable
from typing import Final

from tamp_runtime.motion_report import ArmPlace, MotionReason, MotionReport, MotionState

from ..errors import (
    ArmStuckError,
    ConflictError,
    MotionBusyError,
    MotionFailedError,
    MotionSilentError,
)
from ..settings import Settings
from .account import describe_arm
from .motion_link import STOP_AGAIN_SECONDS, MotionLink

#: What passes, or what the next look shows in another light: worth another try.
PASSING: Final = (
    MotionReason.GRASP_LOST,
    MotionReason.TRACKING_LOST,
    MotionReason.TIMEOUT,
    MotionReason.NO_JOINT_STATES,
    MotionReason.OBSTRUCTED,
    MotionReason.UNSEEN,
)
#: A motion node that lives says so once a second; its first word is waited for so long [s].
FIRST_REPORT_SECONDS: Final = 2.0
#: An arm that moves though no plan is under way has this long to come to rest [s].
REST_SECONDS: Final = 30.0
#: Before a first motion, news of an arm of which nothing is known is waited for so long [s]; then
#: the camera is asked all the same.
NEWS_SECONDS: Final = 8.0
#: How often the arm is asked to go home before it counts as stuck.
HOME_ATTEMPTS: Final = 3
#: A plan that still goes on after so many motion_silence_timeouts does not obey.
STOP_PATIENCE: Final = 8


class ArmHome:
    """Sees to it that a look makes sense.

    Args:
        tell: told what is being done, for people.
        because: told every failure that is tried over again.
        check: raises if the run is to end: CancelledError, ConflictError.
        stopped: whether ``check`` would raise.
    """

    def __init__(
        self,
        settings: Settings,
        motion: MotionLink,
        tell: Callable[[str], None],
        because: Callable[[str], None],
        check: Callable[[], None],
        stopped: Callable[[], bool],
    ) -> None:
        self._settings = settings
        self._motion = motion
        self._tell = tell
        self._because = because
        self._check = check
        self._stopped = stopped

    def settle(self, moved: bool) -> None:
        """Stops what this planner does not follow, waits until the arm rests, and brings it home.

        Args:
            moved: a motion has been asked for, so that an arm of which nothing is known may be on
                its way; before, it does not keep the camera from being asked.

        Raises:
            ArmStuckError: the arm cannot be brought home.
            MotionSilentError, MotionBusyError: the motion node does not answer, or does not stop.
            MotionFailedError: no joint states arrive after a motion.
            CancelledError, ConflictError: see ``check``.
        """
        motion = self._motion
        motion.wait(lambda: motion.silence is not None, FIRST_REPORT_SECONDS, self._stopped)
        attempts = 0
        while True:
            self._check()
            if foreign := motion.foreign:
                self._take_over(foreign)
            self._await_rest(moved)
            if motion.foreign:
                continue
            newest = motion.newest
            if newest.arm != ArmPlace.RESTING and not newest.held:
                return
            attempts += 1
            if self._go_home(newest, attempts):
                return

    def _take_over(self, plan_id: str) -> None:
        """Stops a plan that nobody follows any more, and waits until it has ended."""
        motion, limit = self._motion, self._settings.motion_silence_timeout
        self._tell(
            f"the motion node carries out plan {plan_id}, which this planner does not follow (was "
            "the planner restarted?): stopping it, waiting until the arm rests"
        )
        for _ in range(max(1, round(STOP_PATIENCE * limit / STOP_AGAIN_SECONDS))):
            motion.stop(plan_id)
            if motion.wait(lambda: motion.foreign != plan_id, STOP_AGAIN_SECONDS, self._stopped):
                break
            self._check()
        else:
            raise MotionBusyError(
                f"plan {plan_id}, which this planner does not follow, does not end though it was "
                "asked to stop; restart motion_node",
                plan_id,
            )
        if (motion.silence or 0.0) >= limit:
            raise MotionSilentError(
                f"the motion node carried out plan {plan_id}, which this planner does not follow, "
                f"and reports nothing any more (waited {limit:g} s); is motion_node running?",
                plan_id,
                taken_up=True,
                speaks=False,
            )

    def _await_rest(self, moved: bool) -> None:
        """Waits for an arm that moves, or of which nothing is known, while nothing is reported."""
        motion, settings = self._motion, self._settings
        if not motion.knows_arm:
            return
        news = settings.perceive_timeout if moved else min(NEWS_SECONDS, settings.perceive_timeout)
        unknown = (ArmPlace.UNKNOWN, news, "waiting for news of the arm")
        moving = (ArmPlace.MOVING, REST_SECONDS, "waiting for the arm to rest")
        for place, seconds, doing in (unknown, moving, unknown):
            if motion.newest.arm == place:
                self._tell(f"{doing}: {describe_arm(motion.newest, motion.silence)}")
                came = self._await_other(place, seconds)
                self._check()
                if not came:
                    break
        silence = motion.silence or 0.0
        if moved and motion.newest.arm == ArmPlace.UNKNOWN and not motion.foreign:
            if silence < settings.perceive_timeout:
                raise MotionFailedError(
                    "no joint_states that can be used arrive (waited "
                    f"{settings.perceive_timeout:g} s), so nobody knows where the arm is; is the "
                    "arm's driver (or sim_node) running?"
                )
            raise MotionSilentError(
                f"the motion node reports nothing any more (for {silence:.0f} s); is motion_node "
                "running, and does motion_status reach this node?",
                "",
                taken_up=True,
                speaks=False,
            )

    def _await_other(self, place: ArmPlace, seconds: float) -> bool:
        motion = self._motion
        return motion.wait(
            lambda: motion.newest.arm != place or bool(motion.foreign), seconds, self._stopped
        )

    def _go_home(self, newest: MotionReport, attempts: int) -> bool:
        """Asks for the way home; False: that failed, and may be tried once more."""
        where = describe_arm(newest)
        self._tell(f"bringing the arm home before looking: {where}")
        self._motion.go_home()
        try:
            end = self._motion.follow(lambda _: None, self._stopped)
        except MotionSilentError as error:
            if not error.taken_up:
                raise
            end, problem, passing = None, str(error), error.speaks
        else:
            if end is None:
                self._motion.forget()
                self._check()
                return False
            if end.state != MotionState.FAILED:
                return True
            problem, passing = end.message or end.reason.name, end.reason in PASSING
            if end.reason == MotionReason.CONFLICT:
                raise ConflictError(problem)
        if passing and attempts < HOME_ATTEMPTS:
            self._because(f"the arm could not be brought home: {problem}")
            return False
        raise ArmStuckError(
            f"the arm cannot be brought home with an empty hand: {problem}. Clear its way, or take "
            "what it holds out of its hand and move it home by hand, then ask again"
        )
