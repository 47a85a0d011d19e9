# SPDX-License-Identifier: Apache-2.0
"""The newest scene graph, and waiting for one that can be planned on."""

from __future__ import annotations

import threading
import time
from collections.abc import Callable
from typing import Final

from tamp_interfaces.msg import SceneGraph

from .conversions import Scene, nanoseconds, scene_from_message
from .errors import CancelledError, NoSceneGraphError, NotConfidentError, PlannerError
from .settings import Settings

#: Longest time that a request to cancel stays unnoticed while waiting [s].
POLL_SECONDS: Final = 0.05


class SceneWatch:
    """Holds the newest scene graph; all methods may be called from any thread.

    Only the newest one counts: an older confident graph shows a scene that may be gone.
    """

    def __init__(self, settings: Settings, now: Callable[[], int]) -> None:
        """``now`` is the ROS time [ns], 0 while simulated time has not arrived."""
        self._settings = settings
        self._now = now
        self._arrived = threading.Condition()
        self._newest: SceneGraph | None = None

    def receive(self, message: SceneGraph) -> None:
        with self._arrived:
            self._newest = message
            self._arrived.notify_all()

    def latest(self, after: int = 0) -> Scene:
        """The newest scene, if it can be planned on and was taken after the time ``after`` [ns].

        Raises:
            NoSceneGraphError: none has arrived.
            NotConfidentError: it cannot be trusted; the sentence says why.
        """
        with self._arrived:
            message = self._newest
        if message is None:
            raise NoSceneGraphError(
                "no scene graph has arrived; are the camera (sim_node) and perception_node running?"
            )
        self._check_time(nanoseconds(message.header.stamp), after)
        return scene_from_message(message, self._settings.min_confidence)

    def wait(self, cancelled: Callable[[], bool], after: int = 0) -> Scene:
        """Like :meth:`latest`, but waits up to ``perceive_timeout`` for such a scene.

        Raises:
            NoSceneGraphError, NotConfidentError: what was wrong when the time was over.
            CancelledError: ``cancelled`` returned True.
        """
        waited = self._settings.perceive_timeout
        deadline = time.monotonic() + waited
        while True:
            if cancelled():
                raise CancelledError("cancelled while waiting for a scene graph")
            problem: PlannerError
            try:
                return self.latest(after)
            except (NoSceneGraphError, NotConfidentError) as error:
                problem = error
            if time.monotonic() >= deadline:
                raise type(problem)(f"{problem} (waited {waited:g} s)")
            with self._arrived:
                self._arrived.wait(POLL_SECONDS)

    def _check_time(self, stamp: int, after: int) -> None:
        now = self._now()
        if now == 0:
            raise NoSceneGraphError(
                "use_sim_time is set, but nothing arrives on clock; is sim_node running?"
            )
        age, limit = (now - stamp) / 1e9, self._settings.graph_max_age
        if age < -limit:
            raise NotConfidentError(
                f"the newest scene graph is stamped {-age:.1f} s in the future; does use_sim_time "
                "have the same value on all nodes, or was the simulation just restarted?"
            )
        if age > limit:
            raise NotConfidentError(
                f"the newest scene graph is {age:.1f} s old; are the camera and perception_node "
                "still running, and does use_sim_time have the same value on all nodes?"
            )
        # After a restart of the simulation `after` can lie in the future: it means nothing then.
        if stamp <= after <= now:
            raise NotConfidentError("the newest scene graph was taken before the last motion ended")
