# SPDX-License-Identifier: Apache-2.0
"""Sends one trajectory after the other and watches each to its end."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from dataclasses import replace
from typing import Final

import numpy as np
from tamp_runtime.motion_report import MotionReason

from ..phases import HOME, Phase, Tool
from ..robots.joints import JointValues
from ..timing.trajectory import Interval, Trajectory
from .arm_state import ArmState, ArmStates
from .condition import Grip
from .errors import ExecutionError
from .in_step import InStep, first_moment
from .monitor import Monitor, Verdict
from .objections import objection
from .patience import NOTICE_SECONDS, Patience
from .settings import ExecutionSettings

#: A state older than this does not tell where the arm is now [s].
_FRESH_SECONDS: Final = 1.0
#: Fingers that were told to close and have not moved by then are held apart [s].
FEEL_SECONDS: Final = 3.0
#: After so long an arm has begun to do what it was told [s].
_OBEYS_SECONDS: Final = 0.1
#: The least that is left of a trajectory that ends before a grasp [s].
_SHORTEST_SECONDS: Final = 0.01
#: What an arm does that has not been given a trajectory.
_NOTHING: Final = Phase(HOME, 0, "", None, None, Tool(0.0, 0.0, 0.0), (), 0.0)


class Follower:
    """The arm as something that follows trajectories.

    Args:
        arm: where the arm's states arrive.
        send: publishes a trajectory, which replaces the running one, and when it begins by the
            clock of the arm's driver [s]; None: at once.
        missing: which controller nobody can reach, in a sentence; empty: none.

    Attributes:
        settings: may be changed between trajectories.
        on_waiting: told a sentence when something has been awaited for a while, and an empty one
            when it is there.
        grip: what is known of the hand; any thread may read it.
        under_way: whether the arm moves along a trajectory that can be braked.
        let_go_of: the block that the running trajectory has put down last; empty: none.
        moves_done: of the motion that the running trajectory belongs to.
    """

    #: How far ahead of the arm a replacement for a running trajectory starts [s].
    LEAD = 0.03
    #: How far an arm joint may be from a trajectory's first point when it is sent [rad].
    START_TOLERANCE = 0.05
    #: An arm that went on unseen and is found this near to a path is on it [rad].
    ON_THE_PATH = 0.05

    def __init__(
        self,
        arm: ArmStates,
        send: Callable[[Trajectory, float | None], None],
        settings: ExecutionSettings,
        missing: Callable[[], str] = lambda: "",
    ) -> None:
        self._arm, self._send, self._missing = arm, send, missing
        self.settings = settings
        self.on_waiting: Callable[[str], None] = lambda _sentence: None
        self.grip = Grip()
        self._trajectory: Trajectory | None = None
        self.under_way, self.let_go_of, self.moves_done = False, "", 0
        self.time = self._stamp = 0.0
        self._judged = False  # what the hand holds is known from its fingers

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

    def wait_for_rest(
        self,
        stopped: Callable[[], bool] = lambda: False,
        seconds: float | None = None,
        within: float | None = None,
    ) -> ArmState | None:
        """The newest state as soon as the arm stands still; None if ``stopped`` says so.

        Only an arm at rest can start a trajectory: another one may still be under way, sent by
        this node before it was restarted.

        Args:
            seconds: for how long it has to stand still; the settings' rest_seconds if not given.
            within: how long to wait for it; the settings' rest_timeout if not given [s].

        Raises:
            ExecutionError: if it does not come to rest, or joint states stay out.
        """
        rest = self.settings.rest_seconds if seconds is None else seconds
        deadline = self._arm.now() + (self.settings.rest_timeout if within is None else within)
        patience, state, last = self._patience(), self._newest_if_fresh(), self._arm.newest()
        while not stopped():
            if state is not None and state.resting >= rest:
                return self._settled(state)
            if self._arm.now() > deadline:
                raise ExecutionError(
                    MotionReason.TIMEOUT,
                    "the arm does not come to rest, so no trajectory can start",
                )
            if (news := patience.next_state(last)) is not None:
                state = last = news
        return None

    def _patience(self) -> Patience:
        timeout = self.settings.joint_state_timeout
        return Patience(self._arm, timeout, lambda sentence: self.on_waiting(sentence))

    def _newest_if_fresh(self) -> ArmState | None:
        state = self._arm.newest()
        if state is None or self._arm.now() - state.received > _FRESH_SECONDS:
            return None
        return state

    def _settled(self, state: ArmState) -> ArmState:
        """At rest again after it went on unseen: what it holds by now, where it stands tells.

        A trajectory that went on may have put one block down and taken another.
        """
        grip, trajectory = self.grip, self._trajectory
        if grip.doubtful and trajectory is not None:
            near = set()
            for interval in trajectory.intervals:
                path, _ = trajectory.sample(np.arange(interval.start, interval.end, Monitor.STEP))
                if interval.holding and path.furthest(state.positions)[0].min() < self.ON_THE_PATH:
                    near.add((interval.phase.tool.held, interval.phase.move))
            held, move = near.pop() if len(near) == 1 else ("", -1)
            self.grip = replace(grip, held=held, move=move, sent=None, doubtful=False)
        return state

    def follow(
        self,
        trajectory: Trajectory,
        on_progress: Callable[[Trajectory, float], None] = lambda _trajectory, _time: None,
        stopped: Callable[[], bool] = lambda: False,
        moving: bool = False,
    ) -> bool:
        """Sends a trajectory and watches it; True when the arm has arrived at its end.

        Args:
            on_progress: told the trajectory's time after each joint state.
            stopped: polled after each joint state of an arm that has started; returns False at
                once when it says so, with the trajectory still running.
            moving: it replaces one that is under way, and begins as that goes on.

        Raises:
            ExecutionError: if it does not go as it should.
        """
        limit = self.settings.execution_factor * trajectory.duration + 30.0
        patience = self._patience()
        # Not the state from which the motion was optimised: that took a while.
        state = self._newest_if_fresh() or patience.wait(self._arm.newest())
        away, _ = state.positions.furthest(trajectory.positions[0])
        if away > self.START_TOLERANCE and not moving:
            raise ExecutionError(
                MotionReason.TRACKING_LOST,
                "the arm has moved while its motion was optimised; let it rest, and ask again",
                recoverable=True,
            )
        # What replaces another under way is joined where it should be when it arrives.
        begins = state.stamp if moving and state.stamped else None
        in_step = None
        watched, stepping = self.settings.monitor, self.settings.in_step
        if stepping:
            begins = first_moment(self._arm, state, patience, self._missing, self.settings)
            in_step, state = InStep(trajectory, begins, stepping), self._arm.newest() or state
            watched = replace(watched, max_lag=min(watched.max_lag, stepping.apart))
        monitor = Monitor(trajectory, state, watched)
        begin, self._trajectory, self.time = self._arm.now(), trajectory, 0.0
        self.under_way, self.let_go_of, self._judged = True, "", False
        self._send(trajectory, begins)
        told = False
        try:
            while True:
                state = patience.wait(state)
                verdict = monitor.update(state)
                if in_step and verdict is Verdict.GOING:
                    verdict = in_step.update(state)
                if told is monitor.started and (told or self._arm.now() - begin > NOTICE_SECONDS):
                    told = not told
                    self.on_waiting("the arm has not set out yet" if told else "")
                self.time, self._stamp = monitor.time, state.stamp
                self._note_grip()
                on_progress(trajectory, monitor.time)
                if verdict is Verdict.ARRIVED:
                    self.under_way = False
                    return True
                if verdict is not Verdict.GOING:
                    self._object(verdict, monitor, state, in_step)
                # An arm that has not started may not have the trajectory yet, and rest before it.
                if monitor.started and stopped():
                    return False
                if self._arm.now() - begin > limit:
                    raise ExecutionError(
                        MotionReason.TIMEOUT,
                        f"the execution takes longer than {limit:.0f} s; is the clock running?",
                    )
        except ExecutionError as error:
            if not error.recoverable:
                error = self._unseen(error)
            raise error
        finally:
            self.grip = replace(self.grip, known=False)

    def _unseen(self, error: ExecutionError) -> ExecutionError:
        """The same error, with what the arm does that is not watched any more."""
        assert self._trajectory is not None
        self.grip = replace(self.grip, doubtful=bool(self.grip.held))
        self.under_way = False
        end = self._trajectory.intervals[-1].phase
        where = ", which ends at home" if end.kind == HOME else ""
        return ExecutionError(error.reason, f"{error} The arm goes on along its trajectory{where}")

    def _note_grip(self) -> None:
        assert self._trajectory is not None
        phase = self.interval.phase
        held = "" if self.empty_handed else phase.tool.held
        if self.grip.held and not held:
            self.let_go_of = self.grip.held
        self.moves_done = phase.move + 1 if self.let_go else phase.move
        move = self.grip.move if phase.kind == HOME else phase.move
        sent = float(np.mean(self._trajectory.sample(self.time)[0].fingers))
        self.grip = Grip(held, move if held else -1, sent, known=True)

    def brake(self) -> ArmState:
        """Comes to rest along the running trajectory; returns the arm's state then.

        Fingers that were about to take a block, or to let go of it, open.

        Raises:
            ExecutionError: if the arm does not come to rest, or joint states stay out.
        """
        assert self._trajectory is not None
        running = self._trajectory
        at, since = self.time, self._stamp
        if (newest := self._arm.newest()) is not None:
            # Whoever asks to brake may have taken a while, in which the arm went on.
            at, since = at + max(0.0, newest.stamp - since), max(newest.stamp, since)
        brake = self._send_brake(running, at)
        patience = self._patience()
        first = begun = state = patience.wait(self._arm.newest())
        # Fingers that press on a block do not move when they are first sent back.
        while state.resting < 0.15 or state.stamp - begun.stamp < max(0.15, brake.duration):
            if state.stamp - first.stamp > brake.duration + 5.0:
                raise ExecutionError(
                    MotionReason.TRACKING_LOST,
                    "the arm does not stop when asked to",
                    recoverable=True,
                )
            state = patience.wait(state)
            now = at + state.stamp - since
            if now < running.duration and self._goes_on(running, now, brake, begun, state):
                brake, begun = self._send_brake(running, now), state
        self.under_way, self.time = False, 0.0
        return state

    def _send_brake(self, running: Trajectory, at: float) -> Trajectory:
        """Sends what brakes along a trajectory from a time on.

        What the hand holds is as then, but where fingers were found to be elsewhere.
        """
        self._trajectory, self.time = running, min(at, running.duration)
        if not self._judged:
            self._note_grip()
        brake = running.brake(self.time, self.LEAD, self.settings.brake_seconds)
        self._trajectory = brake
        sent = float(np.mean(brake.positions.fingers[-1]))
        self.grip = replace(self.grip, sent=sent, known=False)
        self._send(brake, None)
        return brake

    def _goes_on(
        self, running: Trajectory, at: float, brake: Trajectory, begun: ArmState, state: ArmState
    ) -> bool:
        """Whether an arm that was to brake goes on instead: it was told too late."""
        elapsed = state.stamp - begun.stamp
        if elapsed < _OBEYS_SECONDS:
            return False
        away, _ = state.positions.furthest(brake.sample(elapsed)[0])
        off, _ = state.positions.furthest(running.sample(at)[0])
        return bool(away > 2 * self.START_TOLERANCE and off < self.START_TOLERANCE)

    def stand_before(self, grasp: Interval) -> None:
        """Goes on to where the fingers are to close, and stands there; they are open.

        Args:
            grasp: of the running trajectory, while they close or before.

        Raises:
            ExecutionError: if the arm does not come there, or joint states stay out.
        """
        assert self._trajectory is not None
        if self.interval.gripping:
            self.brake()  # which opens them again
            return
        begin = min(self.time + self.LEAD, grasp.start - _SHORTEST_SECONDS)
        self.go_along(self._trajectory.cut(begin, grasp.start))

    def go_along(self, way: Trajectory) -> None:
        """Goes a short way that ends at rest, and stands there.

        Raises:
            ExecutionError: if the arm does not come there, or joint states stay out.
        """
        self._trajectory, self.under_way, self.time = way, False, 0.0
        self._send(way, None)
        patience = self._patience()
        first = state = patience.wait(self._arm.newest())
        while (
            state.stamp - first.stamp < way.duration
            or state.positions.furthest(way.positions[-1])[0] > self.settings.monitor.goal_tolerance
        ):
            if state.stamp - first.stamp > way.duration + 5.0:
                raise ExecutionError(
                    MotionReason.TRACKING_LOST,
                    "the arm does not come to where it is to take the next block",
                    recoverable=True,
                )
            state = patience.wait(state)

    def states(self) -> Iterator[ArmState]:
        """The newest state, and then each that comes.

        Raises:
            ExecutionError: if joint states stay out.
        """
        patience, state = self._patience(), self._arm.newest()
        while True:
            if state is not None:
                yield state
            state = patience.wait(state)

    def feel(self, state: ArmState, by: float = 0.006) -> bool:
        """Whether something resists when the fingers close a little more; then it presses on.

        Args:
            state: of the arm at rest.
            by: how far each finger is sent [m].

        Raises:
            ExecutionError: if joint states stay out.
        """
        now = state.positions
        goal = np.maximum(now.fingers - by, 0.0)
        self._stand(JointValues(np.tile(now.arm, (2, 1)), np.vstack([now.fingers, goal])))
        patience, begin = self._patience(), state.stamp
        enough = float(np.mean(now.fingers - goal)) / 2
        # Fingers that have not moved yet may not have been told yet: only moving proves anything.
        patient = FEEL_SECONDS
        if self.settings.in_step:  # a gripper's own controller may be late by itself
            patient = max(patient, self.settings.monitor.start_seconds)
        while state.stamp - begin < patient:
            state = patience.wait(state)
            if float(np.mean(now.fingers - state.positions.fingers)) >= enough:
                return False
        return True

    def _object(
        self, verdict: Verdict, monitor: Monitor, state: ArmState, in_step: InStep | None
    ) -> None:
        block, self._judged = monitor.block, True
        if in_step and verdict is Verdict.FINGERS_TOO_NARROW:
            block = in_step.block()
        if verdict in (Verdict.NOT_OPENED, Verdict.FINGERS_TOO_NARROW) and block is not None:
            self.grip = replace(self.grip, held=block.object_name, move=block.move)
            self.let_go_of, self.moves_done = "", block.move
        elif verdict in (Verdict.GRASP_LOST, Verdict.NOT_CLOSED, Verdict.FINGERS_TOO_WIDE):
            self.grip = replace(self.grip, held="", move=-1)
        expected = in_step.expected if in_step else None
        error = objection(verdict, self.interval.phase, block, state, expected)
        if error.reason is MotionReason.TRACKING_LOST:
            self._hold(state)
        raise error

    def _hold(self, state: ArmState) -> None:
        """Stays where the arm is; fingers that press go on pressing."""
        assert self._trajectory is not None
        pressing = self._trajectory.sample(self.time)[0].fingers
        arm, fingers = np.tile(state.positions.arm, (2, 1)), np.tile(pressing, (2, 1))
        self._stand(JointValues(arm, fingers))

    def _stand(self, positions: JointValues) -> None:
        """The arm stands for half a second, while its fingers go from here to there."""
        interval = Interval(0.0, 0.5, self.interval.phase if self._trajectory else _NOTHING, True)
        still = JointValues(np.zeros_like(positions.arm), np.zeros_like(positions.fingers))
        stand = Trajectory(np.array([0.0, 0.5]), positions, still, (interval,))
        self._trajectory, self.under_way, self.time = stand, False, 0.0
        self.grip = replace(self.grip, sent=float(np.mean(positions.fingers[-1])))
        self._send(stand, None)
