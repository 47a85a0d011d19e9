# SPDX-License-Identifier: Apache-2.0
"""Each object is looked at as large as any other, so its scale in the picture does not matter."""

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from numpy.typing import NDArray

from perception_node.segment import Segments
from perception_node.visual_module.coordinates import Coordinates
from perception_node.visual_module.mask_centroid import MaskCentroid
from perception_node.visual_module.object_images import BLOCK_SIDE, object_images, object_views
from perception_node.visual_module.weights import load_weights

MODULE = load_weights()
COLORS = ((200, 30, 30), (40, 60, 200), (30, 140, 40))

corners = st.tuples(st.integers(20, 200), st.integers(20, 200))


def scene_of(
    objects: list[tuple[int, int]], side: int = 22, scale: int = 1
) -> tuple[NDArray[np.uint8], Segments]:
    """Squares with these bottom-left corners in a picture of 256 px, ``scale`` times as large."""
    rgb, labels = np.full((256, 256, 3), 180, np.uint8), np.zeros((256, 256), np.uint16)
    for number, (right, up) in enumerate(objects):
        place = np.s_[256 - up - side : 256 - up, right : right + side]
        rgb[place], labels[place] = COLORS[number % len(COLORS)], number + 1
    larger = np.ones((scale, scale), np.uint8)
    return np.kron(rgb, larger[..., None]), Segments.from_labels(np.kron(labels, larger))


def locate(objects: list[tuple[int, int]], side: int = 22, scale: int = 1) -> Coordinates:
    rgb, segments = scene_of(objects, side, scale)
    return MODULE.locate(object_views(rgb, segments))


@settings(max_examples=15)
@given(st.lists(corners, min_size=1, max_size=3, unique=True), st.integers(2, 3))
def test_the_same_scene_at_a_larger_size_has_the_same_coordinates(
    objects: list[tuple[int, int]], scale: int
) -> None:
    one, other = locate(objects), locate(objects, scale=scale)
    assert len(one.iou) == len(other.iou)
    assert other.corners == pytest.approx(one.corners, abs=2.0 / 256)
    assert other.centres == pytest.approx(one.centres, abs=2.0 / 256)
    assert other.iou == pytest.approx(one.iou, abs=0.12)


@settings(max_examples=15)
@given(corners, st.integers(8, 60))
def test_objects_of_any_size_are_found_and_reproduced(corner: tuple[int, int], side: int) -> None:
    side = min(side, 256 - max(corner))
    located = locate([corner], side)
    assert located.corners[0] * 256 == pytest.approx(corner, abs=1.0 + 0.1 * side)
    assert located.iou[0] > 0.75


@settings(max_examples=25)
@given(corners, st.integers(8, 50))
def test_views_show_the_object_alone_with_its_longer_side_as_long_as_any(
    corner: tuple[int, int], side: int
) -> None:
    rgb, segments = scene_of([corner], side)
    views = object_views(rgb, segments)
    height, width = (np.ptp(np.flatnonzero(views.coverage[0].any(axis))) + 1 for axis in (1, 0))
    # Plus a pixel that is covered in part.
    assert abs(max(height, width) - BLOCK_SIDE) <= 2
    assert (views.images[0][:, views.coverage[0] == 0.0] == 0.0).all()
    # Its pixels' mean is where it is in the scene.
    rows, columns = np.indices(views.coverage[0].shape)
    share = views.coverage[0] / views.coverage[0].sum()
    size = len(rows)
    middle = np.array([(share * (columns + 0.5)).sum(), (share * (size - rows - 0.5)).sum()]) / size
    shown = [min(side, 256 - edge) for edge in corner]
    true = np.add(corner, 0.5 * np.array(shown))
    assert views.in_scene(middle[None])[0] * 256 == pytest.approx(true, abs=0.75)


def test_images_of_the_whole_scene_are_their_own_coordinates() -> None:
    rgb, segments = scene_of([(40, 60), (150, 100)])
    images = object_images(rgb, segments)
    points = np.array([[0.2, 0.3], [0.6, 0.7]])
    assert np.array_equal(images.in_scene(points), points)


def test_views_and_images_tell_the_baseline_the_same() -> None:
    rgb, segments = scene_of([(40, 60), (150, 100)])
    views = MaskCentroid().locate(object_views(rgb, segments))
    images = MaskCentroid().locate(object_images(rgb, segments))
    assert views.centres == pytest.approx(images.centres, abs=1.5 / 256)


def test_no_objects_have_no_views() -> None:
    assert len(object_views(*scene_of([]))) == 0
