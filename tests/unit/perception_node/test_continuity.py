# SPDX-License-Identifier: Apache-2.0
"""A calibration that moves while the camera does not, and pictures that stay the same."""

from dataclasses import replace

import cv2
import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from numpy.typing import NDArray
from perception_scenes import PLACES, Solid, cast, looking_camera
from scipy.spatial.transform import Rotation

from perception_node import Observation
from perception_node.camera import PinholeCamera
from perception_node.continuity import Continuity
from scene_graph import UP, Place, Relation, SceneGraph, SceneObject, base_name

COLORS = np.array([[90, 80, 70], [200, 30, 30], [30, 160, 40], [40, 60, 200], [150, 150, 150]])
BLOCKS = [Solid("box", (*PLACES[i][:2], 0.0225 + 0.045 * j)) for i, j in ((0, 0), (0, 1), (2, 0))]


def turned(camera: PinholeCamera, degrees: float, aside: float = 0.0) -> PinholeCamera:
    """A camera that is turned about the vertical, and moved."""
    pose = camera.world_from_optical.copy()
    pose[:3, :3] = Rotation.from_euler("z", degrees, degrees=True).as_matrix() @ pose[:3, :3]
    pose[1, 3] += aside
    return replace(camera, world_from_optical=pose)


def picture(camera: PinholeCamera, solids: list[Solid], seed: int = 0) -> Observation:
    """What a camera with some noise takes."""
    depth, labels = cast(solids, camera)
    noise = np.random.default_rng(seed).normal(0.0, 3.0, (*depth.shape, 3))
    rgb = np.clip(COLORS[labels] + noise, 0, 255).astype(np.uint8)
    return Observation(rgb, depth=depth.astype(np.float32), camera=camera)


def seen_at(aside: float) -> SceneGraph:
    """A block this far beside its place [m]."""
    places = tuple(Place(index, position) for index, position in enumerate(PLACES))
    x, y, z = PLACES[1]
    block = SceneObject("red_box", "red", "box", (x, y + aside, z + 0.0225))
    return SceneGraph((block,), frozenset({Relation("red_box", UP, base_name(1))}), places)


NOTHING = SceneGraph((), frozenset())


def after(before: Observation) -> Continuity:
    continuity = Continuity()
    continuity.understand(before, seen_at(0.003), 10)
    return continuity


@settings(max_examples=20, deadline=None)
@given(st.floats(3.0, 20.0), st.sampled_from([-1.0, 1.0]), st.floats(-0.1, 0.1))
def test_a_calibration_that_moves_alone_is_told(size: float, sign: float, aside: float) -> None:
    camera = looking_camera()
    wrong = turned(camera, sign * size, aside)
    now = replace(picture(camera, BLOCKS, seed=1), camera=wrong)
    sentence = after(picture(camera, BLOCKS)).calibration_problem(now, NOTHING, 11)
    assert sentence.startswith("camera/extrinsics says that the camera has moved")


@settings(max_examples=20, deadline=None)
@given(st.floats(-20.0, 20.0), st.floats(-0.1, 0.1))
def test_a_camera_that_moves_with_its_calibration_is_believed(degrees: float, aside: float) -> None:
    camera = looking_camera()
    now = picture(turned(camera, degrees, aside), BLOCKS, seed=1)
    assert after(picture(camera, BLOCKS)).calibration_problem(now, NOTHING, 11) == ""


@pytest.mark.parametrize("degrees, aside", [(-5.5, -0.094), (5.5, 0.094), (-2.0, -0.035)])
def test_a_camera_that_turns_back_to_what_it_moved_away_from_is_believed(
    degrees: float, aside: float
) -> None:
    camera = looking_camera()
    now = picture(turned(camera, degrees, aside), BLOCKS, seed=1)
    assert after(picture(camera, BLOCKS)).calibration_problem(now, NOTHING, 11) == ""


def test_an_arm_that_came_before_the_camera_changes_nothing() -> None:
    camera, hand = looking_camera(), Solid("box", (0.55, 0.05, 0.2), (0.03, 0.05, 0.1))
    continuity = after(picture(camera, BLOCKS))
    now = picture(camera, [*BLOCKS, hand], seed=1)
    assert continuity.calibration_problem(now, NOTHING, 11) == ""
    assert "turned by 8 degrees" in continuity.calibration_problem(
        replace(now, camera=turned(camera, 8.0)), NOTHING, 11
    )
    assert after(picture(camera, BLOCKS)).calibration_problem(
        picture(turned(camera, 8.0), [*BLOCKS, hand], seed=1), NOTHING, 11
    ) == ""  # fmt: skip


def test_a_calibration_that_comes_back_is_believed_again() -> None:
    camera = looking_camera()
    before = picture(camera, BLOCKS)
    continuity = after(before)
    assert continuity.calibration_problem(replace(before, camera=turned(camera, 8.0)), NOTHING, 11)
    assert continuity.calibration_problem(picture(camera, BLOCKS[:1]), NOTHING, 12) == ""


