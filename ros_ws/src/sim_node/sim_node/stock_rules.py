# SPDX-License-Identifier: Apache-2.0
"""Which trajectories ros2_control's joint_trajectory_controller takes, at its defaults.

The checks of its topic interface, in its order; the sentences name its parameters.
"""

from __future__ import annotations

from collections.abc import Sequence
from typing import Final

import numpy as np
from numpy.typing import NDArray

from .trajectory import TrajectoryError

#: A velocity at the end that is no more than this is none: C++'s epsilon of a float.
_STANDSTILL: Final = float(np.finfo(np.float32).eps)


def check_stock_rules(
    names: Sequence[str],
    joints: Sequence[str],
    times: NDArray[np.float64],
    velocities: NDArray[np.float64] | None,
    late: float,
) -> None:
    """What the controller checks before it takes a trajectory.

    Args:
        names: the joints that the trajectory names.
        joints: those of the controller.
        times: since the trajectory's start, shape (t,) [s].
        velocities: shape (t, n), or None.
        late: how long ago it was to start [s]; not positive: it has no stamp, or one to come.

    Raises:
        TrajectoryError: if the controller does not take it; it then goes on as it was.
    """
    theirs, own = ", ".join(names) or "no joints", ", ".join(joints)
    if len(names) != len(joints):
        raise TrajectoryError(
            f"it names {theirs}; the controller has {own} (allow_partial_joints_goal is false)"
        )
    if len(times) == 0:
        raise TrajectoryError("it has no points; a trajectory that stands still stops the joints")
    if unknown := [name for name in names if name not in joints]:
        raise TrajectoryError(f"unknown joints: {', '.join(unknown)}; the controller has {own}")
    if velocities is not None and (np.abs(velocities[-1]) > _STANDSTILL).any():
        joint = names[int(np.argmax(np.abs(velocities[-1])))]
        raise TrajectoryError(
            f"it ends while {joint} moves (allow_nonzero_velocity_at_trajectory_end is false)"
        )
    if late > times[-1]:
        raise TrajectoryError(f"it ended {late - times[-1]:.3g} s ago")
    if (np.diff(times) <= 0.0).any():
        raise TrajectoryError("time_from_start does not grow from point to point")
