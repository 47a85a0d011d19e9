# SPDX-License-Identifier: Apache-2.0
"""How the arm is, in words, from what the motion node said last."""

from __future__ import annotations

from tamp_interfaces.action import AchieveGoal
from tamp_interfaces.msg import MotionStatus


def describe_arm(motion: MotionStatus) -> str:
    """Where the arm is and what it holds."""
    hand = f"({motion.hand.x:.2f}, {motion.hand.y:.2f}, {motion.hand.z:.2f}) m"
    where = {
        MotionStatus.ARM_HOME: "the arm is at home",
        MotionStatus.ARM_RESTING: f"the arm rests away from home, its hand at {hand},",
        MotionStatus.ARM_MOVING: "the arm still moves",
    }.get(motion.arm, "nothing is heard of the arm's joints: it may still move")
    if motion.arm == MotionStatus.ARM_UNKNOWN and not motion.held:
        return where
    held = "something" if motion.held == MotionStatus.SOMETHING else motion.held
    return f"{where} and holds {held}" if held else f"{where} with an empty hand"


def describe_failure(result: AchieveGoal.Result) -> list[str]:
    """What is to be told beside the sentence of a result: the first cause, and how the arm is."""
    lines = []
    if result.causes and result.causes[0] not in result.message:
        lines.append(f"the first cause: {result.causes[0]}")
    motion = result.motion
    if motion.arm != MotionStatus.ARM_UNKNOWN or motion.held or motion.plan_id:
        lines.append(describe_arm(motion))
    return lines
