# SPDX-License-Identifier: Apache-2.0
"""What is known of a camera becomes the camera that took the pictures."""

from __future__ import annotations

from typing import Any

import cv2
import numpy as np
import pytest
from scipy.spatial.transform import Rotation

from perception_node.calibration import Calibration, FramePose, LensModel, View
from perception_node.errors import BadImageError

LENSES = {
    "plumb_bob": (-0.31, 0.12, 0.002, -0.001, -0.02),
    "rational_polynomial": (0.5, -2.0, 0.001, 0.0, 1.2, 0.4, -1.9, 1.1),
    "equidistant": (0.05, -0.02, 0.01, -0.003),
}
K = np.array([[310.0, 0.0, 161.0], [0.0, 305.0, 118.0], [0.0, 0.0, 1.0]])
P = np.array([[250.0, 0.0, 158.0, 0.0], [0.0, 252.0, 121.0, 0.0], [0.0, 0.0, 1.0, 0.0]])
TURN = Rotation.from_euler("xyz", [0.2, -0.1, 0.3])


def lens(**changes: Any) -> LensModel:
    return LensModel(**{"frame": "optical", "width": 320, "height": 240, "k": flat(K), **changes})


def flat(matrix: np.ndarray) -> tuple[float, ...]:
    return tuple(matrix.ravel().tolist())


def pose(
    parent: str, child: str, shift: tuple[float, float, float], turn: Rotation = TURN
) -> FramePose:
    return FramePose(parent, child, shift, tuple(turn.as_quat().tolist()))


def calibrated(rectified: bool = False) -> Calibration:
    calibration = Calibration(rectified)
    calibration.place(pose("base", "optical", (0.4, -0.2, 0.9)))
    return calibration


def seen_at(view: View) -> tuple[np.ndarray, np.ndarray]:
    """Pixels of the new picture, and where each comes from in the old one."""
    rows, columns = np.mgrid[40:200:20, 60:260:20]
    pixels = np.column_stack([columns.ravel(), rows.ravel()]).astype(np.float64)
    positions = np.moveaxis(np.mgrid[0:240, 0:320][::-1], 0, -1).astype(np.float32)
    assert view.rectification is not None
    where = view.rectification.color(positions)
    return pixels, where[rows.ravel(), columns.ravel()]


@pytest.mark.parametrize("model", LENSES)
@pytest.mark.parametrize("projection", [None, P])
def test_a_rectified_pixel_shows_what_the_lens_showed_on_its_ray(
    model: str, projection: np.ndarray | None
) -> None:
    changes = {} if projection is None else {"p": flat(projection)}
    view = calibrated().view(lens(distortion_model=model, d=LENSES[model], **changes), 320, 240)
    pixels, seen = seen_at(view)
    expected = K if projection is None else P[:, :3]
    assert view.camera.intrinsics == pytest.approx(expected)
    # From the world's ray of each pixel back through the lens, as OpenCV projects points.
    points = view.camera.position_world + view.camera.rays_world(pixels)
    from_world = np.linalg.inv(view.camera.world_from_optical)
    rotation, _ = cv2.Rodrigues(from_world[:3, :3])
    distortion = np.array(LENSES[model])
    if model == "equidistant":
        projected, _ = cv2.fisheye.projectPoints(
            points[:, None], rotation, from_world[:3, 3], K, distortion
        )
    else:
        projected, _ = cv2.projectPoints(points, rotation, from_world[:3, 3], K, distortion)
    # OpenCV's maps are in 1/32 of a pixel.
    assert seen == pytest.approx(projected.reshape(-1, 2), abs=0.05)


def test_depths_and_labels_are_not_mixed() -> None:
    view = calibrated().view(
        lens(distortion_model="plumb_bob", d=LENSES["plumb_bob"], p=flat(P)), 320, 240
    )
    rng = np.random.default_rng(3)
    rgb = rng.integers(0, 256, (240, 320, 3)).astype(np.uint8)
    for kind in (np.uint8, np.uint16, np.int32):
        labels = rng.choice([0, 7, 200], (240, 320)).astype(kind)
        depth = rng.choice([np.nan, 0.5, 2.0], (240, 320)).astype(np.float32)
        seen = view.observation(rgb, labels, depth)
        assert seen.labels is not None and seen.labels.dtype == kind
        assert set(np.unique(seen.labels)) == {0, 7, 200}
        assert seen.depth is not None
        assert {0.0, 0.5, 2.0} >= set(np.unique(seen.depth[np.isfinite(seen.depth)]))
        assert seen.camera is view.camera


def test_pictures_that_do_not_fit_are_refused_before_they_are_rectified() -> None:
    view = calibrated().view(lens(d=LENSES["plumb_bob"]), 320, 240)
    rgb = np.zeros((240, 320, 3), np.uint8)
    with pytest.raises(BadImageError, match="depth is 160x120 but the image is 320x240"):
        view.observation(rgb, None, np.ones((120, 160), np.float32))


def test_rectified_pictures_are_left_as_they_are_and_belong_to_p() -> None:
    view = calibrated(rectified=True).view(lens(d=LENSES["plumb_bob"], p=flat(P)), 320, 240)
    assert view.rectification is None
    assert view.camera.intrinsics == pytest.approx(P[:, :3])


def test_raw_pictures_without_distortion_belong_to_k() -> None:
    view = calibrated().view(lens(d=(0.0,) * 5, p=flat(P)), 320, 240)
    assert view.rectification is None
    assert view.camera.intrinsics == pytest.approx(K)


