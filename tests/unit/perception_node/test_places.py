# SPDX-License-Identifier: Apache-2.0
"""Coordinates become stacks, and stacks are assigned to places (5.2.1, A.2.2)."""

import itertools

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from perception_node.errors import PerceptionError
from perception_node.stacks_from_coordinates import (
    assign_places,
    stacks_from_coordinates,
    with_empty_places,
)


def test_objects_are_grouped_by_column_and_ordered_from_the_bottom() -> None:
    coordinates = np.array([[0.7, 0.4], [0.1, 0.2], [0.71, 0.2], [0.11, 0.6], [0.1, 0.4]])
    assert stacks_from_coordinates(coordinates, 2) == [[1, 4, 3], [2, 0]]


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
    assert with_empty_places([[2, 0], [1]], [0, 2], 3) == [[2, 0], [], [1]]
