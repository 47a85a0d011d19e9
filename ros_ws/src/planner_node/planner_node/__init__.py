# SPDX-License-Identifier: Apache-2.0
"""From a scene graph and a goal to a plan, and the closed loop that carries it out.

What a notebook needs stands here; none of it knows ROS::

    from planner_node import make_plan, parse_goal, resolve_goal

    state = (("red_box", "blue_box"), ("green_box",), ())
    goal = resolve_goal(parse_goal("red on green"), ("red_box", "blue_box", "green_box"))
    print(make_plan(state, goal).moves)
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
