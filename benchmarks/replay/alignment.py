# SPDX-License-Identifier: Apache-2.0
"""When a trajectory without a stamp has begun: the arm's own joints tell."""

from __future__ import annotations

from typing import Final

import numpy as np
from numpy.typing import NDArray

Array = NDArray[np.float64]

#: How long before and after it was heard of a trajectory may have begun [s]. The clock that is
#: heard lags behind on a busy machine, and so may the trajectory.
EARLIER: Final = 0.4
LATER: Final = 0.4
#: Only the beginning is compared; another trajectory may follow soon [s].
COMPARED: Final = 1.0


def beginning(
    heard: float, times: Array, positions: Array, joint_times: Array, joints: Array, step: float
) -> float:
    """The time [s] from which on the joints follow a trajectory best.

    Args:
        heard: when the trajectory arrived at whoever recorded it [s].
        times, positions: of its points since its beginning, shapes (t,) [s], (t, n).
        joint_times, joints: what the joints did, shapes (s,) [s], (s, n) in the same order.
        step: of the controller, on whose grid it begins [s].

    Where the joints say nothing (too few states, or an arm that does not move) it is ``heard``.
    """
    best, least = heard, np.inf
    inside = (joint_times >= heard - EARLIER) & (joint_times <= heard + LATER + COMPARED)
    at, seen = joint_times[inside], joints[inside]
    if len(at) < 3 or len(times) < 2 or np.ptp(seen, axis=0).max() < 1e-3:
        return heard
    first = max(round((heard - EARLIER) / step), 0)
    for number in range(first, round((heard + LATER) / step) + 1):
        begins = number * step
        since = at - begins
        # Before it begins the arm rests, or follows another one, of which nothing is asked.
        following = (since >= 0.0) & (since <= COMPARED)
        if following.sum() < 3:
            continue
        wanted = np.array([np.interp(since, times, column) for column in positions.T]).T
        resting = since < 0.0
        error = np.abs(wanted - seen)[following].mean()
        # It must not begin so late that the arm has moved before.
        if resting.any():
            error += np.abs(seen[resting][-1] - positions[0]).mean()
        if error < least:
            best, least = begins, error
    return best
