# SPDX-License-Identifier: Apache-2.0
"""The visual module finds objects wherever they are, also where it was never trained."""

import numpy as np
import pytest
import torch
from hypothesis import given, settings
from hypothesis import strategies as st
from numpy.typing import NDArray

from perception_node.segment import Segments
from perception_node.visual_module.coordinates import (
    Coordinates,
    intersection_over_union,
    translated_overlap,
)
from perception_node.visual_module.grid_sampler import sample
from perception_node.visual_module.mask_centroid import MaskCentroid
from perception_node.visual_module.near_content import NearContent
from perception_node.visual_module.object_images import ObjectImages, object_images
from perception_node.visual_module.weights import load_weights

MODULE = load_weights()
COLORS = ((200, 30, 30), (40, 60, 200), (30, 140, 40), (220, 200, 30))


def scene_of(
    corners: list[tuple[int, int]], size: int = 24
) -> tuple[NDArray[np.uint8], NDArray[np.uint16]]:
    """Squares with the given bottom-left corners, (columns from the left, rows from below) [px]."""
    rgb, labels = np.full((256, 256, 3), 180, np.uint8), np.zeros((256, 256), np.uint16)
    for number, (right, up) in enumerate(corners):
        place = np.s_[256 - up - size : 256 - up, right : right + size]
        rgb[place], labels[place] = COLORS[number % len(COLORS)], number + 1
    return rgb, labels


def images_of(rgb: NDArray[np.uint8], labels: NDArray[np.uint16]) -> ObjectImages:
    return object_images(rgb, Segments.from_labels(labels))


def locate_in(rgb: NDArray[np.uint8], labels: NDArray[np.uint16]) -> Coordinates:
    return MODULE.locate(MODULE.images(rgb, Segments.from_labels(labels)))


def locate(corners: list[tuple[int, int]]) -> Coordinates:
    return locate_in(*scene_of(corners))


#: Nearer than 10 px to the picture's edge the network feels the zeros beyond it.
inside = st.tuples(st.integers(12, 220), st.integers(12, 220))
anywhere = st.tuples(st.integers(4, 228), st.integers(4, 228))


@settings(max_examples=20)
@given(anywhere)
def test_a_corner_at_the_edge_of_the_picture_is_found_to_three_pixels(
    corner: tuple[int, int],
) -> None:
    assert locate([corner]).corners[0] * 256 == pytest.approx(corner, abs=3.0)


@settings(max_examples=20)
@given(st.lists(inside, min_size=1, max_size=4, unique=True))
def test_corners_are_found_to_two_pixels(corners: list[tuple[int, int]]) -> None:
    rgb, labels = scene_of(corners)
    found = np.unique(labels[labels > 0])
    visible = [
        i for i, corner in enumerate(corners) if np.count_nonzero(labels == i + 1) == 24 * 24
    ]
    located = locate_in(rgb, labels)
    for index in visible:
        row = int(np.flatnonzero(found == index + 1)[0])
        assert located.corners[row] * 256 == pytest.approx(corners[index], abs=2.0)
        assert located.iou[row] > 0.75


@settings(max_examples=15)
@given(inside, inside)
def test_moving_an_object_moves_its_coordinates_by_as_much(
    start: tuple[int, int], end: tuple[int, int]
) -> None:
    moved = locate([end]).corners[0] - locate([start]).corners[0]
    assert moved * 256 == pytest.approx(np.subtract(end, start), abs=3.0)


def test_an_object_does_not_change_what_is_said_of_another() -> None:
    alone = locate([(40, 60)]).corners[0]
    together = locate([(40, 60), (150, 60), (150, 84)]).corners[0]
    assert together == pytest.approx(alone, abs=1e-4)


def test_no_objects_have_no_coordinates() -> None:
    assert locate([]).phi.shape == (0, 2)


def test_specks_far_away_draw_the_centroid_but_not_the_learnt_coordinates() -> None:
    corner = np.array([40, 40])
    rgb, labels = scene_of([(40, 40)])
    specks = np.random.default_rng(0).random(labels.shape) < 0.01
    labels[specks] = 1
    learnt = locate_in(rgb, labels).centres[0] * 256 - (corner + 12)
    centroid = MaskCentroid().locate(images_of(rgb, labels)).centres[0] * 256 - (corner + 12)
    assert np.abs(learnt).max() < 4.0
    assert np.abs(centroid).max() > 20.0


def test_images_of_other_sizes_are_scaled_into_the_bottom_left_corner() -> None:
    rgb, labels = np.zeros((120, 160, 3), np.uint8), np.zeros((120, 160), np.uint16)
    labels[100:120, 0:20], rgb[100:120, 0:20] = 1, 200  # touches the corner
    objects = images_of(rgb, labels)
    assert objects.coverage[0, -16:, :16] == pytest.approx(1.0)
    assert objects.coverage[0].sum() == pytest.approx(256.0)
    assert objects.coverage == pytest.approx(objects.default_coverage)


@given(st.integers(0, 10**6))
def test_the_iou_of_masks_is_the_usual_one(seed: int) -> None:
    rng = np.random.default_rng(seed)
    first, second = rng.random((2, 3, 8, 8)) < 0.5
    union = (first | second).sum((1, 2))
    expected = (first & second).sum((1, 2)) / np.maximum(union, 1)
    found = intersection_over_union(first.astype(float), second.astype(float))
    assert found == pytest.approx(expected)


contents = st.tuples(
    st.integers(0, 120), st.integers(0, 120), st.integers(1, 60), st.integers(1, 60)
)


@settings(max_examples=30)
@given(st.lists(contents, min_size=1, max_size=3), st.integers(0, 1000))
def test_only_what_is_near_content_needs_to_be_computed(
    boxes: list[tuple[int, int, int, int]], seed: int
) -> None:
    regressor = MODULE.regressor
    assert isinstance(regressor, NearContent)
    images = np.zeros((len(boxes), 3, 128, 128), np.float32)
    for image, (row, column, height, width) in zip(images, boxes):
        part = image[:, row : row + height, column : column + width]
        part[:] = np.random.default_rng(seed).random(part.shape)
    with torch.inference_mode():
        near, whole = (each(torch.from_numpy(images)) for each in (regressor, regressor.regressor))
    assert near.numpy() == pytest.approx(whole.numpy(), abs=1e-5)


@settings(max_examples=30)
@given(contents, st.floats(-0.2, 1.2), st.floats(-0.2, 1.2), st.integers(0, 1000))
def test_the_overlap_with_a_moved_crop_is_that_with_what_the_sampler_makes_of_it(
    box: tuple[int, int, int, int], right: float, up: float, seed: int
) -> None:
    row, column, height, width = box
    rng = np.random.default_rng(seed)
    coverage, default = np.zeros((2, 1, 128, 128), np.float32)
    part = coverage[0, row : row + height, column : column + width]
    part[:] = rng.random(part.shape)
    default[0, 128 - height :, :width] = rng.random((height, width))
    phi = np.array([[right, up]], np.float32)
    moved = sample(torch.from_numpy(default[:, None]), torch.from_numpy(phi), 2.0)[:, 0].numpy()
    sizes = np.array([[width, height]])
    found = translated_overlap(coverage, default, sizes, 128.0 * phi.astype(np.float64))
    assert found == pytest.approx(intersection_over_union(coverage, moved), abs=1e-4)