def test_the_second_camera_of_a_stereo_pair_is_beside_its_frame() -> None:
    beside = P.copy()
    beside[0, 3] = -250.0 * 0.12
    left = calibrated(rectified=True).view(lens(p=flat(P)), 320, 240).camera
    right = calibrated(rectified=True).view(lens(p=flat(beside)), 320, 240).camera
    point = np.array([0.4, -0.2, 0.9]) + TURN.apply([0.1, 0.05, 1.5])
    # The whole projection of REP 104: P (x, y, z, 1).
    u, v, w = beside @ [0.1, 0.05, 1.5, 1.0]
    assert right.project(point) == pytest.approx([u / w, v / w])
    assert left.project(point)[0] - right.project(point)[0] == pytest.approx(250.0 * 0.12 / 1.5)


def test_a_part_of_the_sensor_and_a_smaller_picture_of_it() -> None:
    part = (40, 20, 240, 180)
    whole = calibrated().view(lens(), 320, 240).camera
    cut = calibrated().view(lens(region=part), 240, 180).camera
    half = calibrated().view(lens(region=part), 120, 90).camera
    point = np.array([0.4, -0.2, 0.9]) + TURN.apply([0.05, -0.03, 1.0])
    assert cut.project(point) == pytest.approx(whole.project(point) - [40, 20])
    assert 2.0 * (half.project(point) + 0.5) == pytest.approx(cut.project(point) + 0.5)


def test_frames_lead_to_the_camera_where_there_are_no_extrinsics() -> None:
    calibration = Calibration()
    stand, mount = (0.1, 0.2, 0.3), (0.0, 0.1, 0.0)
    with pytest.raises(BadImageError, match="camera/extrinsics has not arrived"):
        calibration.view(lens(), 320, 240)
    calibration.add_frames([pose("mount", "optical", mount)])
    with pytest.raises(
        BadImageError, match="leads from 'optical' to 'mount' and not on to 'world'"
    ):
        calibration.view(lens(), 320, 240)
    calibration.add_frames([pose("world", "mount", stand), pose("world", "x", stand)])
    found = calibration.view(lens(), 320, 240).camera.world_from_optical
    assert found[:3, 3] == pytest.approx(np.array(stand) + TURN.apply(mount))
    assert found[:3, :3] == pytest.approx((TURN * TURN).as_matrix())
    assert calibration.pose_frame == "world"
    calibration.place(pose("base", "optical", (1.0, 2.0, 3.0)))
    camera = calibration.view(lens(), 320, 240).camera
    assert camera.position_world == pytest.approx([1.0, 2.0, 3.0])
    assert calibration.pose_frame == "base"


def test_frames_in_a_circle_are_told() -> None:
    calibration = Calibration()
    calibration.add_frames([pose("a", "optical", (0.0,) * 3), pose("optical", "a", (0.0,) * 3)])
    with pytest.raises(BadImageError, match="not on to 'world'"):
        calibration.view(lens(), 320, 240)


def test_a_moved_camera_is_seen_where_it_is_now() -> None:
    calibration = calibrated()
    before = calibration.view(lens(), 320, 240)
    assert calibration.view(lens(), 320, 240) is before
    calibration.place(pose("base", "optical", (0.4, -0.2, 0.9)))
    assert calibration.view(lens(), 320, 240) is before
    calibration.place(pose("base", "optical", (0.0, 0.0, 1.0)))
    assert calibration.view(lens(), 320, 240).camera.position_world == pytest.approx([0, 0, 1])
    assert calibration.view(lens(width=640, height=480), 320, 240).camera.intrinsics[
        0, 0
    ] == pytest.approx(155.0)


@pytest.mark.parametrize(
    ("changes", "reason"),
    [
        ({"distortion_model": "spline", "d": (0.1,)}, "'spline' .* is none of plumb_bob"),
        ({"distortion_model": "plumb_bob", "d": (0.1,) * 3}, "has 3 coefficients .* 4 or 5"),
        ({"d": (np.nan, 0.1, 0.0, 0.0, 0.0)}, "calibrate"),
        ({"k": (0.0,) * 9}, "no usable intrinsics"),
        ({"width": 0}, "no width and height"),
        ({"frame": "other"}, "'optical', but the pictures are in 'other'"),
        ({"width": 500}, "ratio of sides"),
    ],
)
def test_a_camera_that_cannot_be_is_refused(changes: dict[str, Any], reason: str) -> None:
    with pytest.raises(BadImageError, match=reason):
        calibrated().view(lens(**changes), 320, 240)


def test_a_pose_that_cannot_be_is_refused() -> None:
    calibration = Calibration()
    calibration.place(FramePose("base", "optical", (0.0,) * 3, (0.0, 0.0, 0.0, 0.5)))
    with pytest.raises(BadImageError, match="unit quaternion"):
        calibration.view(lens(), 320, 240)


def test_labels_are_those_of_the_nearest_pixel() -> None:
    view = calibrated().view(lens(d=LENSES["plumb_bob"], p=flat(P)), 320, 240)
    numbers = np.arange(240 * 320, dtype=np.int32).reshape(240, 320)
    pixels, seen = seen_at(view)
    assert view.rectification is not None
    found = view.rectification.labels(numbers)[tuple(pixels[:, ::-1].astype(int).T)]
    off = np.stack([found % 320, found // 320], axis=-1) - seen
    assert np.abs(off).max() < 0.5 + 1 / 32
