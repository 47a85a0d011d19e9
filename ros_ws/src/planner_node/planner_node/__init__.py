# SPDX-License-Identifier: Apache-2.0
"""From a scene graph and a goal to a plan, and the closed loop that carries it out.

What a notebook needs stands here; none of it knows ROS::

    from planner_node import make_plan, parse_goal, resolve_goal

    state = (("red_box", "blue_box"), ("green_box",), ())
    goal = resolve_goal(parse_goal("red on green"), ("red_box", "blue_box", "green_box"))
    print(make_plan(state, goal).moves)
"""

from __future__ import annotations

from typing import TYPE_CHECKING

from tamp_runtime.public_face import exported_by

if TYPE_CHECKING:
    from .public import *  # noqa: F403

__getattr__ = exported_by(__name__)
