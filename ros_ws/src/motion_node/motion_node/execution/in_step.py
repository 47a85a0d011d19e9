# SPDX-License-Identifier: Apache-2.0
"""Whether an arm and a gripper with a controller each do their parts of a trajectory at its time.

Both are sent the same stamp, so both are known to be at s(t) = t - begins along their part. One
that is lost, late, refused or stopped shows in that its joints are nowhere near where they should
be about now, while the other one goes on: before fingers close on nothing, or open in the air.
"""

from __future__ import annotations

from collections.abc import Callable

import numpy as np
from tamp_runtime.motion_report import MotionReason

from ..phases import PLACE, Phase
from ..timing.trajectory import Trajectory
from .arm_state import ArmState, ArmStates
from .errors import ExecutionError
from .lasting import Lasting
from .monitor import Verdict
from .patience import Patience
from .settings import ExecutionSettings, StepSettings


def first_moment(
    arm: ArmStates,
    state: ArmState,
    patience: Patience,
    missing: Callable[[], str],
    settings: ExecutionSettings,
) -> float:
    """When two controllers can start in step, by the clock of the joint states [s].

    It is so far ahead that both have the trajectory by then, also where a simulation is fast.

    Args:
        state: a fresh one.
        missing: which controller nobody can reach; empty: none. Waited for as for the arm's start.

    Raises:
        ExecutionError: if one is missing, or nobody knows the time.
    """
    assert settings.in_step is not None
    deadline = arm.now() + settings.monitor.start_seconds
    while sentence := missing():
        if arm.now() > deadline:
            raise ExecutionError(MotionReason.TRACKING_LOST, sentence, recoverable=True)
        state = patience.wait(state)
    if not state.stamped:
        raise ExecutionError(
            MotionReason.TRACKING_LOST,
            "joint_states have no time stamps, by which arm and gripper are kept in step; have "
            "their driver stamp them",
            recoverable=True,
        )
    now = state.stamp + state.rate * (arm.now() - state.received)
    return now + settings.in_step.lead * max(1.0, state.rate)


class InStep:
    """Watches one trajectory.

    Args:
        begins: its stamp, by the clock of the joint states [s].

    Attributes:
        expected: where the fingers may be about now, from and to [m].
    """

    #: Between two times about now at which the joints are looked for [s].
    SPACING = 0.01

    def __init__(self, trajectory: Trajectory, begins: float, settings: StepSettings) -> None:
        self._trajectory, self._begins, self._settings = trajectory, begins, settings
        self._arm, self._fingers = Lasting(settings.seconds), Lasting(settings.seconds)
        self.expected = (0.0, np.inf)
        intervals = trajectory.intervals
        self._ends = np.array([interval.end for interval in intervals])
        # Where a block stops closing fingers; where something unknown does, anywhere.
        unknown = np.array([bool(i.phase.tool.held) and i.phase.grasp is None for i in intervals])
        widths = np.array([i.phase.grasp.width if i.phase.grasp else 0.0 for i in intervals])
        self._stops = np.where(unknown, np.inf, widths / 2)
        self._now = begins

    def block(self) -> Phase | None:
        """The place phase whose block should have been let go last."""
        elapsed, block = self._now - self._begins, None
        for interval in self._trajectory.intervals:
            if interval.start <= elapsed and interval.gripping:
                block = interval.phase if interval.phase.kind == PLACE else None
        return block

    def update(self, state: ArmState) -> Verdict:
        """Takes in a new state: ARM_OUT_OF_STEP, FINGERS_TOO_WIDE, FINGERS_TOO_NARROW or GOING."""
        settings, self._now = self._settings, state.stamp
        elapsed = state.stamp - self._begins
        looks = 2 * round(settings.apart / self.SPACING) + 1
        about = np.linspace(elapsed - settings.apart, elapsed + settings.apart, looks)
        times = np.clip(about, 0.0, self._trajectory.duration)
        path, _ = self._trajectory.sample(times)
        away, _ = path.furthest(state.positions)
        if self._arm.lasts(float(away.min()) > settings.arm_tolerance, state.stamp):
            return Verdict.ARM_OUT_OF_STEP
        asked = np.mean(path.fingers, axis=1)
        at = np.minimum(np.searchsorted(self._ends, times), len(self._ends) - 1)
        low, high = float(asked.min()), float(np.maximum(asked, self._stops[at]).max())
        self.expected = (low, high)
        fingers, room = float(np.mean(state.positions.fingers)), settings.finger_tolerance
        wide, narrow = fingers > high + room, fingers < low - room
        if self._fingers.lasts(wide or narrow, state.stamp):
            return Verdict.FINGERS_TOO_WIDE if wide else Verdict.FINGERS_TOO_NARROW
        return Verdict.GOING
