# SPDX-License-Identifier: Apache-2.0
"""From symbolic plan to joint trajectory, and its execution.

What a notebook needs stands here; none of it knows ROS::

    from motion_node import PANDA, MotionPlanner
    from scene_graph import Move

    planner = MotionPlanner(urdf_text, PANDA)
    motion = planner.solve(graph, [Move(0, 2)], arm=q, fingers=fingers)
    print(motion.trajectory.duration)

:mod:`motion_node.planner` ties together what happens in between.
"""

from __future__ import annotations

from typing import TYPE_CHECKING

from tamp_runtime.public_face import exported_by

if TYPE_CHECKING:
    from .public import *  # noqa: F403

__getattr__ = exported_by(__name__)
