# SPDX-License-Identifier: Apache-2.0
"""From the objects' coordinates to stacks and places (5.2.1, A.2.2)."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
from numpy.typing import ArrayLike, NDArray

from .clustering import cluster_on_line
from .errors import PerceptionError


def stacks_from_coordinates(coordinates: NDArray[np.float64], count: int) -> list[list[int]]:
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
    return [
        [int(i) for i in cluster[np.argsort(coordinates[cluster, 1], kind="stable")]]
        for cluster in clusters
    ]


def assign_places(columns: ArrayLike, place_columns: ArrayLike) -> list[int]:
    """Which place each stack stands on: the assignment of least squared distance that keeps order.

    Args:
        columns: horizontal image coordinates of k stacks, from the left.
        place_columns: those of the m places, from the left, in the same unit.

    Returns:
        k indices of places, ascending.

    Raises:
        PerceptionError: if there are more stacks than places.
    """
    seen, places = np.asarray(columns, dtype=float), np.asarray(place_columns, dtype=float)
    k, m = len(seen), len(places)
    if k > m:
        raise PerceptionError(f"{k} stacks are seen but there are {m} places")
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


def with_empty_places(
    stacks: Sequence[Sequence[int]], places: Sequence[int], place_count: int
) -> list[list[int]]:
    """The stacks of all m places, empty where none stands."""
    result: list[list[int]] = [[] for _ in range(place_count)]
    for stack, place in zip(stacks, places):
        result[place] = list(stack)
    return result
