# SPDX-License-Identifier: Apache-2.0
"""Places as one camera of several sees them, from the front, from aside or from behind."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from perception_node.camera import PinholeCamera
from perception_node.errors import BadImageError
from perception_node.observation import Observation
from perception_node.segment import Segments
from perception_node.visual_module.coordinates import Coordinates

from .row import RowOfPlaces
from .standing import Places, Standing


class FromAnywhere(RowOfPlaces):
    """Places that need lie in no order in the picture; what is on them is measured, never counted.

    One stack may hide another one, and what is no block may hide a part of any.
    """

    def seen_by(self, _camera: PinholeCamera | None) -> Places:
        """Itself."""
        return self

    def stand(
        self,
        _observation: Observation,
        _segments: Segments,
        _coordinates: Coordinates,
        centres_world: NDArray[np.float64] | None = None,
    ) -> Standing:
        """See :class:`Places`; raises BadImageError where nothing is measured."""
        if centres_world is None:
            raise BadImageError("views of several cameras are joined by depth; publish it")
        return self._stand_on_table(centres_world)

    def in_front(
        self, points_world: NDArray[np.float64], camera: PinholeCamera, margin: float
    ) -> NDArray[np.bool_]:
        """Whether points are, for the camera, before the far end of a place or of its neighbours.

        Seen from above, each place is a wedge of what is as far to the left and right as it is.
        """
        eye = camera.position_world[:2]
        found = np.zeros(points_world.shape[:-1], bool)
        for foot in self._positions()[:, :2]:
            away = foot - eye
            distance = float(np.hypot(*away))
            away = away / max(distance, 1e-9)
            off = points_world[..., :2] - eye
            along, across = off @ away, np.abs(off @ (-away[1], away[0]))
            with np.errstate(invalid="ignore"):
                before = (along > 0.0) & (along < distance + margin)
                found |= before & (across * distance < 2.0 * margin * along)
        return found
