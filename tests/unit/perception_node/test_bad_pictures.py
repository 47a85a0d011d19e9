# SPDX-License-Identifier: Apache-2.0
"""Pictures that cannot be used are refused with what is wrong with them."""

import re
from collections.abc import Callable
from dataclasses import replace

import numpy as np
import pytest
from seen_worlds import LABELLED, PERCEPTION, TOWERS, camera_of, observe, perceive

from perception_node import Perception, PerceptionConfig
from scene_graph import GraphStatus
from sim_node.camera import Frame
from sim_node.world import World

BOTH = pytest.mark.parametrize("perception", [PERCEPTION, LABELLED], ids=["found", "given"])


@BOTH
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
        self,
        world: World,
        perception: Perception,
        change: Callable[[Frame], Frame],
        sentence: str,
    ) -> None:
        world.reset(TOWERS)
        perceived = perceive(world, change(world.render()), perception)
        assert perceived.status is GraphStatus.BAD_IMAGE
        assert re.match(sentence, perceived.message), perceived.message
        assert perceived.graph.objects == ()

    def test_with_a_third_of_the_light_colours_are_still_told(
        self, world: World, perception: Perception
    ) -> None:
        layout = (("red_box", "blue_box"), ("green_box",), ())
        world.reset(layout)
        frame = world.render()
        perceived = perceive(world, replace(frame, rgb=frame.rgb // 3), perception)
        assert perceived.graph.stacks() == layout
        assert perceived.status is GraphStatus.CONFIDENT, perceived.message

    def test_a_camera_that_is_lower_than_it_says_puts_blocks_below_the_table(
        self, world: World, perception: Perception
    ) -> None:
        world.reset((("red_box", "blue_box"), ("green_box",), ()))
        frame, camera = world.render(), camera_of(world)
        lower = camera.world_from_optical - np.outer([0.0, 0.0, 1.0, 0.0], [0.0, 0.0, 0.0, 0.012])
        camera = replace(camera, world_from_optical=lower)
        perceived = perception.perceive(replace(observe(world, frame), camera=camera))
        assert perceived.status is GraphStatus.UNSTABLE
        assert re.search("12 mm below the table; check camera/extrinsics", perceived.message)


class TestBadFrames:
    @pytest.fixture
    def frame(self, world: World) -> Frame:
        world.reset(TOWERS)
        return world.render()

    def check(
        self, world: World, frame: Frame, sentence: str, perception: Perception = PERCEPTION
    ) -> None:
        perceived = perceive(world, frame, perception)
        assert perceived.status is GraphStatus.BAD_IMAGE
        assert sentence in perceived.message
        assert perceived.graph.objects == ()

    def test_images_that_do_not_fit_together(self, world: World, frame: Frame) -> None:
        depth = frame.depth[:, :100]
        self.check(world, replace(frame, depth=depth), "depth is 100x256")

    @pytest.mark.parametrize("value", [0.0, np.nan])
    @pytest.mark.parametrize("name", [name for stack in TOWERS for name in stack])
    def test_a_block_without_depth(
        self, world: World, frame: Frame, value: float, name: str
    ) -> None:
        depth = frame.depth.copy()
        depth[frame.labels == world.label(name)] = value
        bare = replace(frame, depth=depth)
        self.check(world, bare, "depth of the object with label", LABELLED)
        perceived = perceive(world, bare)
        assert perceived.status is not GraphStatus.CONFIDENT and perceived.message

    @BOTH
    @pytest.mark.parametrize("value", [0.0, np.nan])
    def test_some_missing_depth_does_no_harm(
        self, world: World, frame: Frame, perception: Perception, value: float
    ) -> None:
        depth = frame.depth.copy()
        depth[np.random.default_rng(0).random(depth.shape) < 0.1] = value
        perceived = perceive(world, replace(frame, depth=depth), perception)
        assert perceived.graph.stacks() == TOWERS
        assert perceived.status is GraphStatus.CONFIDENT, perceived.message


def test_a_mask_that_lost_its_half_is_made_whole(world: World) -> None:
    world.reset(TOWERS)
    frame = world.render()
    labels = frame.labels.copy()
    rows, columns = np.nonzero(labels == world.label("purple_box"))
    labels[rows[columns > columns.mean()], columns[columns > columns.mean()]] = 0
    perceived = perceive(world, replace(frame, labels=labels), LABELLED)
    assert perceived.status is GraphStatus.CONFIDENT, perceived.message
    assert perceived.graph.stacks() == TOWERS
    assert perceived.graph.relations == perceive(world, frame, LABELLED).graph.relations
    assert perceived.segments is not None
    whole = frame.labels == world.label("purple_box")
    found = perceived.segments.label_image == world.label("purple_box")
    assert np.count_nonzero(found & whole) > 0.95 * np.count_nonzero(found | whole)


def test_a_graph_below_the_least_confidence_says_which_block(world: World) -> None:
    world.reset(TOWERS)
    strict = PERCEPTION.configured(PerceptionConfig(min_confidence=1.0))
    perceived = perceive(world, perception=strict)
    assert perceived.status is GraphStatus.LOW_CONFIDENCE
    worst = min(perceived.graph.objects, key=lambda item: item.confidence)
    assert worst.name in perceived.message and "required: 1.00" in perceived.message
