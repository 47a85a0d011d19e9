# SPDX-License-Identifier: Apache-2.0
"""Places that nobody gave: where stacks stand, and free ones beside them (5.4.1).

The thesis finds stacks as connected components of a picture. Here they are those of the blocks as
they were measured, seen from above: the foot of a stack is its place, to the millimetre, however
far it was shifted. Free places lie on the line through them, as near as the hand has room.
"""

from __future__ import annotations

import itertools
from collections.abc import Sequence
from typing import Final

import numpy as np
from numpy.typing import NDArray
from scipy.sparse.csgraph import connected_components
from scipy.spatial import KDTree

from perception_node.blocks.measure import BlockSurface
from perception_node.camera import PinholeCamera
from perception_node.config import PlaceSearch
from perception_node.errors import HiddenPlacesError, PlacesError
from perception_node.observation import Observation
from perception_node.segment import Volume
from perception_node.segment.region import look_at

from .row import JOINED
from .standing import Points

Array = NDArray[np.float64]

#: So far beyond the arm's reach a stack is still told to be out of it [m].
BEYOND: Final = 0.1
#: Stacks that stand there may be nearer to each other than free places are laid, by this [m].
SLACK: Final = 0.015
#: What is less far apart across the view may hide what is behind it [m].
ACROSS: Final = 0.07
#: Nothing higher than this over the table is nearer to a free place [m] ...
LOW: Final = 0.01
BARE: Final = 0.07
#: ... whose middle is seen to be table, to this [m]; so far around it all is in the picture [m].
SEEN: Final = 0.02
SIDE: Final = 0.04
#: Free places are looked for at every so many metres along the line.
STEP: Final = 0.005
#: On so many steps of it, where they are hidden, a block of this height can stand unseen [m].
FITS: Final = 5
LOWEST: Final = 0.025


def search_volume(search: PlaceSearch, height: float) -> Volume:
    """Everything over the table as far as the arm reaches, and a little further.

    Args:
        height: of the highest tower [m].
    """
    far = search.reach[1] + BEYOND
    low, high = np.array([-far, -far, 0.0]), np.array([far, far, height])
    lift = np.array([0.0, 0.0, search.table_height])
    return Volume(low + lift, high + lift, np.zeros((1, 2)), near=far)


def find_places(
    observation: Observation,
    labelled: NDArray[np.bool_],
    surfaces: Sequence[BlockSurface],
    search: PlaceSearch,
    volume: Volume,
) -> Points:
    """The places, from the left of the picture [m].

    Args:
        observation: with depth and camera.
        labelled: the pixels of all blocks in the volume, shape (height, width).
        surfaces: of these blocks.
        volume: see :func:`search_volume`.

    Raises:
        HiddenPlacesError: if something else may hide a stack beside those that are seen.
        PlacesError: if the stacks cannot stand on places of one row that the arm reaches.

    There are none where no stack is seen.
    """
    camera = observation.camera
    assert camera is not None
    feet = _in_reach(_feet(surfaces), search)
    if not len(feet):
        return ()
    _check_seen(feet, observation, labelled, search)
    _check_apart(feet, search)
    if search.count and len(feet) > search.count:
        raise PlacesError(
            f"{len(feet)} stacks are seen but place_count is {search.count}; take blocks away, "
            "or raise place_count"
        )
    feet = _from_the_left(feet, camera)
    if missing := max(search.count - len(feet), 0):
        free = _free(feet, missing, observation, search, volume)
        feet = _from_the_left(np.concatenate([feet, free]), camera)
    return tuple((float(x), float(y), search.table_height) for x, y in feet)


def _feet(surfaces: Sequence[BlockSurface]) -> Array:
    """Where the lowest block of each stack stands, shape (k, 2) [m]."""
    centres = np.array([item.position for item in surfaces], dtype=np.float64).reshape(-1, 2)
    apart = np.linalg.norm(centres[:, None] - centres[None], axis=-1)
    count, group_of = connected_components(apart < JOINED, directed=False)
    low = np.array([item.low for item in surfaces])
    groups = [np.flatnonzero(group_of == group) for group in range(count)]
    return centres[[int(group[low[group].argmin()]) for group in groups]]


def _in_reach(feet: Array, search: PlaceSearch) -> Array:
    """The feet without those that are far off, or the arm's own.

    Raises PlacesError for one that is just out of reach.
    """
    nearest, farthest = search.reach
    away = np.hypot(*feet.T)
    near = (away > nearest - BEYOND) & (away < farthest + BEYOND)
    feet, away = feet[near], away[near]
    for foot, distance in zip(feet, away):
        if not nearest <= distance <= farthest:
            raise PlacesError(
                f"a stack stands at {_spot(foot)}, {distance:.2f} m from the arm's axis, which "
                f"reaches {nearest:g} to {farthest:g} m (place_reach); move it, or take it away"
            )
    return feet


def _check_apart(feet: Array, search: PlaceSearch) -> None:
    """Raises PlacesError for stacks without room for the hand between them."""
    for index, foot in enumerate(feet):
        for other in feet[:index]:
            distance = float(np.hypot(*(foot - other)))
            if distance < search.gap - SLACK:
                raise PlacesError(
                    f"the stacks at {_spot(other)} and {_spot(foot)} are {1000 * distance:.0f} mm "
                    f"apart, and the hand needs {1000 * (search.gap - SLACK):.0f} mm; move one, "
                    "or lower place_gap"
                )


