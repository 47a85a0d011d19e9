# SPDX-License-Identifier: Apache-2.0
"""What is different where one row of places is behind another one (5.4.3)."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from perception_node.camera import PinholeCamera
from perception_node.errors import BadImageError
from perception_node.observation import Observation
from perception_node.segment import Segments
from perception_node.visual_module.coordinates import Coordinates
from scene_graph import Place

from .row import RowOfPlaces
from .standing import Standing


class TwoRows(RowOfPlaces):
    """Two rows of places as a camera sees them, see :func:`scene_graph.in_rows`.

    Attributes:
        places: from the left of the image, those of the nearer row first.
    """

    def __init__(self, places: tuple[Place, ...]) -> None:
        self.places = places

    def stand(
        self,
        observation: Observation,
        segments: Segments,
        coordinates: Coordinates,
        centres_world: NDArray[np.float64] | None = None,
    ) -> Standing:
        """See :class:`RowOfPlaces`; raises BadImageError also where nothing is measured."""
        if centres_world is None:
            raise BadImageError(
                "which of two rows a block stands in cannot be told without depth; publish it, or "
                "give the goal as text"
            )
        return super().stand(observation, segments, coordinates, centres_world)

    def in_front(
        self, points_world: NDArray[np.float64], camera: PinholeCamera, margin: float
    ) -> NDArray[np.bool_]:
        """Whether points are among the places of both rows, or between them and the camera."""
        ground = self._positions()[:, :2]
        toward = camera.position_world[:2] - ground.mean(0)
        front = ground[[place.index for place in self.places if place.row == 0]]
        along = front[-1] - front[0]
        if along.any():
            toward = toward - along * (toward @ along) / (along @ along)
        toward = toward / np.linalg.norm(toward)
        with np.errstate(invalid="ignore"):
            return np.asarray(points_world[..., :2] @ toward > (ground @ toward).min() - margin)

    def _columns(self, camera: PinholeCamera) -> NDArray[np.float64]:
        """Where the places are across the image, shape (m,); each row is from the left."""
        columns = camera.project(self._positions())[:, 0]
        row = np.array([place.row for place in self.places])
        same = row[1:] == row[:-1]
        if np.any(np.diff(columns)[same] <= 0.0) or not np.isfinite(columns).all():
            raise BadImageError(
                "the places of a row are not in order from the left of the image; check the "
                "parameter stack_positions and camera/extrinsics"
            )
        return np.asarray(columns / max(camera.width, camera.height))
