# SPDX-License-Identifier: Apache-2.0
"""How much less the path problem undivided costs than what is solved phase by phase."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from motion_node.bounds.costs import joined
from motion_node.constraints import Clearances
from motion_node.errors import InfeasibleError
from motion_node.phases import HOME, PhasePath
from motion_node.planner import Motion, MotionPlanner
from motion_node.timing.time_paths import time_paths

Array = NDArray[np.float64]

#: Standard deviation of the bends of a starting point, at most [rad].
BEND = 0.1


@dataclass(frozen=True)
class Gap:
    """Of one motion, beside the best that the undivided problem led to.

    Attributes:
        cost: its cost by that of the best, less 1.
        duration: the same of durations, fingers included; of the path that costs least.
    """

    cost: float
    duration: float


def gap_to_joint(
    planner: MotionPlanner, motion: Motion, starts: int, rng: np.random.Generator
) -> Gap:
    """The undivided problem is solved from several starting points; all of them count.

    From the motion itself, from the ways between the switches as P1 leaves them, and from random
    bends of the motion.
    """
    stacks = len(motion.phases[0].columns)
    whole, clear = planner.undivided(stacks), Clearances(planner.settings.path.margin, motion.floor)
    own = list(motion.paths)
    x = joined([path.q for path in own])
    tried = [x, *_from_poses(planner, motion, clear)]
    share = np.linspace(0.0, 1.0, len(own[0].q))[:, None]
    while len(tried) < starts:
        bent = [path.q + _bend(rng, share, path.q.shape[1]) for path in own]
        tried.append(joined(bent))
    found = [own]
    for start in tried:
        paths = whole.solve(motion.phases, start, clear)
        if paths is not None:
            found.append(paths)
    best = min(found, key=whole.cost)
    return Gap(
        whole.cost(own) / whole.cost(best) - 1,
        motion.trajectory.duration / _duration(planner, best) - 1,
    )


def _from_poses(planner: MotionPlanner, motion: Motion, clear: Clearances) -> list[Array]:
    keyframes, path = planner.prepare(len(motion.phases[0].columns))
    switching = [phase for phase in motion.phases if phase.kind != HOME]
    poses = keyframes.poses.solve(switching, keyframes.problems.demands(switching, clear))
    ways = path.ways(motion.phases, [motion.paths[0].q[0], *poses, planner.model.home], clear)
    try:
        return [joined([path.solve_ways([way])[0].q for way in ways])]
    except InfeasibleError:
        return []


def _bend(rng: np.random.Generator, share: Array, joints: int) -> Array:
    bends = rng.normal(0.0, rng.uniform(0.0, BEND), (2, joints))
    return np.asarray(sum(b * np.sin(np.pi * (k + 1) * share) for k, b in enumerate(bends)))


def _duration(planner: MotionPlanner, paths: list[PhasePath]) -> float:
    fingers = np.full(2, planner.arm.gripper.finger_travel)
    return time_paths(paths, planner.limits, planner.timing, fingers, float(fingers[0])).duration
