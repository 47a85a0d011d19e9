# SPDX-License-Identifier: Apache-2.0
"""Numbers on a line are clustered optimally; brute force is the oracle."""

import itertools

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from perception_node.clustering import cluster_on_line, within_cluster_cost
from perception_node.errors import ClusteringError

numbers = st.lists(st.floats(-100.0, 100.0), min_size=1, max_size=7)


def least_cost(values: list[float], count: int) -> float:
    """Over every way to give each value one of ``count`` non-empty clusters."""
    points = np.array(values)
    costs = []
    for owners in itertools.product(range(count), repeat=len(points)):
        groups = [points[np.array(owners) == owner] for owner in range(count)]
        if all(len(group) for group in groups):
            costs.append(sum(float(np.sum((g - g.mean()) ** 2)) for g in groups))
    return min(costs)


@settings(max_examples=60)
@given(numbers, st.integers(1, 3))
def test_no_other_clustering_is_better(values: list[float], count: int) -> None:
    count = min(count, len(values))
    found = within_cluster_cost(values, cluster_on_line(values, count))
    assert found == pytest.approx(least_cost(values, count), rel=1e-9, abs=1e-6)


@given(numbers, st.integers(1, 4))
def test_clusters_are_intervals_from_the_left_and_hold_every_value_once(
    values: list[float], count: int
) -> None:
    count = min(count, len(values))
    clusters = cluster_on_line(values, count)
    order = np.concatenate(clusters)
    assert sorted(order) == list(range(len(values)))
    assert all(len(cluster) for cluster in clusters)
    assert (np.diff(np.array(values)[order]) >= 0).all()


@given(numbers, st.floats(-50.0, 50.0))
def test_moving_all_values_changes_nothing(values: list[float], shift: float) -> None:
    values = [round(value) for value in values]
    moved = [value + round(shift) for value in values]
    assert [c.tolist() for c in cluster_on_line(values, min(2, len(values)))] == [
        c.tolist() for c in cluster_on_line(moved, min(2, len(values)))
    ]


def test_gaps_of_very_different_size_are_no_difficulty() -> None:
    # Seeded k-means merges the first two groups here and splits the third.
    values = [0.0, 0.01, 1.0, 1.01, 20.0, 20.4, 20.8]
    clusters = cluster_on_line(values, 3)
    assert [sorted(c.tolist()) for c in clusters] == [[0, 1], [2, 3], [4, 5, 6]]


@pytest.mark.parametrize("count", [0, 3])
def test_an_impossible_number_of_clusters_is_refused(count: int) -> None:
    with pytest.raises(ClusteringError, match="2 values"):
        cluster_on_line([1.0, 2.0], count)


def test_values_that_are_not_numbers_are_refused() -> None:
    with pytest.raises(ClusteringError, match="finite"):
        cluster_on_line([1.0, float("nan")], 1)