@pytest.mark.parametrize("before, by_it", [(0.025, 0.002), (0.03, 0.02)])
def test_a_calibration_that_puts_right_what_was_wrong_is_believed(
    before: float, by_it: float
) -> None:
    camera = looking_camera()
    wrong = replace(picture(camera, BLOCKS), camera=turned(camera, 8.0))
    continuity = Continuity()
    continuity.understand(wrong, seen_at(before), 10)
    now = picture(camera, BLOCKS, seed=1)
    assert continuity.calibration_problem(now, seen_at(by_it), 11) == ""
    assert continuity.calibration_problem(now, seen_at(before - 0.005), 11)
    assert continuity.calibration_problem(now, NOTHING, 11)


def test_a_calibration_that_is_measured_again_is_believed() -> None:
    before = picture(looking_camera(), BLOCKS)
    now = replace(before, camera=turned(looking_camera(), 0.5, 0.005))
    assert after(before).calibration_problem(now, NOTHING, 11) == ""


def test_a_calibration_that_moves_as_the_scene_changes_is_not_believed() -> None:
    camera = looking_camera()
    others = [Solid("box", (*PLACES[i][:2], 0.0225 + 0.045 * j)) for i, j in ((1, 0), (2, 0))]
    now = replace(picture(camera, others, seed=1), camera=turned(camera, 8.0))
    assert after(picture(camera, BLOCKS)).calibration_problem(now, NOTHING, 11)


def test_after_the_clock_went_back_it_is_another_camera() -> None:
    camera = looking_camera()
    now = replace(picture(camera, BLOCKS, seed=1), camera=turned(camera, 8.0))
    continuity = after(picture(camera, BLOCKS))
    assert continuity.calibration_problem(now, NOTHING, 9) == ""
    assert continuity.calibration_problem(now, NOTHING, 11) == ""


@pytest.mark.parametrize("unknown", ["picture", "camera", "depth", "size", "all"])
def test_what_cannot_be_compared_is_believed(unknown: str) -> None:
    camera = looking_camera()
    before = picture(camera, BLOCKS)
    now = replace(before, camera=turned(camera, 8.0))
    if unknown == "camera":
        now = replace(now, camera=None)
    elif unknown == "depth":
        before = replace(before, depth=None)
    elif unknown == "size":
        now = replace(picture(looking_camera(128), BLOCKS), camera=turned(looking_camera(128), 8.0))
    elif unknown == "all":
        now = replace(now, camera=turned(camera, 90.0))
    continuity = Continuity() if unknown == "picture" else after(before)
    assert continuity.calibration_problem(now, NOTHING, 11) == ""


def test_how_long_a_picture_has_been_the_same() -> None:
    one, other = (np.full((4, 4, 3), value, np.uint8) for value in (1, 2))
    far = np.ones((4, 4), np.float32)
    continuity = Continuity()
    seconds = [
        continuity.seconds_unchanged(round(1e9 * time), *pictures)
        for time, pictures in [
            (10.0, (one, far)),
            (10.5, (one.copy(), far)),
            (12.0, (one, far)),
            (12.5, (one, far + 1)),
            (13.0, (other, far + 1)),
            (15.0, (other, far + 1)),
            (3.0, (other, far + 1)),  # a clock that starts anew
            (3.5, (other, None)),
        ]
    ]
    assert seconds == [0.0, 0.5, 2.0, 0.0, 0.0, 2.0, 0.0, 0.0]


@pytest.mark.parametrize("noise", [0.0, 0.003])
def test_colours_that_stay_while_depth_moves_are_frozen(noise: float) -> None:
    camera, rng = looking_camera(), np.random.default_rng(0)
    rgb = picture(camera, BLOCKS).rgb

    def depth(solids: list[Solid]) -> NDArray[np.float64]:
        exact, _ = cast(solids, camera)
        return exact + rng.normal(0.0, noise, exact.shape)

    continuity = Continuity()
    assert continuity.frozen_colors(0, rgb, depth(BLOCKS)) == 0.0
    assert continuity.frozen_colors(10**8, rgb, depth(BLOCKS)) == 0.0
    assert continuity.frozen_colors(2 * 10**8, rgb, None) == 0.0
    assert continuity.frozen_colors(3 * 10**8, rgb, depth(BLOCKS[:-1])) == pytest.approx(0.3)
    assert continuity.frozen_colors(35 * 10**7, rgb, depth(BLOCKS)) == pytest.approx(0.35)
    other = picture(camera, BLOCKS[:-1]).rgb
    assert continuity.frozen_colors(4 * 10**8, other, depth(BLOCKS[:-1])) == 0.0
    assert continuity.frozen_colors(5 * 10**8, other, depth(BLOCKS)) == pytest.approx(0.1)


def test_edges_of_depth_that_flicker_do_not_freeze_colours() -> None:
    camera, rng = looking_camera(), np.random.default_rng(1)
    seen = picture(camera, BLOCKS)
    assert seen.depth is not None
    rim = cv2.morphologyEx(seen.depth, cv2.MORPH_GRADIENT, np.ones((3, 3))) > 0.02
    continuity = Continuity()
    for frame in range(5):
        taken = np.where(rim & (rng.random(rim.shape) < 0.5), seen.depth + 0.3, seen.depth)
        taken[rng.random(rim.shape) < 0.1] = np.nan
        assert continuity.frozen_colors(frame * 10**8, seen.rgb, taken) == 0.0
