# SPDX-License-Identifier: Apache-2.0
"""Pictures that cannot be used are refused with what is wrong with them."""

import re
from collections.abc import Callable
from dataclasses import replace

import numpy as np
import pytest
from seen_worlds import PERCEPTION, TOWERS, camera_of, perceive

from perception_node import (
    Observation,
    PerceptionConfig,
)
from scene_graph import GraphStatus
from sim_node.camera import Frame
from sim_node.world import World


class TestFault13PicturesThatTellNothing:
    """Each is answered by what is wrong with it, not by what blocks seem to do in it."""

    @pytest.mark.parametrize(
        ("change", "sentence"),
        [
            (lambda frame: replace(frame, rgb=0 * frame.rgb), "the picture is black; is the lens"),
            (lambda frame: replace(frame, rgb=frame.rgb // 10), "the picture is too dark to tell"),
            (lambda frame: replace(frame, rgb=0 * frame.rgb + 255), "the picture is white"),
            (
                lambda frame: replace(frame, depth=1000 * frame.depth),
                "the depth is 1... in the middle, which cannot be metres; .* millimetres",
            ),
        ],
        ids=["black", "dark", "white", "millimetres"],
    )
    def test_it_is_refused_with_the_cause(
        self, world: World, change: Callable[[Frame], Frame], sentence: str
    ) -> None:
        world.reset(TOWERS)
        perceived = perceive(world, change(world.render()))
        assert perceived.status is GraphStatus.BAD_IMAGE
        assert re.match(sentence, perceived.message), perceived.message
        assert perceived.graph.objects == ()

    def test_with_a_third_of_the_light_colours_are_still_told(self, world: World) -> None:
        world.reset((("red_box", "blue_box"), ("green_box",), ()))
        frame = world.render()
        assert perceive(world, replace(frame, rgb=frame.rgb // 3)).graph.stacks() == (
            ("red_box", "blue_box"),
            ("green_box",),
            (),
        )

    def test_a_camera_that_is_lower_than_it_says_puts_blocks_below_the_table(
        self, world: World
    ) -> None:
        world.reset((("red_box", "blue_box"), ("green_box",), ()))
        frame, camera = world.render(), camera_of(world)
        lower = camera.world_from_optical - np.outer([0.0, 0.0, 1.0, 0.0], [0.0, 0.0, 0.0, 0.012])
        perceived = PERCEPTION.perceive(
            Observation(
                frame.rgb, frame.labels, frame.depth, replace(camera, world_from_optical=lower)
            )
        )
        assert perceived.status is GraphStatus.UNSTABLE
        assert re.search("12 mm below the table; check camera/extrinsics", perceived.message)


class TestBadFrames:
    @pytest.fixture
    def frame(self, world: World) -> Frame:
        world.reset(TOWERS)
        return world.render()

    def check(self, world: World, frame: Frame, sentence: str) -> None:
        perceived = perceive(world, frame)
        assert perceived.status is GraphStatus.BAD_IMAGE
        assert sentence in perceived.message
        assert perceived.graph.objects == ()

    def test_images_that_do_not_fit_together(self, world: World, frame: Frame) -> None:
        depth = frame.depth[:, :100]
        self.check(world, replace(frame, depth=depth), "depth is 100x256")

    @pytest.mark.parametrize("value", [0.0, np.nan])
    def test_a_block_without_depth(self, world: World, frame: Frame, value: float) -> None:
        depth = frame.depth.copy()
        depth[frame.labels == world.label("blue_box")] = value
        self.check(world, replace(frame, depth=depth), "depth of the object with label")

    @pytest.mark.parametrize("value", [0.0, np.nan])
    def test_some_missing_depth_does_no_harm(
        self, world: World, frame: Frame, value: float
    ) -> None:
        depth = frame.depth.copy()
        depth[np.random.default_rng(0).random(depth.shape) < 0.1] = value
        perceived = perceive(world, replace(frame, depth=depth))
        assert perceived.graph.stacks() == TOWERS
        assert perceived.status is GraphStatus.CONFIDENT, perceived.message


def test_damaged_masks_lower_the_confidence(world: World) -> None:
    world.reset(TOWERS)
    frame = world.render()
    labels = frame.labels.copy()
    rows, columns = np.nonzero(labels == world.label("purple_box"))
    labels[rows[columns > columns.mean()], columns[columns > columns.mean()]] = 0
    perceived = perceive(world, replace(frame, labels=labels))
    assert perceived.status is not GraphStatus.CONFIDENT


def test_a_graph_below_the_least_confidence_says_which_block(world: World) -> None:
    world.reset(TOWERS)
    strict = PERCEPTION.configured(PerceptionConfig(min_confidence=1.0))
    frame = world.render()
    perceived = strict.perceive(Observation(frame.rgb, frame.labels, frame.depth, camera_of(world)))
    assert perceived.status is GraphStatus.LOW_CONFIDENCE
    worst = min(perceived.graph.objects, key=lambda item: item.confidence)
    assert worst.name in perceived.message and "required: 1.00" in perceived.message
