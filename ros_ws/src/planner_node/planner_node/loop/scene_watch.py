# SPDX-License-Identifier: Apache-2.0
"""The newest scene graph, and waiting for one that can be planned on."""

from __future__ import annotations

import threading
from collections.abc import Callable
from typing import Final

from scene_graph import GraphStatus

from ..errors import CancelledError, NoSceneGraphError, NotConfidentError, ObjectLostError
from ..settings import Settings
from .clock import Clock
from .readings import Doubt, Readings
from .scene import Scene, Sighting, scene_in

#: Longest time that a request to cancel stays unnoticed while waiting [s].
POLL_SECONDS: Final = 0.05


class SceneWatch:
    """Holds the newest scene graph; all methods may be called from any thread.

    Only the newest one counts: an older confident graph shows a scene that may be gone.
    """

    def __init__(
        self, settings: Settings, now: Callable[[], int], clock: Clock | None = None
    ) -> None:
        """``now`` is the ROS time [ns], 0 while simulated time has not arrived."""
        self.now = now
        self._settings = settings
        self._clock = clock or Clock()
        self._arrived = threading.Condition()
        self._raw: Sighting | None = None
        self._newest: Sighting | None = None
        self._readings = Readings()
        self._heard = 0.0
        self._view_requested, self._view_asked = False, 0.0

    def receive(self, sighting: Sighting) -> None:
        """Takes what perception reports in place of what it reported before."""
        with self._arrived:
            now = self._clock.now()
            if sighting.status.sees_all or sighting.status is GraphStatus.HIDDEN:
                if sighting.view_requested and not self._view_requested:
                    self._view_asked = now
                self._view_requested = sighting.view_requested
            self._raw, self._newest = sighting, self._readings.named(sighting)
            self._heard = now
            self._arrived.notify_all()

    def answer(self, doubt: Doubt, color: str) -> None:
        """Takes it that a block in doubt has this colour, from the newest picture on."""
        with self._arrived:
            if self._raw is not None and self._newest is not None:
                self._readings.answer(doubt, color, self._newest.graph.names)
                self._newest = self._readings.named(self._raw)

    @property
    def newest(self) -> Sighting | None:
        """What perception reported last, whatever it is worth; None before it did."""
        with self._arrived:
            return self._newest

    def latest(
        self,
        after: int = 0,
        needed: frozenset[str] = frozenset(),
        recall: Callable[[Scene], Scene] = lambda scene: scene,
    ) -> Scene:
        """The newest scene, if it can be planned on; blocks may hide others in it.

        Args:
            after: it has to be taken after this time [ns].
            needed: objects that have to be in it, unless something is hidden.
            recall: puts in what is remembered, see :func:`.recall.recall`.

        Raises:
            NoSceneGraphError: none has arrived, or none any more.
            NotConfidentError: it cannot be trusted; the sentence says why.
            ObjectLostError: a needed object is not in it.
        """
        with self._arrived:
            sighting, heard = self._newest, self._heard
        if sighting is None:
            raise NoSceneGraphError(
                "nothing has arrived from perception yet; are the camera (sim_node) and "
                "perception_node running?"
            )
        self._check_time(sighting, after, self._clock.now() - heard)
        scene = recall(scene_in(sighting, self._settings.min_confidence, may_hide=True))
        missing = sorted(needed - set(scene.names))
        if missing and not scene.hidden:
            raise ObjectLostError(missing, scene.names, scene.lying)
        return scene

    def wait(
        self,
        cancelled: Callable[[], bool],
        after: int = 0,
        needed: frozenset[str] = frozenset(),
        recall: Callable[[Scene], Scene] = lambda scene: scene,
    ) -> Scene:
        """Like :meth:`latest`, but waits up to ``perceive_timeout`` for such a scene.

        Where a camera was asked to look at what is hidden from elsewhere, it is given
        ``view_timeout`` to go there: a view costs less than the moves that uncover a block.

        Raises:
            NoSceneGraphError, NotConfidentError, ObjectLostError: what was wrong when the time was
                over.
            CancelledError: ``cancelled`` returned True.
        """
        deadline = self._clock.now() + self._settings.perceive_timeout
        while True:
            if cancelled():
                raise CancelledError("cancelled while waiting for a scene graph")
            try:
                scene = self.latest(after, needed, recall)
                if not self._may_be_seen(scene):
                    return scene
            except (NoSceneGraphError, NotConfidentError, ObjectLostError):
                if self._clock.now() >= deadline:
                    raise
            with self._arrived:
                self._clock.wait(self._arrived, POLL_SECONDS)

    def _may_be_seen(self, scene: Scene) -> bool:
        """Whether a camera may be on its way to where it sees what is hidden in the scene.

        Where nobody moves it the request goes on, and is waited for once.
        """
        with self._arrived:
            waited = self._clock.now() - self._view_asked
        return scene.view_requested and bool(scene.hidden) and waited < self._settings.view_timeout

    def _check_time(self, sighting: Sighting, after: int, silence: float) -> None:
        now, stamp = self.now(), sighting.stamp
        if now == 0:
            raise NoSceneGraphError(
                "use_sim_time is set, but nothing arrives on clock; is sim_node running?"
            )
        age, limit = (now - stamp) / 1e9, self._settings.graph_max_age
        # A simulation that died has stopped its clock, by which no graph grows old any more.
        if silence > limit:
            raise NoSceneGraphError(
                f"nothing has arrived from perception for {silence:.0f} s; is the simulator or the "
                "camera dead, is the clock standing still, or has perception_node stopped?"
            )
        if age < -limit:
            raise NotConfidentError(
                f"the newest scene graph is stamped {-age:.1f} s in the future; does use_sim_time "
                "have the same value on all nodes, or was the simulation just restarted?"
            )
        # What perception refuses is not planned on: its reason says more than its age, and in a
        # simulation that runs faster than life it is said less often than every graph_max_age.
        if age > limit and sighting.status == GraphStatus.CONFIDENT:
            raise NotConfidentError(
                f"the newest scene graph is {age:.1f} s old; are the camera and perception_node "
                "still running, and does use_sim_time have the same value on all nodes?"
            )
        # After a restart of the simulation `after` can lie in the future: it means nothing then.
        if stamp <= after <= now:
            raise NotConfidentError(
                "the newest scene graph shows the scene before the last motion or the request; are "
                "the camera and perception_node still running?"
            )