def _from_the_left(feet: Array, camera: PinholeCamera) -> Array:
    """The feet in their order; raises PlacesError where one may hide what is behind it."""
    away = feet - camera.position_world[:2]
    forward = away.mean(axis=0)
    forward = forward / np.linalg.norm(forward)
    across = away @ np.array([forward[1], -forward[0]])
    order = np.argsort(across, kind="stable")
    for left, right in itertools.pairwise(order):
        if across[right] - across[left] < ACROSS:
            raise PlacesError(
                f"of {_spot(feet[left])} and {_spot(feet[right])} one stands before the other, "
                "as the camera sees them; move one aside, or give two rows of places "
                "(stack_positions)"
            )
    return feet[order]


def _free(
    feet: Array, missing: int, observation: Observation, search: PlaceSearch, volume: Volume
) -> Array:
    """So many more, on the line through the feet, each as near to the others as there is room.

    Of two that are equally near, that which is nearer to the middle of the picture.
    """
    camera = observation.camera
    assert camera is not None
    spots = _line(feet, camera, search)
    spots = spots[_are_bare(spots, observation, search, volume)]
    aside = np.abs(_pixels(spots, camera, search)[:, 0] - 0.5 * camera.width)
    taken = feet
    while len(taken) < len(feet) + missing:
        away = np.linalg.norm(spots[:, None] - taken[None], axis=-1).min(axis=1, initial=np.inf)
        room = np.flatnonzero(away >= search.gap)
        if not len(room):
            raise PlacesError(
                f"beside {len(feet)} stacks there is room for {len(taken) - len(feet)} free "
                f"places, {1000 * search.gap:.0f} mm apart, in reach and in the picture; "
                "place_count asks for "
                f"{search.count}; lower it or place_gap, or move the stacks"
            )
        best = room[np.lexsort((aside[room], np.round(away[room] / STEP)))[0]]
        taken = np.concatenate([taken, spots[best : best + 1]])
    return taken[len(feet) :]


def _line(feet: Array, camera: PinholeCamera, search: PlaceSearch) -> Array:
    """Spots in reach on the line through the feet, shape (n, 2) [m]."""
    middle, along = feet.mean(axis=0), camera.world_from_optical[:2, 0]
    if len(feet) > 1:
        along = np.linalg.svd(feet - middle)[2][0]
    along = along / np.linalg.norm(along)
    span = np.arange(-2.0 * search.reach[1], 2.0 * search.reach[1], STEP)
    spots = middle + span[:, None] * along
    distance = np.hypot(*spots.T)
    in_reach = (distance >= search.reach[0]) & (distance <= search.reach[1])
    return spots[in_reach]


def _check_seen(
    feet: Array, observation: Observation, labelled: NDArray[np.bool_], search: PlaceSearch
) -> None:
    """Raises HiddenPlacesError for what is no block and may hide a stack of the row."""
    camera, depth = observation.camera, observation.depth
    assert camera is not None and depth is not None
    spots = _line(feet, camera, search)
    pixels = np.rint(_pixels(spots, camera, search, LOWEST))
    with np.errstate(invalid="ignore"):
        inside = ((pixels >= 0) & (pixels < (camera.width, camera.height))).all(axis=1)
    spots, pixels = spots[inside], pixels[inside]
    columns, rows = pixels.astype(int).T
    seen = depth[rows, columns]
    points = camera.position_world + seen[:, None] * camera.rays_world(pixels)
    away = [np.hypot(*(at[:, :2] - camera.position_world[:2]).T) for at in (points, spots)]
    with np.errstate(invalid="ignore"):
        hides = (seen > 0.0) & ~labelled[rows, columns] & (away[0] < away[1] - BARE)
        hides &= points[:, 2] > search.table_height + LOW
        hides &= np.hypot(*points[:, :2].T) > search.reach[0] - BEYOND  # else the arm's own foot
    ends = np.flatnonzero(~np.concatenate([[False], hides, [False]]))
    longest = int(np.argmax(np.diff(ends)))
    if np.diff(ends)[longest] > FITS:
        spot = spots[(ends[longest] + ends[longest + 1] - 1) // 2]
        raise HiddenPlacesError(
            f"something that is not a block hides {_spot(spot)}, where a stack may stand; places "
            "are found when it is gone"
        )


def _are_bare(
    spots: Array, observation: Observation, search: PlaceSearch, volume: Volume
) -> NDArray[np.bool_]:
    """Whether at each spot nothing but table is seen, shape (n, 2) [m] -> (n,)."""
    camera, region = observation.camera, look_at(observation, volume)
    assert camera is not None
    bare = np.full(len(spots), region is not None)
    if region is None:
        return bare
    for shift in SIDE * np.array([[-1, -1], [-1, 1], [1, -1], [1, 1], [0, 0]]):
        pixels = _pixels(spots + shift, camera, search)
        with np.errstate(invalid="ignore"):
            inside = (pixels >= 0.0) & (pixels <= (camera.width - 1, camera.height - 1))
        bare &= inside.all(axis=1)
    points = region.points[region.inside].astype(np.float64)
    high = points[:, 2] > volume.floor + LOW
    for near, clear in ((points[high], True), (points[~high], False)):
        if len(near):
            away = KDTree(near[:, :2]).query(spots)[0]
            bare &= (away >= BARE) if clear else (away <= SEEN)
        elif not clear:
            bare[:] = False
    return bare


def _pixels(spots: Array, camera: PinholeCamera, search: PlaceSearch, height: float = 0.0) -> Array:
    """Where spots are seen, so high over the table, (n, 2) [m] -> (n, 2) [px]."""
    return camera.project(
        np.column_stack([spots, np.full(len(spots), search.table_height + height)])
    )


def _spot(foot: Array) -> str:
    return f"({foot[0]:.2f}, {foot[1]:.2f}) m"
