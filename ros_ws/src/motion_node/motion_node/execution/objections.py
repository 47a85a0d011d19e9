# SPDX-License-Identifier: Apache-2.0
"""What the monitor finds wrong, in words."""

from __future__ import annotations

import numpy as np
from tamp_runtime.motion_report import SOMETHING, MotionReason

from ..phases import Phase
from .arm_state import ArmState
from .errors import ExecutionError
from .monitor import Verdict

_SENTENCES = {
    Verdict.NOT_STARTED: "the arm does not start; its controller may have refused the trajectory",
    Verdict.UNSEEN: "no joint_states came while the arm was to set out; it may have moved unseen",
    Verdict.OFF_THE_PATH: "the arm has left its path; something may hold it",
    Verdict.BEHIND: "the arm falls behind its trajectory; something may hold it",
    Verdict.NOT_ARRIVED: "the arm does not reach the end of its trajectory",
    Verdict.CLOCK_WENT_BACK: "the joint states' time went back; was the simulator restarted?",
    Verdict.ARM_OUT_OF_STEP: "the arm is not where it should be by now",
}

#: What may be with one controller of two; the name of its topic comes in between.
_CONTROLLER = (
    "the {} controller may not run, may have got {} late or never, may have refused it, or may "
    "have another clock than joint_states"
)

_NO_STAMPS = (
    "; joint_states have no time stamps, so that the time of their arrival was taken, which is not "
    "the arm's where a simulation runs faster or slower; have its driver stamp them"
)


def objection(
    verdict: Verdict,
    phase: Phase,
    block: Phase | None,
    state: ArmState,
    expected: tuple[float, float] | None = None,
) -> ExecutionError:
    """Why an execution ends.

    Args:
        phase: what the arm was doing.
        block: the place phase of the block that the fingers hold, or have just let go.
        expected: where the fingers of a gripper with a controller of its own may be, from and to
            [m]; None: it has none.
    """
    apart = 2000 * float(np.mean(state.positions.fingers))
    doing = f"{phase.kind} of {phase.object_name}" if phase.object_name else "way home"
    of_gripper, of_arm = (
        f"; {_CONTROLLER.format(whose, topic)}" if expected else ""
        for whose, topic in (("gripper's", "gripper_trajectory"), ("arm's", "joint_trajectory"))
    )
    if verdict in (Verdict.FINGERS_TOO_WIDE, Verdict.FINGERS_TOO_NARROW):
        assert expected is not None
        low, high = (2000 * opening for opening in expected)
        due = f"{low:.0f} to {high:.0f} mm" if np.isfinite(high) else f"{low:.0f} mm or more"
        sentence = f"the fingers stand {apart:.0f} mm apart where {due} are due by now ({doing})"
    elif verdict is Verdict.NOT_OPENED and block is not None:
        sentence = (
            f"the fingers did not open: they stand {apart:.0f} mm apart and still hold "
            f"{block.object_name}; check the gripper"
        )
    elif verdict is Verdict.NOT_OPENED and phase.grasp is not None:
        sentence = (
            f"the fingers do not open: they stand {apart:.0f} mm apart, and {phase.object_name} is "
            f"{1000 * phase.grasp.width:.0f} mm wide; check the gripper"
        )
    elif verdict is Verdict.NOT_CLOSED and phase.grasp is not None:
        sentence = (
            f"the fingers did not close on {phase.tool.held}: they stand {apart:.0f} mm "
            f"apart, the block is {1000 * phase.grasp.width:.0f} mm wide"
        )
    elif verdict is Verdict.GRASP_LOST:
        held = "what they held" if phase.tool.held == SOMETHING else phase.tool.held
        sentence, of_gripper = f"the fingers closed on nothing or lost {held}", ""
    else:
        sentence = f"{_SENTENCES[verdict]} ({doing}){'' if state.stamped else _NO_STAMPS}"
        if verdict in (Verdict.NOT_STARTED, Verdict.BEHIND, Verdict.ARM_OUT_OF_STEP):
            sentence += of_arm
        return ExecutionError(MotionReason.TRACKING_LOST, sentence, recoverable=True)
    return ExecutionError(MotionReason.GRASP_LOST, sentence + of_gripper, recoverable=True)
