# SPDX-License-Identifier: Apache-2.0
"""Pixels and points of the pinhole camera fit together."""

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from perception_scenes import looking_camera

from perception_node.camera import PinholeCamera
from perception_node.errors import BadImageError

CAMERA = looking_camera()
points = st.tuples(st.floats(0.2, 0.9), st.floats(-0.3, 0.3), st.floats(0.0, 0.5))


@given(points)
def test_a_point_lies_on_the_ray_of_its_pixel(point: tuple[float, float, float]) -> None:
    ray = CAMERA.rays_world(CAMERA.project(point))
    offset = np.array(point) - CAMERA.position_world
    assert np.cross(ray, offset) == pytest.approx(0.0, abs=1e-9)


@given(points)
def test_depth_brings_a_pixel_back_to_its_point(point: tuple[float, float, float]) -> None:
    forward = CAMERA.world_from_optical[:3, 2]
    depth = float((np.array(point) - CAMERA.position_world) @ forward)
    ray = CAMERA.rays_world(CAMERA.project(point))
    assert CAMERA.position_world + depth * ray == pytest.approx(np.array(point), abs=1e-9)


def test_a_world_point_to_the_right_and_above_is_right_and_above_in_the_image() -> None:
    u, v = CAMERA.project([0.5, 0.1, 0.1])
    right, _ = CAMERA.project([0.5, 0.15, 0.1])
    _, above = CAMERA.project([0.5, 0.1, 0.2])
    assert right > u and above < v


def test_what_is_behind_the_camera_has_no_pixel() -> None:
    assert np.isnan(CAMERA.project([3.0, 0.0, 0.4])).all()


@given(points)
def test_the_middle_of_an_image_cut_into_halves_stays_the_same_direction(
    point: tuple[float, float, float],
) -> None:
    # Pixel p of the large image covers the corner positions p - 1/2 to p + 1/2.
    half = CAMERA.resized(128, 128)
    assert (half.project(point) + 0.5) * 2.0 == pytest.approx(CAMERA.project(point) + 0.5, abs=1e-9)


def test_an_image_with_other_proportions_is_refused() -> None:
    with pytest.raises(BadImageError, match=r"320x240.*256x256"):
        CAMERA.resized(320, 240)


@pytest.mark.parametrize("damage", ["zero", "nan", "scaled"])
def test_a_camera_that_cannot_be_is_refused(damage: str) -> None:
    intrinsics, pose = CAMERA.intrinsics.copy(), CAMERA.world_from_optical.copy()
    if damage == "zero":
        intrinsics[:] = 0.0
    elif damage == "nan":
        pose[0, 3] = np.nan
    else:
        pose[:3, :3] *= 1.1
    with pytest.raises(BadImageError, match="camera"):
        PinholeCamera(intrinsics, pose, 256, 256)


@given(points, st.integers(0, 100), st.integers(0, 100))
def test_a_part_of_a_depth_picture_is_where_the_rays_of_its_pixels_end(
    point: tuple[float, float, float], top: int, left: int
) -> None:
    depth = np.full((20, 30), float(np.linalg.norm(point)), np.float32)
    depth[3, 4] = np.nan
    rows, columns = np.mgrid[top : top + 20, left : left + 30]
    rays = CAMERA.rays_world(np.stack([columns, rows], axis=-1))
    found = CAMERA.points_world(depth, np.s_[top : top + 20, left : left + 30])
    expected = CAMERA.position_world + rays * depth[..., None].astype(np.float64)
    assert found == pytest.approx(expected, abs=1e-6, nan_ok=True)
