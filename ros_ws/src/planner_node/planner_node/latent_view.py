# SPDX-License-Identifier: Apache-2.0
"""The representation "latent": goal images met by a plan on codes of pictures (Chapter 4).

What the blocks are and where they stand still comes from the scene graph: the motion needs it, and
a plan is checked against it before anybody sees it.
"""

from __future__ import annotations

import threading
import time
from collections import deque
from typing import Any, Final

import numpy as np
from numpy.typing import NDArray
from rclpy.callback_groups import MutuallyExclusiveCallbackGroup
from rclpy.node import Node
from sensor_msgs.msg import Image
from tamp_runtime.messages.images import ImageError, color_from_image
from tamp_runtime.messages.stamps import nanoseconds
from tamp_runtime.qos import NEWEST

from perception_node.errors import PerceptionError
from perception_node.latent.pictures import reduced
from perception_node.latent.weights import DEFAULT_ENCODER, load_encoder
from scene_graph import ImpossibleMoveError, Stacks, all_moves, apply_move

from .action_models.learnt import LearntModel
from .action_models.weights import DEFAULT_ACTION_MODEL, ModelWeightsError, load_action_model
from .errors import GoalImageError, InvalidGoalError, NoSceneGraphError, NotConfidentError
from .goals import Goal, complete_goal
from .latent_plans import LatentPlan, LatentPlanner, StrangePictureError
from .search import SearchResult
from .search.on_models import NoModelPlanError
from .settings import Settings

#: A scene graph comes after its picture by less than so many others.
_PICTURES_KEPT: Final = 10


class LatentView:
    """Listens to the camera, and plans from its newest picture to a goal image.

    Raises:
        ValueError: the weights cannot be used.
    """

    def __init__(self, node: Node, settings: Settings) -> None:
        self._settings = settings
        try:
            encoder = load_encoder(DEFAULT_ENCODER)
            model = LearntModel(
                *load_action_model(DEFAULT_ACTION_MODEL), all_moves(3), encoder.snap
            )
        except (PerceptionError, ModelWeightsError) as error:
            raise ValueError(str(error)) from error
        self._planner = LatentPlanner(encoder.read, model)
        self._lock = threading.Lock()
        self._pictures: deque[Image] = deque(maxlen=_PICTURES_KEPT)
        node.create_subscription(
            Image,
            "camera/image_raw",
            self._on_image,
            NEWEST,
            callback_group=MutuallyExclusiveCallbackGroup(),
        )

    def plan(
        self, request: Any, seen: Stacks, stamp: int | None = None
    ) -> tuple[Goal, SearchResult]:
        """The moves to a goal image, and the state of the scene graph that they lead to.

        Args:
            request: a request of PlanToGoal or a goal of AchieveGoal.
            seen: the state of the scene graph.
            stamp: when its picture was taken, in ROS time [ns]; None: the newest one.

        Raises:
            InvalidGoalError: there is a text, or no image.
            GoalImageError: the image cannot be used, or the action model knows no way to it.
            NoSceneGraphError: no picture has arrived.
            NotConfidentError: the plan contradicts the scene graph, or itself.
        """
        if request.goal.strip() or request.goal_image.width == 0:
            raise InvalidGoalError(
                "with the parameter representation = latent a goal is an image; give one and no "
                "text, or set representation to scene_graph"
            )
        begun = time.perf_counter()
        found = self._found(_picture(self._now(stamp)), _picture(request.goal_image))
        states = [seen]
        try:
            for move in found.moves:
                states.append(apply_move(states[-1], move))
        except ImpossibleMoveError as error:
            raise NotConfidentError(
                f"the plan on codes contradicts the scene graph: {error}; look again"
            ) from error
        if found.confidence < self._settings.min_confidence:
            raise NotConfidentError(
                f"predictions forward and backward agree on {found.confidence:.2f} of the plan's "
                f"states, less than min_confidence {self._settings.min_confidence:.2f}"
            )
        seconds = time.perf_counter() - begun
        result = SearchResult(found.moves, tuple(states), found.expanded, seconds)
        return complete_goal(states[-1]), result

    def _found(self, now: NDArray[np.uint8], goal: NDArray[np.uint8]) -> LatentPlan:
        try:
            with self._lock:
                return self._planner.plan(now, goal)
        except StrangePictureError as error:
            raise (GoalImageError if error.is_goal else NotConfidentError)(str(error)) from error
        except NoModelPlanError as error:
            raise GoalImageError(
                f"no plan on codes leads to the goal image ({error}); it must show the blocks of "
                "the scene, seen by the same camera, and colours that the action model was "
                "trained on"
            ) from error

    def _now(self, stamp: int | None) -> Image:
        """The picture of a scene graph, or the newest one."""
        pictures = list(self._pictures)
        if not pictures:
            raise NoSceneGraphError("no picture has arrived on camera/image_raw")
        if stamp is None:
            return pictures[-1]
        for picture in pictures:
            if nanoseconds(picture.header.stamp) == stamp:
                return picture
        raise NoSceneGraphError(
            "the picture of the scene graph has not arrived on camera/image_raw; ask again"
        )

    def _on_image(self, message: Image) -> None:
        self._pictures.append(message)


def _picture(message: Image) -> NDArray[np.uint8]:
    try:
        return reduced(color_from_image(message))
    except (ImageError, PerceptionError) as error:
        raise GoalImageError(str(error)) from error
