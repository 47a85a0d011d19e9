# SPDX-License-Identifier: Apache-2.0
"""Sends one trajectory after the other and watches each to its end."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, field

import numpy as np
from tamp_runtime.motion_report import MotionReason

from ..errors import MotionError
from ..robots.joints import JointValues
from ..timing.trajectory import Interval, Trajectory
from .arm_state import ArmState, ArmStates
from .monitor import Monitor, MonitorSettings, Verdict


@dataclass(frozen=True)
class ExecutionSettings:
    """Time limits, in wall time unless said otherwise [s].

    Attributes:
        joint_state_timeout: silence of the joint states that is taken for their end.
        description_timeout: for the robot description to arrive.
        rest_timeout: for the arm to come to rest before a plan is taken up.
        rest_seconds: standing still for this long counts as rest, by the joint states' stamps.
        clock_timeout: joint states whose stamps stand still for this long.
        execution_factor: of the trajectory's duration, plus 30 s, as the limit of an execution.
        brake_seconds: in which a moving arm comes to rest.
    """

    joint_state_timeout: float = 3.0
    description_timeout: float = 10.0
    rest_timeout: float = 60.0
    rest_seconds: float = 0.8
    clock_timeout: float = 5.0
    execution_factor: float = 20.0
    brake_seconds: float = 0.4
    monitor: MonitorSettings = field(default_factory=MonitorSettings)


class ExecutionError(MotionError):
    """The execution ends here; ``reason`` is what is reported.

    ``recoverable``: the arm obeys, so it can be sent home.
    """

    def __init__(self, reason: MotionReason, message: str, recoverable: bool = False) -> None:
        super().__init__(message)
        self.reason = reason
        self.recoverable = recoverable


_SENTENCES = {
    Verdict.NOT_STARTED: "the arm does not start; its controller may have refused the trajectory",
    Verdict.OFF_THE_PATH: "the arm has left its path; something may hold it",
    Verdict.BEHIND: "the arm falls behind its trajectory; something may hold it",
    Verdict.NOT_ARRIVED: "the arm does not reach the end of its trajectory",
    Verdict.CLOCK_WENT_BACK: "the joint states' time went back; was the simulator restarted?",
}


class Follower:
    """The arm as something that follows trajectories.

    Args:
        arm: where the arm's states arrive.
        send: publishes a trajectory, which replaces the running one.
    """

    #: How far ahead of the arm a replacement for a running trajectory starts [s].
    LEAD = 0.03
    #: How far an arm joint may be from a trajectory's first point when it is sent [rad].
    START_TOLERANCE = 0.05

    def __init__(
        self, arm: ArmStates, send: Callable[[Trajectory], None], settings: ExecutionSettings
    ) -> None:
        self._arm, self._send = arm, send
        self.settings = settings
        self._trajectory: Trajectory | None = None
        self.time = 0.0

    @property
    def interval(self) -> Interval:
        """What the running trajectory does now."""
        assert self._trajectory is not None
        return self._trajectory.interval_at(self.time)

    @property
    def let_go(self) -> bool:
        """Whether the fingers have just opened around a block that was put down."""
        interval = self.interval
        if not (interval.phase.tool.held and interval.gripping):
            return False
        return self.time > interval.start + 0.8 * (interval.end - interval.start)

    @property
    def empty_handed(self) -> bool:
        """Whether the hand holds nothing; fingers that only begin to close hold nothing yet."""
        return not self.interval.phase.tool.held or self.let_go

    def next_state(self, after: ArmState | None) -> ArmState:
        """Waits for news of the arm.

        Raises:
            ExecutionError: if joint states stay out.
        """
        state = self._arm.wait(after, self.settings.joint_state_timeout)
        if state is None:
            raise self._silence()
        return state

    def _silence(self) -> ExecutionError:
        return ExecutionError(
            MotionReason.NO_JOINT_STATES,
            f"no joint_states for {self.settings.joint_state_timeout:g} s; is the arm's driver (or "
            "sim_node) running?",
        )

    def wait_for_rest(self, stopped: Callable[[], bool]) -> ArmState | None:
        """The newest state as soon as the arm stands still; None if ``stopped`` says so.

        Only an arm at rest can start a trajectory: another one may still be under way, sent by
        this node before it was restarted.

        Raises:
            ExecutionError: if it does not come to rest, or joint states stay out.
        """
        deadline = self._arm.now() + self.settings.rest_timeout
        heard = self._arm.now()
        state = self._arm.newest()
        fresh = state is not None and heard - state.received < self.settings.joint_state_timeout
        while not stopped():
            if state is not None and fresh and state.resting >= self.settings.rest_seconds:
                return state
            now = self._arm.now()
            if now > deadline:
                raise ExecutionError(
                    MotionReason.TIMEOUT,
                    "the arm does not come to rest, so no trajectory can start",
                )
            news = self._arm.wait(state, 0.1)
            if news is not None:
                state, heard, fresh = news, now, True
            elif now - heard > self.settings.joint_state_timeout:
                raise self._silence()
        return None

    def follow(
        self,
        trajectory: Trajectory,
        on_progress: Callable[[Trajectory, float], None] = lambda _trajectory, _time: None,
        stopped: Callable[[], bool] = lambda: False,
    ) -> bool:
        """Sends a trajectory and watches it; True when the arm has arrived at its end.

        Args:
            on_progress: told the trajectory's time after each joint state.
            stopped: polled after each joint state of an arm that has started; returns False at
                once when it says so, with the trajectory still running.

        Raises:
            ExecutionError: if it does not go as it should.
        """
        begin = moving = self._arm.now()
        limit = self.settings.execution_factor * trajectory.duration + 30.0
        # Not the state from which the motion was optimised: that took a while.
        state = self._arm.newest()
        assert state is not None, "a trajectory starts from a state"
        away, _ = state.positions.furthest(trajectory.positions[0])
        if away > self.START_TOLERANCE:
            raise ExecutionError(
                MotionReason.TRACKING_LOST,
                "the arm has moved while its motion was optimised; let it rest, and ask again",
            )
        monitor = Monitor(trajectory, state, self.settings.monitor)
        self._trajectory, self.time = trajectory, 0.0
        self._send(trajectory)
        while True:
            previous, state = state, self.next_state(state)
            verdict = monitor.update(state)
            self.time = monitor.time
            on_progress(trajectory, monitor.time)
            if verdict is Verdict.ARRIVED:
                return True
            if verdict is not Verdict.GOING:
                self._object(verdict, state)
            # An arm that has not started may not have the trajectory yet, and rest before it.
            if monitor.started and stopped():
                return False
            now = self._arm.now()
            moving = now if state.stamp > previous.stamp else moving
            if now - moving > self.settings.clock_timeout:
                raise ExecutionError(
                    MotionReason.TIMEOUT,
                    "the joint states' time stands still; is the clock running?",
                )
            if now - begin > limit:
                raise ExecutionError(
                    MotionReason.TIMEOUT,
                    f"the execution takes longer than {limit:.0f} s; is the clock running?",
                )

    def brake(self) -> ArmState:
        """Comes to rest along the running trajectory; returns the arm's state then.

        Raises:
            ExecutionError: if the arm does not come to rest, or joint states stay out.
        """
        assert self._trajectory is not None
        begin = min(self.time + self.LEAD, self._trajectory.duration)
        self._trajectory = self._trajectory.brake(begin, self.settings.brake_seconds)
        self.time = 0.0
        self._send(self._trajectory)
        first = state = self.next_state(None)
        deadline = self._arm.now() + self.settings.brake_seconds + 5.0
        while min(state.resting, state.stamp - first.stamp) < 0.15:
            if self._arm.now() > deadline:
                raise ExecutionError(
                    MotionReason.TRACKING_LOST, "the arm does not stop when asked to"
                )
            state = self.next_state(state)
        return state

    def _object(self, verdict: Verdict, state: ArmState) -> None:
        phase = self.interval.phase
        if verdict is Verdict.GRASP_LOST:
            raise ExecutionError(
                MotionReason.GRASP_LOST,
                f"the fingers closed on nothing or lost {phase.object_name}",
                recoverable=True,
            )
        self._hold(state)
        while_doing = f"{phase.kind} of {phase.object_name}" if phase.object_name else "way home"
        raise ExecutionError(
            MotionReason.TRACKING_LOST,
            f"{_SENTENCES[verdict]} ({while_doing})",
            recoverable=verdict in (Verdict.OFF_THE_PATH, Verdict.BEHIND) and self.empty_handed,
        )

    def _hold(self, state: ArmState) -> None:
        """Stays where the arm is; fingers that press go on pressing."""
        assert self._trajectory is not None
        pressing = self._trajectory.sample(self.time)[0].fingers
        arm, fingers = np.tile(state.positions.arm, (2, 1)), np.tile(pressing, (2, 1))
        hold = Trajectory(
            np.array([0.0, 0.5]),
            JointValues(arm, fingers),
            JointValues(np.zeros_like(arm), np.zeros_like(fingers)),
            (Interval(0.0, 0.5, self.interval.phase, self.interval.gripping),),
        )
        self._trajectory, self.time = hold, 0.0
        self._send(hold)
