# SPDX-License-Identifier: Apache-2.0
"""What stands on what, and the interface of what finds it out."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Protocol

import numpy as np
from numpy.typing import NDArray

from perception_node.camera import PinholeCamera
from perception_node.observation import Observation
from perception_node.segment import Segments
from perception_node.visual_module.coordinates import Coordinates
from scene_graph import Place

#: Points in world, (x, y, z) [m].
Points = tuple[tuple[float, float, float], ...]


@dataclass(frozen=True)
class Standing:
    """The stacks of a scene.

    Attributes:
        stacks: for each stack the indices of its blocks from the bottom. Where the places are
            known, one stack a place, which may be empty; else those that are seen, from the left.
        table_heights: z of the surface under each stack [m].
        places: one a stack; none where it is not known on which place a stack stands.
        problem: why the stacks fit no places; empty where they do, or where nothing is known.
    """

    stacks: tuple[tuple[int, ...], ...]
    table_heights: tuple[float, ...]
    places: tuple[Place, ...] = ()
    problem: str = ""


class Places(Protocol):
    """How the places lie on the table, and what follows from it for pictures of stacks on them."""

    @property
    def places(self) -> tuple[Place, ...]:
        """The m places; none where they are unknown."""
        ...

    def seen_by(self, camera: PinholeCamera | None) -> Places:
        """How the same places lie for a camera."""
        ...

    def stand(
        self,
        observation: Observation,
        segments: Segments,
        coordinates: Coordinates,
        centres_world: NDArray[np.float64] | None = None,
    ) -> Standing:
        """Which blocks stand on one another, and on which place.

        Args:
            segments: N blocks, at least one.
            coordinates: theirs, in the same order.
            centres_world: of the blocks as measured, shape (N, 3) [m]; None without depth.

        Raises:
            PerceptionError: if places and camera do not fit together.
        """
        ...

    def in_front(
        self, points_world: NDArray[np.float64], camera: PinholeCamera, margin: float
    ) -> NDArray[np.bool_]:
        """Whether points are among the places, or between them and the camera.

        Args:
            points_world: shape (..., 3) [m]; NaN is in front of nothing.
            margin: how far behind a place's centre is still among the places [m].

        Returns:
            Shape (...).
        """
        ...
