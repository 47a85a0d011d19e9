# SPDX-License-Identifier: Apache-2.0
"""The goal of a request, text or image, to be resolved against the scene that is seen."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

from sensor_msgs.msg import Image
from tamp_interfaces.msg import SceneGraph

from .conversions import Scene, scene_from_message
from .errors import GoalImageError, InvalidGoalError, NotConfidentError
from .goal_parser import parse_goal, resolve_goal
from .goals import Goal, complete_goal

#: Asks perception for the scene graph of an image and its segmentation.
Interpret = Callable[[Image, Image], SceneGraph]


def read_goal(request: Any, interpret: Interpret) -> Callable[[Scene], Goal]:
    """Everything about a goal that needs no scene; the result finds its objects in a scene.

    Args:
        request: a request of PlanToGoal or a goal of AchieveGoal.

    Raises:
        InvalidGoalError: the text makes no sense, or there are text and image.
        GoalImageError: the image makes no sense. The result raises it if the image shows other
            objects than the scene, or UnknownObjectError or AmbiguousObjectError for a text.
    """
    has_image = request.goal_image.width > 0 or request.goal_segmentation.width > 0
    if not has_image:
        parsed = parse_goal(request.goal)
        return lambda scene: resolve_goal(parsed, scene.names)
    if request.goal.strip():
        raise InvalidGoalError("there is a goal text and a goal image; give one of them", 0)
    message = interpret(request.goal_image, request.goal_segmentation)
    try:
        shown = scene_from_message(message, min_confidence=0.0)
    except NotConfidentError as error:
        raise GoalImageError(f"the goal image cannot be used: {error}") from error
    return lambda scene: _goal_of_image(shown, scene)


def _goal_of_image(shown: Scene, scene: Scene) -> Goal:
    missing = sorted(set(scene.names) - set(shown.names))
    extra = sorted(set(shown.names) - set(scene.names))
    if missing or extra:
        differences = [
            f"{', '.join(names)} {verb}"
            for names, verb in ((missing, "missing in the image"), (extra, "not in the scene"))
            if names
        ]
        raise GoalImageError(
            f"the goal image shows other objects than the scene: {'; '.join(differences)}",
            missing,
            extra,
        )
    if len(shown.stacks) != len(scene.stacks):
        raise GoalImageError(
            f"the goal image shows {len(shown.stacks)} stacks, the scene has {len(scene.stacks)}"
        )
    return complete_goal(shown.stacks)
