# SPDX-License-Identifier: Apache-2.0
"""A lens shows things where OpenCV says that it does, and several cameras show one world."""

from __future__ import annotations

from dataclasses import replace

import cv2
import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from numpy.typing import NDArray
from scipy.ndimage import binary_erosion

from scene_graph import rotation_from_quaternion
from sim_node.frame import Frame
from sim_node.scene import CameraConfig, SceneConfig, load_scene, parse_scene
from sim_node.scene.distortion import FoldedPictureError, distorted, undistorted
from sim_node.world import World

BARREL = (-0.28, 0.09, 0.0008, -0.0006, 0.0)
PINCUSHION = (0.25, 0.05, -0.002, 0.003, 0.01)
LAYOUT = (("red_box", "blue_box"), ("green_box",), ("yellow_box", "pink_box"))
CAMERA = CameraConfig(width=320, height=240, vertical_fov=0.7)


def rays(camera: CameraConfig, pixels: NDArray[np.float64]) -> NDArray[np.float64]:
    """OpenCV's directions (x, y, 1) of pixels, shape (n, 2) -> (n, 3)."""
    k, lens, zero = camera.intrinsics, np.array(camera.distortion), np.zeros(3)
    points = cv2.undistortPoints(pixels.reshape(-1, 1, 2), k, lens).reshape(-1, 2)
    for _ in range(60):  # OpenCV's few iterations leave a part of a pixel
        objects = np.column_stack([points, np.ones(len(points))])
        seen = cv2.projectPoints(objects, zero, zero, k, lens)[0].reshape(-1, 2)
        points = points + (pixels - seen) / [k[0, 0], k[1, 1]]
    assert np.abs(seen - pixels).max() < 1e-6
    return np.column_stack([points, np.ones(len(pixels))])


def seen_points(camera: CameraConfig, frame: Frame, mask: NDArray[np.bool_]) -> NDArray[np.float64]:
    """Where the pixels of a mask are in world by their depths, shape (n, 3) [m]."""
    rows, columns = np.nonzero(mask)
    depth = frame.depth[rows, columns].astype(float)
    optical = rays(camera, np.column_stack([columns, rows]).astype(float)) * depth[:, None]
    pose = camera.world_from_optical
    return optical @ pose[:3, :3].T + pose[:3, 3]


@given(
    st.floats(-0.3, 0.3), st.floats(-0.05, 0.1), st.floats(-0.005, 0.005),
    st.floats(-0.005, 0.005), st.integers(0, 999),
)  # fmt: skip
def test_directions_are_shown_where_opencv_projects_them(
    k1: float, k2: float, p1: float, p2: float, seed: int
) -> None:
    coefficients = (k1, k2, p1, p2, 0.01)
    points = np.random.default_rng(seed).uniform(-0.5, 0.5, (20, 2))
    seen, change = distorted(points, coefficients)
    zero, identity = np.zeros(3), np.eye(3)
    objects = np.column_stack([points, np.ones(20)])
    expected = cv2.projectPoints(objects, zero, zero, identity, np.array(coefficients))[0]
    assert seen == pytest.approx(expected.reshape(-1, 2), abs=1e-12)
    for axis in range(2):
        step = np.eye(2)[axis] * 1e-6
        ahead, behind = (distorted(points + sign * step, coefficients)[0] for sign in (1, -1))
        assert change[:, :, axis] == pytest.approx((ahead - behind) / 2e-6, abs=1e-6)
    back, _ = undistorted(seen, coefficients)
    assert back == pytest.approx(points, abs=1e-8)


def test_a_lens_that_folds_the_picture_is_refused() -> None:
    """For k1 = -1/3, r' = r - r³/3 has its maximum, 2/3, at r = 1: nothing is seen beyond."""
    undistorted(np.array([[0.55, 0.0]]), (-1 / 3, 0.0, 0.0, 0.0, 0.0))
    with pytest.raises(FoldedPictureError):
        undistorted(np.array([[0.7, 0.0]]), (-1 / 3, 0.0, 0.0, 0.0, 0.0))


