# SPDX-License-Identifier: Apache-2.0
"""What becomes of the words that the nodes pass on to one another, and of the clock."""

from __future__ import annotations

from faults import damages as d
from faults.fault import ALL_PHASES, MOVING_PHASES, Fault, Phase
from faults.injections import Damaged
from faults.modes import Change, Delay, Drop, Freeze, Repeat
from faults.topics import CLOCK, GRAPH, PLAN, STATUSES

_BEFORE = (Phase.PERCEIVE,)
_MOTION = ("motion_node", "motion node", "motion_status", "symbolic_plan")

FAULTS = (
    Fault("status-lost", "no motion_status reaches the planner", Damaged((STATUSES,), Drop()),
          (Phase.PERCEIVE, *MOVING_PHASES), (_MOTION,)),
    Fault("status-lost-5s", "no motion_status for 5 s", Damaged((STATUSES,), Drop()),
          ALL_PHASES, (_MOTION,), 5.0, transient=True),
    Fault("status-late", "motion_status arrives 0.5 s late", Damaged((STATUSES,), Delay(0.5)),
          (Phase.PERCEIVE, *MOVING_PHASES), (_MOTION,), transient=True),
    Fault("status-twice", "every motion_status arrives twice", Damaged((STATUSES,), Repeat(2)),
          (Phase.PERCEIVE, *MOVING_PHASES), (_MOTION,), transient=True),
    Fault("status-again", "every motion_status arrives again 1 s later",
          Damaged((STATUSES,), Repeat(2, after=1.0)),
          (Phase.PERCEIVE, *MOVING_PHASES), (_MOTION,), transient=True),
    Fault("status-nonsense", "states that the interface does not know",
          Damaged((STATUSES,), Change(d.nonsense_state)),
          (Phase.PERCEIVE, *MOVING_PHASES), (_MOTION,)),
    Fault("status-reason-nonsense", "reasons that the interface does not know",
          Damaged((STATUSES,), Change(d.nonsense_reason)),
          (Phase.PERCEIVE, *MOVING_PHASES), (_MOTION,)),
    Fault("status-of-another", "every motion_status is about a plan of somebody else",
          Damaged((STATUSES,), Change(d.of_another_plan)),
          (Phase.PERCEIVE, *MOVING_PHASES), ((*_MOTION, "somebody-elses"),)),
    Fault("plan-lost", "no plan reaches the motion node", Damaged((PLAN,), Drop()),
          _BEFORE, (_MOTION,)),
    Fault("plan-lost-3s", "no plan reaches the motion node for 3 s", Damaged((PLAN,), Drop()),
          _BEFORE, (_MOTION,), 3.0, transient=True),
    Fault("plan-late", "plans arrive 2 s late", Damaged((PLAN,), Delay(2.0)),
          _BEFORE, (_MOTION,), transient=True),
    Fault("plan-twice", "every plan arrives twice", Damaged((PLAN,), Repeat(2)),
          _BEFORE, (_MOTION,), transient=True),
    Fault("plan-again", "every plan arrives again 10 s later",
          Damaged((PLAN,), Repeat(2, after=10.0)), _BEFORE, (_MOTION,), transient=True),
    Fault("plan-wrong-stacks", "a plan for stacks that are not there",
          Damaged((PLAN,), Change(d.moves_from_nowhere)), _BEFORE, (("stack",),)),
    Fault("plan-unknown-blocks", "a plan for blocks that are not in its scene",
          Damaged((PLAN,), Change(d.blocks_unheard_of)), _BEFORE, (("golden_box",),)),
    Fault("plan-poses-off", "the blocks of a plan are 4 cm aside",
          Damaged((PLAN,), Change(d.poses_off(0.04))), _BEFORE,
          (("finger", "grasp", "grip", "beside", "overhang", "in the air", "lean"),)),
    Fault("graph-lost", "no scene graph reaches the planner", Damaged((GRAPH,), Drop()),
          (Phase.PERCEIVE, Phase.CONFIRM), (("scene graph", "perception"),)),
    Fault("graph-lost-4s", "no scene graph for 4 s", Damaged((GRAPH,), Drop()),
          (Phase.PERCEIVE, Phase.EXECUTE, Phase.CONFIRM), (("scene graph",),), 4.0,
          transient=True),
    Fault("graph-late", "scene graphs arrive 1 s late", Damaged((GRAPH,), Delay(1.0)),
          (Phase.PERCEIVE, Phase.CONFIRM), (("scene graph", "old"),)),
    Fault("graph-frozen", "the same scene graph again and again", Damaged((GRAPH,), Freeze()),
          (Phase.PERCEIVE, Phase.CONFIRM), (("scene graph", "old"),)),
    Fault("clock-stopped", "the clock stands still", Damaged((CLOCK,), Drop()),
          ALL_PHASES, (("clock", "stamp", "time"),)),
    Fault("clock-stopped-3s", "the clock stands still for 3 s", Damaged((CLOCK,), Drop()),
          ALL_PHASES, (("clock",),), 3.0, transient=True),
    Fault("clock-ahead", "the clock jumps one minute ahead",
          Damaged((CLOCK,), Change(d.clock_shifted(60.0))),
          ALL_PHASES, (("clock", "old", "use_sim_time"),)),
    Fault("clock-behind", "the clock jumps one minute back",
          Damaged((CLOCK,), Change(d.clock_shifted(-60.0))),
          ALL_PHASES, (("clock", "future", "use_sim_time"),)),
    Fault("clock-ahead-4s", "the clock is one minute ahead for 4 s",
          Damaged((CLOCK,), Change(d.clock_shifted(60.0))),
          ALL_PHASES, (("clock",),), 4.0, transient=True),
)  # fmt: skip
