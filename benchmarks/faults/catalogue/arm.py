# SPDX-License-Identifier: Apache-2.0
"""What controllers, drivers and fingers do."""

from __future__ import annotations

from faults import damages as d
from faults.fault import ALL_PHASES, MOVING_PHASES, Fault, Phase
from faults.injections import Damaged
from faults.modes import Change, Delay, Drop, Freeze, FreezeContent, Repeat
from faults.relay import Mode
from faults.topics import GRIPPER, JOINTS, TRAJECTORY

#: The trajectory is sent at the end of OPTIMISE: a fault of it must be there before.
_BEFORE = (Phase.PERCEIVE, Phase.OPTIMISE)
#: Arm and gripper with a controller each.
_APART = (("sim_node", "gripper_apart", True), ("motion_node", "gripper_apart", True))
_FOLLOWS = ("trajectory", "controller", "path", "does not start", "behind")


def _trajectory(name: str, what: str, mode: Mode, *words: str, transient: bool = False) -> Fault:
    return Fault(
        name, what, Damaged((TRAJECTORY,), mode), _BEFORE, (words or _FOLLOWS,),
        transient=transient,
    )  # fmt: skip


def _apart(name: str, what: str, topic: str, mode: Mode) -> Fault:
    words = ((topic,),)
    return Fault(name, what, Damaged((topic,), mode), _BEFORE, words, parameters=_APART)


def _joints(name: str, what: str, mode: Mode, *words: str) -> Fault:
    return Fault(name, what, Damaged((JOINTS,), mode), (Phase.PERCEIVE, *MOVING_PHASES), (words,))


def _hiccup(name: str, what: str, mode: Mode, seconds: float) -> Fault:
    injection = Damaged((JOINTS,), mode)
    return Fault(name, what, injection, ALL_PHASES, (("joint",),), seconds, transient=True)


FAULTS = (
    _trajectory("trajectory-lost", "no trajectory reaches the controller", Drop()),
    Fault(
        "trajectory-lost-3s", "for 3 s no trajectory reaches the controller",
        Damaged((TRAJECTORY,), Drop()), _BEFORE, (_FOLLOWS,), 3.0, transient=True,
    ),
    _trajectory("trajectory-late", "trajectories arrive 1 s late", Delay(1.0)),
    _trajectory("trajectory-very-late", "trajectories arrive 6 s late", Delay(6.0)),
    _trajectory("trajectory-twice", "every trajectory arrives twice", Repeat(2), transient=True),
    _trajectory(
        "trajectory-again", "every trajectory arrives once more 1 s later", Repeat(2, after=1.0)
    ),
    _trajectory(
        "trajectory-ends-early", "a trajectory ends at 60% of its points",
        Change(d.cut_short(0.6)), *_FOLLOWS, "end",
    ),
    _trajectory(
        "trajectory-ends-early-once", "the first trajectory ends at 60% of its points",
        Change(d.cut_short(0.6), first=1), transient=True,
    ),
    _trajectory("trajectory-slow", "the controller takes three times as long",
                Change(d.stretched(3.0)), *_FOLLOWS, "slow"),
    _trajectory("trajectory-nan", "a position that is no number", Change(d.nan_in_the_middle)),
    _trajectory(
        "fingers-stay-open", "the fingers never close", Change(d.fingers_kept_at(0.04)),
        "finger", "grasp", "grip",
    ),
    _trajectory(
        "fingers-stay-closed", "the fingers never open", Change(d.fingers_kept_at(0.0)),
        "finger", "grasp", "grip",
    ),
    _trajectory(
        "fingers-stay-open-once", "the fingers stay open in the first trajectory",
        Change(d.fingers_kept_at(0.04), first=1), transient=True,
    ),
    _apart("apart-arm-lost", "the arm's controller gets nothing, the gripper's all",
           TRAJECTORY, Drop()),
    _apart("apart-arm-late", "the arm's controller gets everything 1 s late", TRAJECTORY, Delay(1)),
    _apart("apart-arm-very-late", "the arm's controller gets everything 6 s late",
           TRAJECTORY, Delay(6)),
    _apart("apart-gripper-lost", "the gripper's controller gets nothing, the arm's all",
           GRIPPER, Drop()),
    _apart("apart-gripper-late", "the gripper's controller gets everything 1 s late",
           GRIPPER, Delay(1)),
    _apart("apart-gripper-very-late", "the gripper's controller gets everything 6 s late",
           GRIPPER, Delay(6)),
    _joints("joints-lost", "no joint_states arrive", Drop(), "joint_states"),
    _hiccup("joints-lost-2s", "no joint_states arrive for 2 s", Drop(), 2.0),
    _hiccup("joints-lost-5s", "no joint_states arrive for 5 s", Drop(), 5.0),
    _joints("joints-frozen", "the same joint_states again and again", Freeze(),
            "stand still", "stands still", "joint_states", "clock"),
    _joints("joints-frozen-content", "the same positions with new stamps", FreezeContent(),
            "does not start", "controller", "path", "behind", "joint_states", "not reach"),
    _hiccup("joints-frozen-3s", "the same joint_states for 3 s", Freeze(), 3.0),
    _hiccup("joints-late", "joint_states arrive 0.3 s late for 5 s", Delay(0.3), 5.0),
    _joints("joints-nan", "no position is a number", Change(d.positions_nan),
            "finite", "number", "nan"),
    _joints("joints-missing", "a finger is missing in joint_states",
            Change(d.without_last_joint), "finger", "panda_", "missing", "lack"),
    Fault(
        "joints-reordered", "the joints come in another order",
        Damaged((JOINTS,), Change(d.joints_reversed)), (Phase.PERCEIVE, *MOVING_PHASES),
        (("joint",),), transient=True,
    ),
    _joints("joints-stamp-zero", "joint_states without stamps", Change(d.with_stamp(0)),
            "stamp", "time"),
    _joints("joints-stamp-back", "joint_states of a minute ago", Change(d.stamped(-60.0)),
            "stamp", "time"),
    _joints("joints-shaken", "positions with noise of 0.5 degrees", Change(d.shaken(0.009)),
            "rest", "joint", "path"),
)  # fmt: skip
