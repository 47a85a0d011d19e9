# SPDX-License-Identifier: Apache-2.0
"""The verdict names the first thing that is wrong with a graph."""

import re
from dataclasses import replace

import pytest

from perception_node.blocks import Blocks, MeasuredBlock
from perception_node.config import PerceptionConfig
from perception_node.names import Names
from perception_node.places import Standing
from perception_node.places.occlusion import Occlusion
from perception_node.verdict import judge, judge_empty
from scene_graph import BOX, BlockPose, GraphStatus, Place, SceneGraph, SceneObject

NAMES = Names(("red", "blue"), ("red_box", "blue_box"))
STANDING = Standing(((0, 1), ()), (0.0, 0.0), (Place(0, (0.5, 0.0, 0.0)), Place(1, (0.5, 0.2, 0))))
CLEAR = Occlusion(shares=(0.0, 0.0))
CONFIG = PerceptionConfig()


def block(
    x: float = 0.5, bottom: float = 0.0, tilt: float = 0.0, doubt: float = 0.0
) -> MeasuredBlock:
    """A cube of 40 mm above the first place, whose x is known to this standard deviation."""
    pose = BlockPose((x, 0.0, bottom + 0.02), 0.0, (0.04, 0.04, 0.04))
    return MeasuredBlock(BOX, pose, tilt, (doubt, *(0.0,) * 6))


def verdict(
    *measured: MeasuredBlock,
    standing: Standing = STANDING,
    occlusion: Occlusion = CLEAR,
    confidence: float = 0.9,
) -> tuple[GraphStatus, str]:
    objects = tuple(
        SceneObject(name, name[:-4], BOX, confidence=confidence) for name in NAMES.names
    )
    graph = SceneGraph(objects, frozenset(), standing.places, confidence)
    return judge(graph, occlusion, standing, Blocks((BOX, BOX), measured), NAMES, CONFIG)


def test_blocks_that_stand_are_confident() -> None:
    assert verdict(block(), block(bottom=0.04)) == (GraphStatus.CONFIDENT, "")
    assert verdict(block(0.52), block(0.535, 0.043)) == (GraphStatus.CONFIDENT, "")


@pytest.mark.parametrize(
    ("lower", "upper", "sentence"),
    [
        (block(), block(bottom=0.09), "blue_box is in the air or tilted: its lower end is 50 mm"),
        (block(bottom=0.1), block(bottom=0.14), "red_box is in the air .* above the table"),
        (block(), block(bottom=0.04, tilt=0.3), "blue_box leans by 17 degrees"),
        (
            block(0.575),
            block(0.575, 0.04),
            "red_box stands 75 mm beside the centre of stack0; .* calibrate",
        ),
        (block(), block(0.52, 0.04), "blue_box overhangs red_box by 20 mm"),
        (block(), block(bottom=0.03), "blue_box lies or leans beside red_box: .* 10 mm below the"),
    ],
)
def test_a_block_that_does_not_stand_is_named(
    lower: MeasuredBlock, upper: MeasuredBlock, sentence: str
) -> None:
    status, message = verdict(lower, upper)
    assert status is GraphStatus.UNSTABLE
    assert re.match(sentence, message)
    assert "; look again, or tidy up by hand" in message


def test_fault_13_what_is_below_the_table_is_measured_wrongly() -> None:
    status, message = verdict(block(bottom=-0.009), block(bottom=0.031))
    assert status is GraphStatus.UNSTABLE
    assert message == (
        "red_box cannot be where it is measured: its lower end is 9 mm below the table; check "
        "camera/extrinsics and the depth"
    )


def test_nothing_is_said_of_blocks_that_were_not_measured_or_have_no_place() -> None:
    assert verdict()[0] is GraphStatus.CONFIDENT
    nowhere = Standing(((0, 1),), (0.0,))
    assert verdict(block(0.9), block(0.2, 0.7), standing=nowhere)[0] is GraphStatus.CONFIDENT


def test_stacks_without_places_are_a_reason() -> None:
    status, message = verdict(standing=Standing(((0, 1),), (0.0,), problem="3 of 2"))
    assert (status, message) == (GraphStatus.UNSTABLE, "3 of 2; put every block on a place")


def test_a_hidden_place_comes_before_every_other_reason() -> None:
    hidden = Occlusion(shares=(0.1, 0.25))
    status, message = verdict(block(0.9), block(), occlusion=hidden, confidence=0.1)
    assert status is GraphStatus.OCCLUDED
    assert "on a place hides 25% of stack1" in message
    assert judge_empty(hidden, CONFIG) == (status, message)
    tolerant = replace(CONFIG, max_hidden=0.3)
    assert judge_empty(hidden, tolerant).status is GraphStatus.NO_OBJECTS


def test_a_block_whose_centre_is_known_badly_is_doubtful_unless_it_does_not_even_stand() -> None:
    limit = CONFIG.limits.doubt
    status, message = verdict(block(), block(bottom=0.04, doubt=2.0 * limit))
    assert status is GraphStatus.LOW_CONFIDENCE
    assert "how far blue_box reaches back is not seen" in message
    numbers = f"known to {2000 * limit:.1f} mm only (required: {1000 * limit:.1f} mm)"
    assert f"{numbers}; look from another side" in message
    assert verdict(block(doubt=0.9 * limit), block(bottom=0.04))[0] is GraphStatus.CONFIDENT
    assert verdict(block(), block(bottom=0.09, doubt=2 * limit))[0] is GraphStatus.UNSTABLE


def test_doubt_is_the_last_reason() -> None:
    status, message = verdict(block(), block(bottom=0.04), confidence=0.5)
    assert status is GraphStatus.LOW_CONFIDENCE
    assert "red_box with a confidence of only 0.50 (required: 0.60)" in message
    assert verdict(block(), block(bottom=0.09), confidence=0.5)[0] is GraphStatus.UNSTABLE


def test_a_block_that_may_have_another_shape_is_doubtful() -> None:
    unclear = replace(block(bottom=0.04), rival="cylinder")
    status, message = verdict(block(), unclear)
    assert status is GraphStatus.LOW_CONFIDENCE
    assert message.startswith("blue_box may as well be a cylinder")
