# SPDX-License-Identifier: Apache-2.0
"""Stacks in a row are counted, grouped and assigned to places (5.2.1, A.2.2, A.2.4)."""

import itertools

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from numpy.typing import NDArray
from perception_scenes import PLACES, looking_camera

from perception_node.errors import BadImageError, PerceptionError
from perception_node.observation import Observation
from perception_node.places import Standing
from perception_node.places.row import (
    RowOfPlaces,
    assign_places,
    count_stacks,
    stacks_from_coordinates,
    with_empty_places,
)
from perception_node.segment import Segments
from perception_node.visual_module.coordinates import Coordinates
from scene_graph import Place


def test_objects_are_grouped_by_column_and_ordered_from_the_bottom() -> None:
    coordinates = np.array([[0.7, 0.4], [0.1, 0.2], [0.71, 0.2], [0.11, 0.6], [0.1, 0.4]])
    assert stacks_from_coordinates(coordinates, 2) == ((1, 4, 3), (2, 0))


@given(
    st.lists(st.floats(0.0, 1.0), min_size=1, max_size=4),
    st.lists(st.floats(0.0, 1.0), min_size=4, max_size=5),
)
def test_no_assignment_that_keeps_the_order_is_nearer(
    seen: list[float], places: list[float]
) -> None:
    seen, places = sorted(seen), sorted(places)
    found = assign_places(seen, places)
    assert found == sorted(set(found)) and len(found) == len(seen)

    def cost(chosen: tuple[int, ...] | list[int]) -> float:
        return sum((a - places[i]) ** 2 for a, i in zip(seen, chosen))

    best = min(cost(chosen) for chosen in itertools.combinations(range(len(places)), len(seen)))
    assert cost(found) == pytest.approx(best)


def test_a_single_stack_stands_on_the_nearest_place() -> None:
    assert assign_places([0.52], [0.2, 0.5, 0.8]) == [1]
    assert assign_places([0.75], [0.2, 0.5, 0.8]) == [2]


def test_more_stacks_than_places_are_refused() -> None:
    with pytest.raises(PerceptionError, match="4 stacks are seen but there are 3 places"):
        assign_places([0.1, 0.3, 0.5, 0.7], [0.2, 0.5, 0.8])


def test_places_without_a_stack_are_empty() -> None:
    assert with_empty_places([[2, 0], [1]], [0, 2], 3) == ((2, 0), (), (1,))


CAMERA = looking_camera()


def stand(row: RowOfPlaces, columns: list[int], known: bool = True) -> Standing:
    """Of single blocks of 22 px, whose left edges are at these columns of the image [px]."""
    labels = np.zeros((256, 256), np.uint16)
    for number, left in enumerate(columns, start=1):
        labels[180:202, left : left + 22] = number
    corners = np.array([[left / 256, 54 / 256] for left in columns])
    coordinates = Coordinates(corners, corners, corners + 11 / 256, np.ones(len(columns)))
    rgb = np.zeros((256, 256, 3), np.uint8)
    observation = Observation(rgb, labels, None, CAMERA if known else None)
    return row.stand(observation, Segments.from_labels(labels), coordinates)


def columns_of(row: RowOfPlaces) -> list[int]:
    """Left edges of blocks on all places [px]."""
    pixels = CAMERA.project([place.position_world for place in row.places])
    return [round(float(u)) - 11 for u, _ in pixels]


def test_every_place_has_its_stack() -> None:
    row = RowOfPlaces(PLACES)
    left, _, right = columns_of(row)
    standing = stand(row, [right, left])
    assert standing.stacks == ((1,), (), (0,))
    assert standing.places == tuple(Place(i, position) for i, position in enumerate(PLACES))
    assert standing.table_heights == (0.0, 0.0, 0.0) and standing.problem == ""


def test_more_stacks_than_places_are_a_problem_but_still_stacks() -> None:
    standing = stand(RowOfPlaces(PLACES[:2]), columns_of(RowOfPlaces(PLACES)))
    assert standing.stacks == ((0,), (1,), (2,)) and standing.places == ()
    assert standing.problem == "3 stacks are seen but there are 2 places"


def stand_at(*centres: tuple[float, float, float]) -> Standing:
    """Of blocks that were measured there [m]."""
    labels = np.resize(np.arange(1, len(centres) + 1, dtype=np.uint16), (256, 256))
    spread = np.tile([[0.5, 0.5]], (len(centres), 1))
    coordinates = Coordinates(spread, spread, spread, np.ones(len(centres)))
    observation = Observation(np.zeros((256, 256, 3), np.uint8), labels, None, CAMERA)
    segments = Segments.from_labels(labels)
    return RowOfPlaces(PLACES).stand(observation, segments, coordinates, np.array(centres))


