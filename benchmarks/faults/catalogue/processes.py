# SPDX-License-Identifier: Apache-2.0
"""Nodes that die, stand still, or are there twice."""

from __future__ import annotations

from faults.fault import ALL_PHASES, MOVING_PHASES, Fault, Phase
from faults.injections import Killed, Paused, StartedTwice, Stopped
from tamp_bringup.processes import NODES

_NAMES = {
    "sim_node": ("sim_node", "camera", "joint_states", "arm's driver", "clock"),
    "perception_node": ("perception_node", "perception", "scene graph"),
    "planner_node": ("planner_node", "planner"),
    "motion_node": ("motion_node", "motion node"),
}


def _short(node: str) -> str:
    return node.removesuffix("_node")


FAULTS = (
    *(
        Fault(f"{_short(node)}-killed", f"{node} is killed and stays away", Killed(node),
              ALL_PHASES, (_NAMES[node],))
        for node in NODES
    ),
    *(
        Fault(f"{_short(node)}-restarted", f"{node} is killed and started again after 1 s",
              Killed(node), ALL_PHASES, (_NAMES[node],), 1.0)
        for node in NODES
    ),
    *(
        Fault(f"{_short(node)}-stands-still-2s", f"{node} stands still for 2 s", Paused((node,)),
              ALL_PHASES, (_NAMES[node],), 2.0, transient=True)
        for node in NODES
    ),
    *(
        Fault(f"{_short(node)}-stands-still-5s", f"{node} stands still for 5 s", Paused((node,)),
              ALL_PHASES, (_NAMES[node],), 5.0, transient=True)
        for node in NODES
    ),
    Fault("all-stand-still-3s", "the whole machine stands still for 3 s", Paused(NODES),
          ALL_PHASES, (("",),), 3.0, transient=True),
    Fault("motion-hangs", "motion_node stands still for good", Paused(("motion_node",)),
          (Phase.PERCEIVE, *MOVING_PHASES), (_NAMES["motion_node"],)),
    Fault("planner-hangs", "planner_node stands still for good", Paused(("planner_node",)),
          (Phase.PERCEIVE, *MOVING_PHASES), (_NAMES["planner_node"],)),
    Fault("planner-stopped-again", "planner_node ends by Ctrl-C and is started again",
          Stopped("planner_node"), (Phase.PERCEIVE, *MOVING_PHASES), (_NAMES["planner_node"],),
          1.0),
    Fault("second-planner", "a second planner_node in the same domain",
          StartedTwice(("planner_node",)), (Phase.PERCEIVE, Phase.EXECUTE), (("two", "second"),)),
    Fault("second-motion", "a second motion_node in the same domain",
          StartedTwice(("motion_node",)), (Phase.PERCEIVE, Phase.EXECUTE), (("two", "second"),)),
    Fault("second-simulator", "a second sim_node in the same domain",
          StartedTwice(("sim_node",)), (Phase.PERCEIVE, Phase.EXECUTE), (("two", "second"),)),
    Fault("second-graph", "a second graph in the same domain", StartedTwice(NODES),
          (Phase.PERCEIVE, Phase.EXECUTE), (("two", "second"),)),
)  # fmt: skip
