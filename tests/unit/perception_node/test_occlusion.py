# SPDX-License-Identifier: Apache-2.0
"""What is hidden is found in the depth; ray-cast solids are the oracle."""

from dataclasses import replace

import cv2
import numpy as np
import pytest
from perception_scenes import Solid, cast, looking_camera, tower

from perception_node.config import PerceptionConfig
from perception_node.observation import Observation
from perception_node.places import RowOfPlaces
from perception_node.places.occlusion import Occlusion, find_occlusion
from perception_node.segment import Segments
from scene_graph import BOX, BlockPose

CAMERA = looking_camera()


def seen(solids: list[Solid], blocks: int) -> tuple[Observation, Occlusion]:
    """Of a scene in which all but the first solids are no blocks."""
    depth, labels = cast(solids, CAMERA)
    labels[labels > blocks] = 0
    observation = Observation(np.zeros((256, 256, 3), np.uint8), labels, depth, CAMERA)
    return observation, occlusion_of(observation)


def occlusion_of(observation: Observation, places: RowOfPlaces | None = None) -> Occlusion:
    assert observation.labels is not None
    segments = Segments.from_labels(observation.labels)
    return find_occlusion(observation, segments, places or RowOfPlaces(), PerceptionConfig())


def test_blocks_hide_nothing() -> None:
    _, occlusion = seen([*tower(0, [BOX] * 3), *tower(2, [BOX])], 4)
    assert occlusion.shares == (0.0, 0.0, 0.0) and occlusion.greatest == 0.0


@pytest.mark.parametrize("place", [0, 1, 2])
def test_something_in_front_of_a_place_hides_it(place: int) -> None:
    thing = Solid(BOX, (0.6, (-0.15, 0.0, 0.15)[place], 0.1), half=0.02)
    _, occlusion = seen([*tower(1, [BOX]), thing], 1)
    assert int(np.argmax(occlusion.shares)) == place
    assert occlusion.greatest == occlusion.shares[place] > 0.05


def test_something_behind_the_places_hides_nothing() -> None:
    _, occlusion = seen([*tower(1, [BOX]), Solid(BOX, (0.3, 0.0, 0.1), half=0.05)], 1)
    assert occlusion.greatest == 0.0


def test_a_blocks_own_rim_that_its_mask_misses_hides_nothing() -> None:
    blocks = tower(0, [BOX] * 3, 0.3) + tower(2, [BOX])
    observation, _ = seen(blocks, len(blocks))
    assert observation.labels is not None
    inner = cv2.erode(observation.labels, np.ones((5, 5), np.uint8))
    labels = np.where(inner == observation.labels, inner, 0)
    missed, segments = replace(observation, labels=labels), Segments.from_labels(labels)
    poses = [BlockPose(solid.centre, solid.yaw, (0.045,) * 3) for solid in blocks]
    unmeasured = find_occlusion(missed, segments, RowOfPlaces(), PerceptionConfig())
    measured = find_occlusion(missed, segments, RowOfPlaces(), PerceptionConfig(), poses)
    assert unmeasured.greatest > 0.02
    assert measured.greatest == 0.0


def test_a_thing_in_front_of_a_measured_block_hides_it_all_the_same() -> None:
    blocks = tower(1, [BOX] * 2)
    observation, occlusion = seen([*blocks, Solid(BOX, (0.56, 0.0, 0.05), half=0.015)], 2)
    assert observation.labels is not None
    segments = Segments.from_labels(observation.labels)
    poses = [BlockPose(solid.centre, 0.0, (0.045,) * 3) for solid in blocks]
    measured = find_occlusion(observation, segments, RowOfPlaces(), PerceptionConfig(), poses)
    assert measured.greatest == occlusion.greatest > 0.03


def test_a_block_behind_something_is_visible_in_part() -> None:
    blocks = tower(0, [BOX]) + tower(2, [BOX])
    thing = Solid(BOX, (0.6, 0.115, 0.06), half=0.02)
    observation, occlusion = seen([*blocks, thing], 2)
    poses = [BlockPose(solid.centre, 0.0, (0.045,) * 3) for solid in blocks]
    left, right = occlusion.visible_shares(poses, CAMERA)
    _, unhidden = cast(blocks, CAMERA)
    assert observation.labels is not None
    expected = np.count_nonzero(observation.labels == 2) / np.count_nonzero(unhidden == 2)
    assert 0.2 < expected < 0.8
    assert left == 1.0 and right == pytest.approx(expected, abs=0.05)
    assert occlusion.visible_shares([None, None], CAMERA).tolist() == [1.0, 1.0]


@pytest.mark.parametrize("height", [0.12, 0.17, 0.25, 0.33])
@pytest.mark.parametrize("place", [0, 1, 2])
def test_what_hangs_over_a_place_hides_nothing_below_what_is_seen_to(
    place: int, height: float
) -> None:
    thing = Solid(BOX, (0.5, (-0.15, 0.0, 0.15)[place], height), half=0.03)
    _, occlusion = seen([thing], 0)
    seen_to = occlusion.seen_to[place]
    assert all(to == 0.36 for index, to in enumerate(occlusion.seen_to) if index != place)
    assert height - 0.03 - 0.09 < seen_to < height - 0.03
    # A tower as high as that loses hardly a row to the thing; one that reaches it loses some.
    for top, is_whole in ((seen_to, True), (height - 0.03, False)):
        x, y, _ = thing.centre
        column = Solid(BOX, (x, y, 0.5 * top), half=(0.035, 0.035, 0.5 * top))
        _, alone = cast([column], CAMERA)
        _, beside = cast([column, thing], CAMERA)
        rows_lost = np.count_nonzero(((alone == 1) & (beside == 2)).any(axis=1))
        assert (rows_lost <= 1) == is_whole


def test_nothing_is_known_without_depth_camera_or_places() -> None:
    observation, _ = seen([Solid(BOX, (0.6, 0.0, 0.1))], 0)
    assert occlusion_of(replace(observation, depth=None)) == Occlusion()
    assert occlusion_of(replace(observation, camera=None)) == Occlusion()
    assert occlusion_of(observation, RowOfPlaces(())) == Occlusion()
