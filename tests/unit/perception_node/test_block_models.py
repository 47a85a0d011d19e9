# SPDX-License-Identifier: Apache-2.0
"""Models of blocks: finite differences and ray-cast solids are the oracle."""

import cv2
import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from numpy.typing import NDArray
from perception_scenes import PLACES, Solid, cast, looking_camera

from perception_node.blocks.models import BallModel, BoxModel, CylinderModel, Model, Seen
from scene_graph import BOX, CYLINDER, SPHERE

CAMERA = looking_camera()
MODELS: dict[str, Model] = {BOX: BoxModel(), CYLINDER: CylinderModel(), SPHERE: BallModel()}
#: Of finite differences [m, rad].
STEP = 1e-7

shapes = st.sampled_from(sorted(MODELS))
half_edges = st.floats(0.015, 0.03)


@st.composite
def solids(draw: st.DrawFn) -> Solid:
    """A block on or over a place."""
    shape = draw(shapes)
    half = (draw(half_edges), draw(half_edges), draw(half_edges))
    if shape != BOX:
        half = (half[0],) * 3
    x, y, z = PLACES[draw(st.integers(0, 2))]
    # Never as high as the camera: from there its lid is a line.
    height = half[2] + draw(st.floats(0.0, 0.25))
    yaw = draw(st.floats(-0.78, 0.78)) if shape == BOX else 0.0
    return Solid(shape, (x, y, z + height), half, yaw)


def parameters_of(solid: Solid) -> NDArray[np.float64]:
    (x, y, z), half = solid.centre, solid.halves
    ends = [z - half[2], z + half[2]]
    if solid.shape == BOX:
        return np.array([x, y, solid.yaw, 2 * half[0], 2 * half[1], *ends])
    return np.array([x, y, half[0], *ends] if solid.shape == CYLINDER else [x, y, z, half[0]])


def seen_of(solid: Solid, noise: float = 0.0, seed: int = 0) -> Seen:
    depth, labels = cast([solid], CAMERA)
    rows, columns = np.nonzero(labels == 1)
    rays = CAMERA.rays_world(np.stack([columns, rows], axis=-1))
    depths = depth[rows, columns]
    depths = depths + np.random.default_rng(seed).normal(0.0, noise, depths.shape)
    points = CAMERA.position_world + rays * depths[:, None]
    doubt = np.full(depths.shape, max(noise, 2e-4))
    return Seen(CAMERA.position_world, points[None], rays[None], doubt[None])


@settings(max_examples=40)
@given(solids())
def test_what_is_seen_of_a_block_lies_on_the_model_with_its_parameters(solid: Solid) -> None:
    surface = MODELS[solid.shape].surface(parameters_of(solid)[None], seen_of(solid))
    assert np.abs(surface.off).max() < 1e-9


@settings(max_examples=40)
@given(solids(), st.integers(0, 1000), st.floats(-0.005, 0.005))
def test_slopes_are_those_of_finite_differences(solid: Solid, seed: int, wrong: float) -> None:
    model, seen = MODELS[solid.shape], seen_of(solid, 0.001, seed)
    rng = np.random.default_rng(seed)
    start = parameters_of(solid)
    start = start + wrong * rng.uniform(-1.0, 1.0, start.shape)
    here = model.surface(start[None], seen)
    for index in range(len(start)):
        step = STEP * np.eye(len(start))[index]
        after, before = (model.surface((start + way * step)[None], seen).off[0] for way in (1, -1))
        # Where a point goes over to another face there is no derivative.
        smooth = np.abs(after - 2.0 * here.off[0] + before) < 1e-3 * STEP
        assert smooth.mean() > 0.9
        found = (after - before) / (2.0 * STEP)
        assert here.slopes[0, smooth, index] == pytest.approx(found[smooth], abs=1e-4)


@settings(max_examples=40)
@given(solids())
def test_the_outline_is_that_of_the_ray_cast_block(solid: Solid) -> None:
    _, labels = cast([solid], CAMERA)
    points = MODELS[solid.shape].outline(parameters_of(solid), CAMERA.position_world)
    hull = cv2.convexHull(CAMERA.project(points).astype(np.float32))
    around = cv2.dilate((labels == 1).astype(np.uint8), np.ones((5, 5), np.uint8))
    at = np.argwhere(around > 0)
    inside = np.array(
        [cv2.pointPolygonTest(hull, (float(column), float(row)), True) for row, column in at]
    )
    covered = labels[tuple(at.T)] == 1
    # [px]
    assert inside[covered].min() > -0.1 and inside[~covered].max() < 0.1


@settings(max_examples=40)
@given(solids().filter(lambda solid: solid.shape == BOX), st.floats(0.0, 0.005))
def test_what_grows_behind_changes_nothing_that_is_seen(solid: Solid, by: float) -> None:
    model, seen, start = BoxModel(), seen_of(solid), parameters_of(solid)
    for direction in model.hidden(start[None], CAMERA.position_world)[:2, 0]:
        changed = model.surface((start + by * direction)[None], seen)
        assert np.abs(changed.off).max() < 1e-9
