# SPDX-License-Identifier: Apache-2.0
"""Everything that is assumed of places in a row, seen from the front (5.2.1, A.2.2, A.2.4).

Where blocks were measured, those that stand on one spot of the table are a stack, on the nearest
place. Of a picture alone: stacks stand side by side in it, in the order of their places, so they
can be counted on the outline of the masks, grouped by horizontal coordinate, and assigned in order.
"""

from __future__ import annotations

import functools
from collections.abc import Sequence
from typing import Final

import cv2
import numpy as np
from numpy.typing import ArrayLike, NDArray
from scipy.optimize import linear_sum_assignment

from perception_node.camera import PinholeCamera
from perception_node.clustering import cluster_on_line
from perception_node.components import components
from perception_node.errors import BadImageError, PlacesError
from perception_node.observation import Observation
from perception_node.segment import Segments
from perception_node.visual_module.coordinates import Coordinates
from scene_graph import ROW_OF_THREE, Place, in_rows

from .hidden import with_clear_heights
from .standing import Places, Points, Standing

#: Gaps and runs narrower than this part of the image's width are noise of the mask.
NOISE_WIDTH: Final = 0.016
#: A count must hold on this part of the image's rows, in a row or not.
NOISE_ROWS: Final = 0.016
#: One block that is further than this from the middle of every place stands on none [m]; a centre
#: that is no higher than that over the table is of a block on it [m].
BESIDE: Final = 0.036
LOW: Final = 0.04
#: ... if the others stand so near to theirs, half of them or more: else it is the camera [m].
NEAR: Final = 0.018
#: Blocks whose axes are nearer than this, seen from above, are of one stack, unless places are [m].
JOINED: Final = 0.04