@pytest.mark.parametrize("distortion", [BARREL, PINCUSHION])
def test_every_pixel_of_a_block_lies_on_its_surface_by_opencv_s_rays(
    distortion: tuple[float, ...],
) -> None:
    camera = replace(CAMERA, distortion=distortion)
    with World(SceneConfig(cameras=(camera,))) as world:
        world.reset(LAYOUT, 3)
        frame = world.render()
        for name in world.names:
            mask = frame.labels == world.label(name)
            assert mask.sum() > 100
            position, quaternion = world.block_pose(name)
            rotation = rotation_from_quaternion(quaternion)

            def off(mask: NDArray[np.bool_]) -> NDArray[np.float64]:
                """How far pixels are from the block's surface [m]."""
                points = (seen_points(camera, frame, mask) - position) @ rotation  # noqa: B023
                return np.abs((0.0225 - np.abs(points)).min(axis=1))

            # At edges the nearest pixel's depth stands: up to half a pixel beside the ray.
            assert off(mask).max() < 4e-3
            assert (off(mask) < 1e-5).mean() > 0.3
        table = (frame.labels == 0) & (frame.depth > 0)
        heights = seen_points(camera, frame, binary_erosion(table, iterations=3))[:, 2]
        assert np.median(np.abs(heights)) < 1e-5


@pytest.mark.parametrize("distortion", [BARREL, PINCUSHION])
def test_labels_and_colours_are_where_opencv_projects_the_blocks(
    distortion: tuple[float, ...],
) -> None:
    """A picture of the pinhole, looked up at OpenCV's undistorted pixels, is the lens's picture."""
    camera = replace(CAMERA, distortion=distortion)
    fine = CameraConfig(width=1280, height=720, vertical_fov=1.0)
    with World(SceneConfig(cameras=(camera, replace(fine, name="fine")))) as world:
        world.reset(LAYOUT, 3)
        frame, plain = world.render(), world.render(1)
    columns, rows = np.meshgrid(np.arange(camera.width), np.arange(camera.height))
    pixels = np.column_stack([columns.ravel(), rows.ravel()]).astype(float)
    places = rays(camera, pixels) @ fine.intrinsics.T
    column, row = np.rint(places[:, :2]).astype(int).T
    inside = (column >= 0) & (column < 1280) & (row >= 0) & (row < 720)
    assert inside.mean() > 0.95
    expected = plain.labels[row[inside], column[inside]]
    seen = frame.labels.ravel()[inside]
    assert (seen > 0).sum() > 1000
    assert (expected == seen).mean() > 0.99
    difference = plain.rgb[row[inside], column[inside]] - frame.rgb.reshape(-1, 3)[inside].astype(
        int
    )
    assert np.median(np.abs(difference)) == 0 and np.abs(difference).mean() < 3.0


def test_without_distortion_a_lens_changes_nothing() -> None:
    straight, bent = CAMERA, replace(CAMERA, name="bent", distortion=(1e-12, 0.0, 0.0, 0.0, 0.0))
    with World(SceneConfig(cameras=(straight, bent))) as world:
        world.reset(LAYOUT, 3)
        one, other = world.render(0), world.render(1)
    np.testing.assert_array_equal(one.labels, other.labels)
    assert np.abs(one.rgb.astype(int) - other.rgb).max() <= 1
    assert np.abs(one.depth - other.depth).max() < 1e-5


def test_two_cameras_see_the_same_points() -> None:
    scene = load_scene("two_cameras")
    with World(scene) as world:
        world.reset(LAYOUT, 3)
        for name in world.names:
            position, _ = world.block_pose(name)
            for number, camera in enumerate(scene.cameras):
                frame = world.render(number)
                points = seen_points(camera, frame, frame.labels == world.label(name))
                assert len(points) > 20
                assert np.linalg.norm(points - position, axis=1).max() < 0.0225 * np.sqrt(3) + 1e-3


def test_light_comes_from_where_the_scene_says() -> None:
    def brightness(direction: str) -> float:
        scene = parse_scene(f"light: {{direction: {direction}, specular: 0.0}}")
        with World(scene) as world:
            world.reset(((), ("red_box",), ()), 3)
            frame = world.render()
            rows = np.nonzero(frame.labels == world.label("red_box"))[0]
            front = frame.labels[rows.max() - 5] == world.label("red_box")
            return float(frame.rgb[rows.max() - 5][front][:, 0].mean())

    lit, shaded = brightness("[1.0, 0.0, 0.0]"), brightness("[-1.0, 0.0, 0.0]")
    assert lit == pytest.approx(0.85 * 255 * (0.55 + 0.45), rel=0.02)
    assert shaded == pytest.approx(0.85 * 255 * 0.55, rel=0.02)
