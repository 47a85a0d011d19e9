# SPDX-License-Identifier: Apache-2.0
"""The ways of a motion solved anew from starting points at random."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from motion_node.constraints import Clearances
from motion_node.errors import InfeasibleError
from motion_node.phases import PhasePath
from motion_node.planner import Motion, MotionPlanner
from motion_node.timing.time_paths import time_paths

Array = NDArray[np.float64]

#: Standard deviation of the bends of a starting point, at most [rad].
BEND = 0.1


def best_of_starts(
    planner: MotionPlanner, motion: Motion, starts: int, rng: np.random.Generator
) -> tuple[float, float]:
    """Duration of a motion's ways by the best ways', and the share of starts that lead to any.

    Each way is solved between its ends from other heights over the stacks, and from random bends of
    its solution; what is found is timed by itself. The motion's own ways count among the best.
    """
    _, problem = planner.prepare(len(motion.phases[0].columns))
    clear = Clearances(planner.settings.path.margin, motion.floor)
    ours = best = 0.0
    solved = tried = 0
    for path in motion.paths:
        own = least = _duration(planner, path)
        share = np.linspace(0.0, 1.0, len(path.q))[:, None]
        ends = [path.q[0], path.q[-1]]
        first = list(problem.straight_starts(path.phase, ends, clear))
        for index in range(starts):
            bends = rng.normal(0.0, rng.uniform(0.0, BEND), (2, path.q.shape[1]))
            bent = sum(b * np.sin(np.pi * (k + 1) * share) for k, b in enumerate(bends))
            start = first[index] if index < len(first) else path.q + bent
            tried += 1
            try:
                found = problem.solve([path.phase], ends, clear, [start])[0]
            except InfeasibleError:
                continue
            solved += 1
            least = min(least, _duration(planner, found))
        ours, best = ours + own, best + least
    return ours / best, solved / tried


def _duration(planner: MotionPlanner, path: PhasePath) -> float:
    """Of one way from rest to rest, without what the fingers take [s]."""
    fingers = np.full(2, path.phase.tool.finger)
    trajectory = time_paths([path], planner.limits, planner.timing, fingers)
    return sum(i.end - i.start for i in trajectory.intervals if not i.gripping)
