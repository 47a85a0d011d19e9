# SPDX-License-Identifier: Apache-2.0
"""The closed loop on plain values: what is seen, what is planned, what becomes of it."""

from .certain_goal import Answers, certain_goal
from .clock import Clock
from .closed_loop import ClosedLoop
from .motion_link import MotionLink, PlanTopic
from .plan import Plan, plan_for
from .report import Outcome, Progress, Stage, Status
from .scene import Scene, Sighting, scene_in
from .scene_plan import decided, given_plan_in, meaning, plan_in, uncover_in
from .scene_watch import SceneWatch

__all__ = [
    "Answers",
    "Clock",
    "ClosedLoop",
    "MotionLink",
    "Outcome",
    "Plan",
    "PlanTopic",
    "Progress",
    "Scene",
    "SceneWatch",
    "Sighting",
    "Stage",
    "Status",
    "certain_goal",
    "decided",
    "given_plan_in",
    "meaning",
    "plan_for",
    "plan_in",
    "scene_in",
    "uncover_in",
]
