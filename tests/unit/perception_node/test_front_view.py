# SPDX-License-Identifier: Apache-2.0
"""The front view: one scale for all cameras, and pixels that belong to those of the picture."""

from __future__ import annotations

import math

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from perception_scenes import PLACES, looking_camera

from perception_node.camera import PinholeCamera
from perception_node.errors import BadImageError
from perception_node.segment import Volume
from perception_node.segment.front_view import PITCH, FrontView

FEET = np.array(PLACES)
VOLUME = Volume.over(FEET, 0.36)


def camera_at(azimuth: float, elevation: float, distance: float, size: int) -> PinholeCamera:
    target = np.array([0.5, 0.0, 0.1])
    toward = [math.cos(azimuth), math.sin(azimuth), math.tan(elevation)]
    position = target + distance * np.array(toward)
    forward = (target - position) / np.linalg.norm(target - position)
    right = np.cross(forward, [0.0, 0.0, 1.0])
    right /= np.linalg.norm(right)
    pose = np.eye(4)
    pose[:3, :3] = np.column_stack([right, np.cross(forward, right), forward])
    pose[:3, 3] = position
    k = np.array([[size, 0.0, 0.5 * size], [0.0, size, 0.5 * size], [0.0, 0.0, 1.0]])
    return PinholeCamera(k, pose, size, size)


def in_view(view: FrontView, camera: PinholeCamera, points: np.ndarray) -> np.ndarray:
    pixels = np.column_stack([camera.project(points), np.ones(len(points))])
    seen = pixels @ np.linalg.inv(view.picture_from_view).T
    return seen[:, :2] / seen[:, 2:]


@settings(max_examples=40, deadline=None)
@given(
    azimuth=st.floats(-0.5, 0.5),
    elevation=st.floats(0.1, 0.7),
    distance=st.floats(0.5, 2.0),
    size=st.sampled_from([128, 256, 720]),
)
def test_an_upright_edge_over_the_row_has_one_length_from_everywhere(
    azimuth: float, elevation: float, distance: float, size: int
) -> None:
    camera = camera_at(azimuth, elevation, distance, size)
    view = FrontView.of(camera, VOLUME)
    foot, top = in_view(view, camera, np.array([[0.5, 0.0, 0.0], [0.5, 0.0, 0.06]]))
    assert foot[0] == pytest.approx(top[0], abs=1e-6)
    assert foot[1] - top[1] == pytest.approx(0.06 / PITCH)
    column = round(foot[0])
    assert view.feet[column] == pytest.approx(foot[1], abs=1.0)
    assert view.aside[column] == pytest.approx(0.0, abs=1.0)
    assert view.steepness == pytest.approx(camera.position_world[2] / distance)


def test_pictures_go_there_and_back() -> None:
    camera = looking_camera()
    view = FrontView.of(camera, VOLUME)
    rows, columns = np.mgrid[0:256, 0:256].astype(np.float32)
    height, width = view.shape
    inside = np.s_[20 : height - 20, 60 : width - 60]
    there = view.in_picture(
        np.stack(np.meshgrid(np.arange(width), np.arange(height)), -1).reshape(-1, 2).astype(float)
    ).reshape(height, width, 2)
    # A ramp shows where each pixel comes from.
    assert np.allclose(view.taken(columns)[inside], there[inside][..., 0], atol=0.05)
    assert np.allclose(view.taken(rows)[inside], there[inside][..., 1], atol=0.05)
    box = (slice(90, 130), slice(100, 150))
    part, values = view.shown_part(np.ones((40, 50), np.float32), box, (256, 256))
    assert values.shape == (part[0].stop - part[0].start, part[1].stop - part[1].start)
    ends = view.in_picture(np.array([[100.0, 90.0], [149.0, 129.0]]))
    shown_rows, shown_columns = np.nonzero(values > 0.9)
    assert shown_columns.min() + part[1].start == pytest.approx(ends[0, 0], abs=1.5)
    assert shown_columns.max() + part[1].start == pytest.approx(ends[1, 0], abs=1.5)
    assert shown_rows.min() + part[0].start == pytest.approx(ends[0, 1], abs=1.5)
    assert shown_rows.max() + part[0].start == pytest.approx(ends[1, 1], abs=1.5)


def test_a_view_from_above_and_a_row_of_metres_are_refused() -> None:
    with pytest.raises(BadImageError, match="needs a view from the side"):
        FrontView.of(camera_at(0.0, 1.4, 0.3, 256), VOLUME)
    far = Volume.over(np.array([[0.5, -2.0, 0.0], [0.5, 2.0, 0.0]]), 0.36)
    with pytest.raises(BadImageError, match="check the parameter stack_positions"):
        FrontView.of(camera_at(0.0, 0.3, 6.0, 256), far)