def test_a_block_beside_the_places_stands_on_a_spot_of_its_own() -> None:
    standing = stand_at(
        (0.5, -0.15, 0.02), (0.56, 0.02, 0.02), (0.5, -0.15, 0.065), (0.5, 0.15, 0.02)
    )
    assert standing.stacks == ((0, 2), (), (3,), (1,))
    assert standing.places[3] == Place(3, (0.56, 0.02, 0.0), aside=True)
    assert [place.aside for place in standing.places[:3]] == [False] * 3
    assert standing.table_heights == (0.0,) * 4 and standing.problem == ""


@pytest.mark.parametrize(
    "centres",
    [
        [(0.56, -0.15, 0.02), (0.56, 0.0, 0.02), (0.56, 0.15, 0.02)],  # all: the camera is wrong
        [(0.5, -0.15, 0.02), (0.56, 0.0, 0.2)],  # in the air
        [(0.5, -0.15, 0.02), (0.56, 0.0, 0.02), (0.56, 0.0, 0.065)],  # a tower
        [(0.5, -0.15, 0.02), (0.53, 0.0, 0.02)],  # near enough
    ],
)
def test_what_is_no_single_block_beside_them_is_taken_to_be_on_the_nearest_place(
    centres: list[tuple[float, float, float]],
) -> None:
    assert not any(place.aside for place in stand_at(*centres).places)


@pytest.mark.parametrize(("places", "known"), [((), True), (PLACES, False)])
def test_without_places_or_camera_stacks_are_those_seen_from_the_left(
    places: tuple[tuple[float, float, float], ...], known: bool
) -> None:
    standing = stand(RowOfPlaces(places), [150, 20], known)
    assert standing == Standing(((1,), (0,)), (0.0, 0.0))


def test_places_that_the_camera_sees_in_another_order_are_refused() -> None:
    with pytest.raises(BadImageError, match="stack_positions"):
        stand(RowOfPlaces(PLACES[::-1]), [100])


@pytest.mark.parametrize(
    ("point", "expected"),
    [
        ((0.5, 0.075, 0.1), True),
        ((0.9, 0.4, 0.1), True),
        ((0.47, -0.4, 0.1), True),
        ((0.46, 0.0, 0.1), False),
        ((np.nan, 0.0, 0.1), False),
    ],
)
def test_what_is_among_the_row_or_nearer_is_in_front(
    point: tuple[float, float, float], expected: bool
) -> None:
    assert bool(RowOfPlaces(PLACES).in_front(np.array(point), CAMERA, 0.035)) is expected


def mask_of(heights: list[int], width: int = 22, gap: int = 50) -> NDArray[np.bool_]:
    """Towers of blocks of 22 px side by side; height 0 leaves the place empty."""
    mask = np.zeros((256, 256), bool)
    for index, height in enumerate(heights):
        left = 10 + index * (width + gap)
        mask[200 - 22 * height : 200, left : left + width] = True
    return mask


@given(st.lists(st.integers(0, 7), min_size=1, max_size=3))
def test_it_is_the_number_of_towers(heights: list[int]) -> None:
    assert count_stacks(mask_of(heights)) == sum(height > 0 for height in heights)


def test_towers_may_stand_close_together() -> None:
    assert count_stacks(mask_of([1, 3, 2, 1], gap=8)) == 4


@pytest.mark.parametrize("seed", range(5))
def test_lost_pixels_and_specks_do_not_count(seed: int) -> None:
    rng = np.random.default_rng(seed)
    mask = mask_of([2, 0, 5])
    mask &= rng.random(mask.shape) > 0.25
    mask |= rng.random(mask.shape) < 0.002
    assert count_stacks(mask) == 2


def test_one_broken_row_does_not_count() -> None:
    mask = mask_of([3])
    mask[150, 18:24] = False
    assert count_stacks(mask) == 1


def test_a_tower_that_leans_is_one() -> None:
    mask = np.zeros((256, 256), bool)
    for level in range(5):
        mask[200 - 22 * (level + 1) : 200 - 22 * level, 100 + 7 * level : 122 + 7 * level] = True
    assert count_stacks(mask) == 1


def test_an_empty_mask_has_none() -> None:
    assert count_stacks(np.zeros((64, 64), bool)) == 0
