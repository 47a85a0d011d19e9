# SPDX-License-Identifier: Apache-2.0
"""Optimal clustering of numbers on a line, for the stacks' horizontal coordinates (5.2.1).

The thesis groups them with k-means. Lloyd's iteration from random seeds gets caught in local
minima when the gaps between stacks differ much; in one dimension the optimum of the same objective
is found exactly, because optimal clusters are intervals of the sorted values (Fisher, 1958).
"""

from __future__ import annotations

import numpy as np
from numpy.typing import ArrayLike, NDArray

from .errors import ClusteringError


def cluster_on_line(values: ArrayLike, count: int) -> list[NDArray[np.intp]]:
    """Splits values into ``count`` non-empty clusters of least squared distance to their means.

    Dynamic programming over the sorted values, O(n²·count).

    Args:
        values: shape (n,), any unit.
        count: number of clusters, 1 to n.

    Returns:
        One array of indices into ``values`` per cluster; clusters and indices are ordered by value.

    Raises:
        ClusteringError: if ``count`` is not in 1..n, or a value is not finite.
    """
    points = np.asarray(values, dtype=np.float64)
    n = len(points)
    if not 1 <= count <= n:
        raise ClusteringError(f"{n} values cannot form {count} clusters")
    if not np.isfinite(points).all():
        raise ClusteringError("values to cluster must be finite")
    order = np.argsort(points, kind="stable")
    cost = _interval_costs(points[order])
    best = np.full((count + 1, n + 1), np.inf)  # best[c, j]: c clusters hold the first j values
    first = np.zeros((count + 1, n + 1), dtype=np.intp)  # start of the last of those clusters
    best[0, 0] = 0.0
    for clusters in range(1, count + 1):
        for end in range(clusters, n + 1):
            totals = best[clusters - 1, :end] + cost[:end, end]
            first[clusters, end] = np.argmin(totals)
            best[clusters, end] = totals[first[clusters, end]]
    found = []
    end = n
    for clusters in range(count, 0, -1):
        start = first[clusters, end]
        found.append(order[start:end])
        end = start
    return found[::-1]


def within_cluster_cost(values: ArrayLike, clusters: list[NDArray[np.intp]]) -> float:
    """Sum over clusters of squared distances to the cluster's mean: the objective of k-means."""
    points = np.asarray(values, dtype=np.float64)
    return float(sum(np.sum((points[c] - points[c].mean()) ** 2) for c in clusters))


def _interval_costs(ordered: NDArray[np.float64]) -> NDArray[np.float64]:
    """cost[i, j] of the cluster of values i..j-1, shape (n + 1, n + 1); infinite where empty."""
    n = len(ordered)
    centred = ordered - ordered.mean()  # keeps the difference of sums below well conditioned
    total = np.concatenate([[0.0], np.cumsum(centred)])
    squares = np.concatenate([[0.0], np.cumsum(centred**2)])
    start, end = np.meshgrid(np.arange(n + 1), np.arange(n + 1), indexing="ij")
    size = np.maximum(end - start, 1)
    cost = squares[end] - squares[start] - (total[end] - total[start]) ** 2 / size
    return np.where(end > start, np.maximum(cost, 0.0), np.inf)
