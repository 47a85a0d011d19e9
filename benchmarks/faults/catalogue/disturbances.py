# SPDX-License-Identifier: Apache-2.0
"""A world that misbehaves by physics, while the arm goes on: ``sim/disturb``."""

from __future__ import annotations

from geometry_msgs.msg import Vector3
from tamp_interfaces.srv import Disturb

from faults.at_the_grasp import COVERED, PUSHED, TAKEN
from faults.disturbances import Disturbed, new_block, some_top, two_blocks
from faults.fault import ALL_PHASES, MOVING_PHASES, Fault, Phase
from faults.obstacles import InTheWay

_Ask = Disturb.Request
#: An event of the hand comes after its request.
_BEFORE = (Phase.PERCEIVE, Phase.OPTIMISE)
_DOWN = Vector3(z=-1.0)

#: What a sentence about a scene that changed says.
_CHANGED = ("differs", "saw", "seen", "moved", "changed", "finger", "path")
#: What one about blocks that stand in no stack any more says.
_ASTRAY = (*_CHANGED, "beside", "in the air", "lean", "overhang", "stands on", "tilt", "not on")
_GRIP = ("finger", "grasp", "grip", "hand", "hold")
_GONE = ("cannot be seen", "not seen", "no ", "unknown")
#: The planner watches while the arm moves.
_WATCHED = (("planner_node", "verify", "watch"),)
#: The first pick of a plan comes after its optimisation.
_FIRST = (Phase.OPTIMISE,)

FAULTS = (
    Fault("world-block-pushed", "a block is pushed some 5 cm away from the arm",
          Disturbed(_Ask.PUSH, some_top), ALL_PHASES, ((*_ASTRAY, *_GONE),)),
    Fault("world-block-pulled-out", "the block that is lifted next is pulled out of the hand",
          Disturbed(_Ask.PUSH, fields={"force": 60.0, "direction": _DOWN, "when": _Ask.IN_AIR}),
          _BEFORE, ((*_ASTRAY, *_GRIP),)),
    Fault("world-block-slips", "the block that is lifted next slips out of the hand",
          Disturbed(_Ask.SLIP, fields={"when": _Ask.IN_AIR}), _BEFORE, ((*_ASTRAY, *_GRIP),)),
    Fault("world-second-block-slips", "the second block that is lifted slips out of the hand",
          Disturbed(_Ask.SLIP, fields={"when": _Ask.IN_AIR, "count": 2}), _BEFORE,
          ((*_ASTRAY, *_GRIP),)),
    Fault("world-gripper-jams-4s", "the fingers follow no command for 4 s",
          Disturbed(_Ask.JAM, fields={"seconds": 4.0}), MOVING_PHASES, ((*_ASTRAY, *_GRIP),)),
    Fault("world-gripper-jams-shut-4s", "from the next grasp on, the fingers stay closed for 4 s",
          Disturbed(_Ask.JAM, fields={"seconds": 4.0, "when": _Ask.GRASP}), _BEFORE,
          ((*_ASTRAY, *_GRIP),)),
    Fault("world-table-shoved", "the table is shoved, so that towers topple",
          Disturbed(_Ask.SHOVE), ALL_PHASES, (_ASTRAY,)),
    Fault("world-table-shoved-gently", "the table is shoved, and all stays where it was",
          Disturbed(_Ask.SHOVE, fields={"acceleration": 1.5}), ALL_PHASES, (_CHANGED,),
          transient=True),
    Fault("world-hand-before-camera-4s", "a person's hand is before the camera for 4 s",
          Disturbed(_Ask.COVER, fields={"what": "hand", "seconds": 4.0}), ALL_PHASES,
          (("hides", "hidden", "camera"),), transient=True),
    Fault("world-sheet-before-camera-4s", "a sheet of paper hides everything for 4 s",
          Disturbed(_Ask.COVER, fields={"what": "sheet", "seconds": 4.0}), ALL_PHASES,
          (("hides", "hidden", "no block", "camera"),), transient=True),
    Fault("world-block-taken-away", "a block is taken away while the arm goes on",
          Disturbed(_Ask.TAKE_AWAY, some_top), ALL_PHASES, ((*_GONE, *_CHANGED),)),
    Fault("world-block-taken-from-hand", "the block that is lifted next is taken away",
          Disturbed(_Ask.TAKE_AWAY, fields={"when": _Ask.IN_AIR}), _BEFORE,
          ((*_GONE, *_CHANGED),)),
    Fault("world-block-added", "somebody puts another block on a stack while the arm goes on",
          Disturbed(_Ask.ADD, new_block, on_top=True), (Phase.PERCEIVE, Phase.OPTIMISE),
          (_CHANGED,)),
    Fault("world-blocks-exchanged", "two blocks change places while the arm goes on",
          Disturbed(_Ask.SWAP, two_blocks), (Phase.PERCEIVE, Phase.OPTIMISE), (_CHANGED,)),
    Fault("world-arm-nudged", "somebody bumps into the arm", Disturbed(_Ask.NUDGE), ALL_PHASES,
          ((*_ASTRAY, *_GRIP, "controller", "behind"),)),
    # A motion under way that is obstructed, and a block that is not seen as the hand comes to it.
    Fault("obstacle-comes-1s", "obstacles are told in the motion's way, and are gone after 1 s",
          InTheWay(), (Phase.EXECUTE,), (("obstacle", "in the way"),), 1.0, transient=True),
    Fault("obstacle-stays", "obstacles are told in the motion's way, and stay", InTheWay(),
          (Phase.EXECUTE,), (("obstacle", "in the way", "bar"),)),
    Fault("watched-block-taken-at-the-grasp", "a block is taken away as the hand comes down on it",
          TAKEN, _FIRST, ((*_GONE, *_CHANGED, *_GRIP),), parameters=_WATCHED),
    Fault("watched-block-pushed-at-the-grasp", "a block is pushed as the hand comes down on it",
          PUSHED, _FIRST, ((*_ASTRAY, *_GONE, *_GRIP),), parameters=_WATCHED),
    Fault("watched-covered-at-the-grasp-8s",
          "a sheet hides everything for 8 s as the hand comes down on a block",
          COVERED, _FIRST, (("hides", "hidden", "no block", "camera", "not seen"),),
          transient=True, parameters=_WATCHED),
)  # fmt: skip