class RowOfPlaces:
    """Places side by side on the table.

    Attributes:
        places: from the left of the image; none where they are unknown.
    """

    def __init__(self, positions_world: Points = ROW_OF_THREE) -> None:
        self.places = tuple(Place(i, position) for i, position in enumerate(positions_world))

    def seen_by(self, camera: PinholeCamera | None) -> Places:
        """The same places in two rows, where they lie so for a camera."""
        return self if camera is None else _seen_by(self, camera)

    @property
    def positions(self) -> Points:
        """Their centres in world [m]."""
        return tuple(place.position_world for place in self.places)

    def stand(
        self,
        observation: Observation,
        segments: Segments,
        coordinates: Coordinates,
        centres_world: NDArray[np.float64] | None = None,
    ) -> Standing:
        """The stacks and their places: by where the blocks are measured on the table, if they are.

        Else, of a picture alone, by horizontal coordinate, each by vertical coordinate.

        Raises:
            BadImageError: if the camera does not see the places in order from the left.
        """
        if centres_world is not None and observation.camera is not None and self.places:
            self._columns(observation.camera)
            return self._stand_on_table(centres_world)
        count = min(count_stacks(segments.union()), len(segments))
        stacks = stacks_from_coordinates(coordinates.corners, count)
        if observation.camera is None or not self.places:
            return self._without_places(stacks)
        try:
            seen = [float(coordinates.centres[stack[0], 0]) for stack in stacks]
            assigned = assign_places(seen, self._columns(observation.camera))
        except PlacesError as error:
            return self._without_places(stacks, str(error))
        return Standing(
            with_empty_places(stacks, assigned, len(self.places)),
            tuple(place.position_world[2] for place in self.places),
            self.places,
        )

    def _stand_on_table(self, centres_world: NDArray[np.float64]) -> Standing:
        feet = self._positions()
        joined = JOINED
        if len(feet) > 1:
            gaps = np.linalg.norm(feet[:, None, :2] - feet[None, :, :2], axis=-1)
            joined = min(joined, 0.5 * float(gaps[~np.eye(len(feet), dtype=bool)].min()))
        apart = np.linalg.norm(centres_world[:, None, :2] - centres_world[None, :, :2], axis=-1)
        one, other = np.nonzero(apart < joined)
        count, group_of = components(len(apart), zip(one.tolist(), other.tolist()))
        stacks = []
        for group in range(count):
            members = np.flatnonzero(group_of == group)
            stacks.append(tuple(int(i) for i in members[np.argsort(centres_world[members, 2])]))
        beside = self._beside(stacks, centres_world)
        stacks = [stack for stack in stacks if stack not in beside]
        if len(stacks) > len(feet):
            return self._without_places((*stacks, *beside), too_many(count, len(feet)))
        middles = np.array([centres_world[list(stack), :2].mean(axis=0) for stack in stacks])
        squares = ((middles[:, None] - feet[None, :, :2]) ** 2).sum(axis=-1)
        rows, places = linear_sum_assignment(squares)
        by_place = [stacks[row] for row in rows]
        on_places = with_empty_places(by_place, [int(place) for place in places], len(feet))
        more = [
            Place(
                len(feet) + number,
                (float(centres_world[item, 0]), float(centres_world[item, 1]), float(feet[0, 2])),
                aside=True,
            )
            for number, (item,) in enumerate(beside)
        ]
        all_places = (*self.places, *more)
        return Standing(
            (*on_places, *beside),
            tuple(place.position_world[2] for place in all_places),
            all_places,
        )

    def _beside(
        self, stacks: Sequence[tuple[int, ...]], centres_world: NDArray[np.float64]
    ) -> list[tuple[int, ...]]:
        """The single blocks that stand on the table beside the places, while most stand on them."""
        if any(place.row for place in self.places):
            return []  # what they may hide is not known
        feet = self._positions()
        middles = np.array([centres_world[list(stack), :2].mean(axis=0) for stack in stacks])
        away = np.linalg.norm(middles[:, None] - feet[None, :, :2], axis=-1).min(axis=1)
        heights = centres_world[[stack[0] for stack in stacks], 2] - feet[0, 2]
        single = np.array([len(stack) == 1 for stack in stacks])
        beside = single & (away > BESIDE) & (heights <= LOW)
        if 2 * np.count_nonzero(away <= NEAR) < len(stacks):
            return []
        order = np.argsort(-middles[:, 1], kind="stable")
        return [stacks[int(index)] for index in order if beside[index]]

    def in_front(
        self, points_world: NDArray[np.float64], camera: PinholeCamera, margin: float
    ) -> NDArray[np.bool_]:
        """Whether points are inside the slab along the row, or between it and the camera."""
        ground = self._positions()[:, :2]
        toward = camera.position_world[:2] - ground.mean(0)
        if len(ground) > 1:
            row = ground[-1] - ground[0]
            toward = toward - row * (toward @ row) / (row @ row)
        toward = toward / np.linalg.norm(toward)
        back = (ground @ toward).min() - margin
        with np.errstate(invalid="ignore"):
            return points_world[..., :2] @ toward > back

    def _positions(self) -> NDArray[np.float64]:
        return np.array([place.position_world for place in self.places], dtype=np.float64)

    def _columns(self, camera: PinholeCamera) -> NDArray[np.float64]:
        """Where the places are across the image, as parts of its longer side, shape (m,)."""
        side = max(camera.width, camera.height)
        columns = (camera.project(self._positions())[:, 0] + 0.5) / side
        if np.any(np.diff(columns) <= 0.0) or not np.isfinite(columns).all():
            raise BadImageError(
                "the places are not in order from the left of the image; check the parameter "
                "stack_positions and camera/extrinsics"
            )
        return columns

    def _without_places(self, stacks: tuple[tuple[int, ...], ...], problem: str = "") -> Standing:
        height = self.places[0].position_world[2] if self.places else 0.0
        return Standing(stacks, (height,) * len(stacks), problem=problem)


