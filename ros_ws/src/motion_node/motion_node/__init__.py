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

import importlib
from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
    from .public import *  # noqa: F403


def __getattr__(name: str) -> Any:
    # Imported when it is first asked for: an executable listens to Ctrl-C before such imports.
    if name.startswith("_") and name != "__all__":
        raise AttributeError(f"module {__name__!r} has no attribute {name!r}")
    return getattr(importlib.import_module(".public", __name__), name)
