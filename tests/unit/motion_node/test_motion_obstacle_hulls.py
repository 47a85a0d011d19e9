# SPDX-License-Identifier: Apache-2.0
"""The gap of a sphere to an obstacle: never more than the distance, and hardly less."""

from __future__ import annotations

import casadi as ca
import numpy as np
from hypothesis import given, settings
from hypothesis import strategies as st
from numpy.typing import NDArray

from motion_node.constraints.obstacle_hulls import (
    OBSTACLE_SIZE,
    ObstacleHull,
    obstacle_parameters,
    sphere_gap,
)
from motion_node.obstacles import Obstacle

RADIUS = 0.06
#: Where the sphere is outside; what the smooth absolute values and roundings cost [m].
OVER, UNDER = 1e-6, 6e-3


def gap_function() -> ca.Function:
    center, parameters = ca.SX.sym("center", 3), ca.SX.sym("parameters", OBSTACLE_SIZE)
    return ca.Function(
        "gap", [center, parameters], [sphere_gap(center, RADIUS, ObstacleHull(parameters))]
    )


GAP = gap_function()


def distance(item: Obstacle, center: NDArray[np.float64]) -> float:
    """Of the sphere to the box or cylinder, exactly."""
    c, s = np.cos(item.yaw), np.sin(item.yaw)
    local = np.array([[c, s, 0], [-s, c, 0], [0, 0, 1]]) @ (center - np.array(item.position_world))
    half = np.array(item.size) / 2
    if item.round:
        level = max(np.hypot(local[0], local[1]) - half[0], 0.0)
        return float(np.hypot(level, max(abs(local[2]) - half[2], 0.0)) - RADIUS)
    return float(np.linalg.norm(np.maximum(np.abs(local) - half, 0.0)) - RADIUS)


@settings(max_examples=300, deadline=None)
@given(seed=st.integers(0, 2**32 - 1), round_=st.booleans())
def test_a_spheres_gap_is_its_distance_from_below(seed: int, round_: bool) -> None:
    rng = np.random.default_rng(seed)
    width, depth, height = rng.uniform(0.02, 0.4, 3)
    size = (width, width if round_ else depth, height)
    item = Obstacle("thing", size, (0.1, -0.2, 0.3), rng.uniform(-3.0, 3.0), round_)
    center = np.array(item.position_world) + rng.uniform(-0.5, 0.5, 3)
    exact = distance(item, center)
    gap = float(GAP(center, obstacle_parameters([item], 1)))
    if exact > -RADIUS:
        assert exact - UNDER < gap < exact + OVER
    else:  # its center is inside
        assert gap < -RADIUS + OVER