@functools.lru_cache(maxsize=4)
def _seen_by(row: RowOfPlaces, camera: PinholeCamera) -> Places:
    from .two_rows import TwoRows  # which is a row of places itself

    places = in_rows(row.positions, _point(camera))
    if not any(place.row for place in places):
        return row
    return TwoRows(with_clear_heights(places, camera))


def _point(camera: PinholeCamera) -> tuple[float, float, float]:
    x, y, z = (float(value) for value in camera.position_world)
    return x, y, z


def count_stacks(mask: NDArray[np.bool_]) -> int:
    """k = ½ max over rows of the intersections between a horizontal line and the mask's outline.

    Every run of mask pixels in a row makes two intersections. Before they are counted, holes and
    gaps that are too narrow to be a gap between stacks are closed and specks that are too narrow to
    be a block are removed; afterwards, counts that are seen on a few rows only are ignored.

    Args:
        mask: union of all objects' masks, shape (height, width).

    Returns:
        Number of stacks; 0 for an empty mask.
    """
    height, width = mask.shape
    narrow = max(1, round(NOISE_WIDTH * width)) + 1
    rows = max(1, round(NOISE_ROWS * height))
    square = np.ones((narrow, narrow), np.uint8)
    padded = np.pad(mask.astype(np.uint8), narrow)
    closed = cv2.morphologyEx(padded, cv2.MORPH_CLOSE, square)
    opened = cv2.morphologyEx(closed, cv2.MORPH_OPEN, square)
    counts = np.count_nonzero(np.diff(opened.astype(np.int8), axis=1) > 0, axis=1)
    for count in range(counts.max(initial=0), 0, -1):
        if np.count_nonzero(counts >= count) >= rows:
            return count
    return int(mask.any())


def stacks_from_coordinates(
    coordinates: NDArray[np.float64], count: int
) -> tuple[tuple[int, ...], ...]:
    """Groups objects by horizontal coordinate and orders each group by vertical coordinate.

    Args:
        coordinates: from the bottom-left corner, (right, up), shape (N, 2).
        count: number of stacks k.

    Returns:
        For each stack from the left, the indices of its objects from the bottom.

    Raises:
        ClusteringError: if ``count`` is not in 1..N.
    """
    clusters = cluster_on_line(coordinates[:, 0], count)
    return tuple(
        tuple(int(i) for i in cluster[np.argsort(coordinates[cluster, 1], kind="stable")])
        for cluster in clusters
    )


def assign_places(columns: ArrayLike, place_columns: ArrayLike) -> list[int]:
    """Which place each stack stands on: the assignment of least squared distance that keeps order.

    Args:
        columns: horizontal image coordinates of k stacks, from the left.
        place_columns: those of the m places, from the left, in the same unit.

    Returns:
        k indices of places, ascending.

    Raises:
        PlacesError: if there are more stacks than places.
    """
    seen, places = np.asarray(columns, dtype=float), np.asarray(place_columns, dtype=float)
    k, m = len(seen), len(places)
    if k > m:
        raise PlacesError(too_many(k, m))
    best = np.full((k + 1, m + 1), np.inf)  # best[i, j]: i stacks on the first j places
    best[0] = 0.0
    for i in range(1, k + 1):
        for j in range(i, m + 1):
            taken = best[i - 1, j - 1] + (seen[i - 1] - places[j - 1]) ** 2
            best[i, j] = min(best[i, j - 1], taken)
    assigned = []
    i, j = k, m
    while i > 0:
        if best[i, j] < best[i, j - 1]:
            assigned.append(j - 1)
            i -= 1
        j -= 1
    return assigned[::-1]


def too_many(stacks: int, places: int) -> str:
    """What is said of more stacks than places."""
    return f"{stacks} stacks are seen but there are {places} places"


def with_empty_places(
    stacks: Sequence[Sequence[int]], places: Sequence[int], place_count: int
) -> tuple[tuple[int, ...], ...]:
    """The stacks of all m places, empty where none stands."""
    by_place = dict(zip(places, stacks))
    return tuple(tuple(by_place.get(index, ())) for index in range(place_count))
