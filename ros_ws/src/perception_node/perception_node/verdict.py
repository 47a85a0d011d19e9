# SPDX-License-Identifier: Apache-2.0
"""The verdict: whether a graph can be planned on, and if not, a sentence that says why.

A graph is honest if every block stands as the words ``up`` and ``stackN`` claim, if nothing hides
the places, and if the visual module reproduces what it saw (A.2.5).
"""

from __future__ import annotations

from collections.abc import Sequence
from typing import Final, NamedTuple

import numpy as np

from scene_graph import GraphStatus, SceneGraph, SceneObject, base_name, is_hidden

from .blocks import Blocks, MeasuredBlock
from .config import PerceptionConfig, StabilityLimits
from .fallen import FallenBlock
from .hiding import Hidden, hidden_by_blocks
from .names import Names
from .places import Standing
from .places.occlusion import Occlusion

#: Noise of colours from which on it may be why a graph is refused [0..255].
GRAIN: Final = 8.0

#: Centres that follow from outlines alone may be so many times less certain than measured ones.
BY_OUTLINE: Final = 3.0
#: What is so many times as high as wide may be two blocks, where no depth shows that it is not.
TALL: Final = 1.5

_TIDY_UP: Final = "look again, or tidy up by hand"


class Verdict(NamedTuple):
    """A status, and what a person may do about it; empty for a confident graph."""

    status: GraphStatus
    message: str = ""


def judge(
    graph: SceneGraph,
    occlusion: Occlusion,
    standing: Standing,
    blocks: Blocks,
    names: Names,
    config: PerceptionConfig,
    hidden: Sequence[Hidden] = (),
) -> Verdict:
    """The first reason not to plan on a graph, or that there is none.

    Args:
        hidden: where blocks may be that other blocks hide.
    """
    if sentence := occluded(occlusion, config.max_hidden):
        return Verdict(GraphStatus.OCCLUDED, sentence)
    if standing.problem:
        return Verdict(GraphStatus.UNSTABLE, f"{standing.problem}; put every block on a place")
    if sentence := instability(blocks, names.names, standing, config.limits, hidden):
        return Verdict(GraphStatus.UNSTABLE, sentence)
    if names.doubt and (hidden or not names.alternatives):
        return Verdict(GraphStatus.LOW_CONFIDENCE, names.doubt)
    if sentence := unclear_shape(blocks, names.names):
        return Verdict(GraphStatus.LOW_CONFIDENCE, sentence)
    if blocks.behind:
        return Verdict(
            GraphStatus.LOW_CONFIDENCE,
            f"{names.names[blocks.behind[0]]} may stand behind the block below it, rather than on "
            "it: in colour alone that looks the same; look from higher up, or set mask_source to "
            "rgbd",
        )
    if sentence := two_in_one(blocks, names.names):
        return Verdict(GraphStatus.LOW_CONFIDENCE, sentence)
    if sentence := doubtful(blocks, names.names, config.limits):
        return Verdict(GraphStatus.LOW_CONFIDENCE, sentence)
    if graph.confidence < config.min_confidence:
        seen = [item for item in graph.objects if not is_hidden(item.name)]
        worst = min(seen, key=lambda item: item.confidence)
        spots = zip(standing.places, standing.stacks)
        if beside := [names.names[item] for place, stack in spots if place.aside for item in stack]:
            return Verdict(
                GraphStatus.OCCLUDED,
                f"{worst.name} is not seen well enough where {' and '.join(beside)} stands beside "
                "the places; put it on one, or take it away",
            )
        return Verdict(
            GraphStatus.LOW_CONFIDENCE,
            f"the visual module reproduces {worst.name} with a confidence of only "
            f"{worst.confidence:.2f} (required: {config.min_confidence:.2f}); look again, "
            "check the picture and its masks, or train it on such scenes",
        )
    if hidden:
        sentence = hidden_by_blocks(hidden, standing, blocks, names.names)
        return Verdict(GraphStatus.HIDDEN, sentence)
    if names.doubt:
        return Verdict(GraphStatus.DOUBTFUL, names.doubt)
    return Verdict(GraphStatus.CONFIDENT)


def with_grain(verdict: Verdict, noise: float) -> Verdict:
    """The verdict; one on a picture that is too grainy to rely on says so.

    Args:
        noise: standard deviation of the picture's channels [0..255].
    """
    if verdict.status is GraphStatus.CONFIDENT or noise < GRAIN:
        return verdict
    return verdict._replace(
        message=f"{verdict.message}; the colours of camera/image_raw have a noise of {noise:.0f} "
        "grey levels: give more light, or less gain"
    )


def judge_empty(occlusion: Occlusion, config: PerceptionConfig) -> Verdict:
    """The verdict on a picture that shows no block."""
    if sentence := occluded(occlusion, config.max_hidden):
        return Verdict(GraphStatus.OCCLUDED, sentence)
    return Verdict(
        GraphStatus.NO_OBJECTS,
        "no block is seen; put blocks on the table, or check the camera and its calibration",
    )


def judge_fallen(
    block: FallenBlock, occlusion: Occlusion, config: PerceptionConfig, by_depth: bool = True
) -> Verdict:
    """The verdict on a picture with a block that could not be measured as one that is upright.

    Args:
        by_depth: whether it was measured by depth, or else by its outline.
    """
    if hidden := occluded(occlusion, config.max_hidden):
        return Verdict(GraphStatus.OCCLUDED, hidden)
    if not by_depth:
        return Verdict(
            GraphStatus.UNSTABLE,
            f"the outline of the {block.color} block is not that of a block that stands upright on "
            "the table or on another one; put it upright, or take away what looks like it",
        )
    return Verdict(
        GraphStatus.UNSTABLE,
        f"the {block.color} block lies on its side or leans: no upright face of it is seen; put "
        "it upright, or check the depth camera if it is",
    )


def occluded(occlusion: Occlusion, max_hidden: float) -> str:
    """A sentence about the place that is hidden most, or an empty string."""
    if occlusion.greatest <= max_hidden:
        return ""
    worst = int(np.argmax(occlusion.shares))
    return (
        f"something that is not a block on a place hides {occlusion.shares[worst]:.0%} of "
        f"{base_name(worst)}: a hand, a tool, or a block that stands on no place; look again when "
        "it is gone"
    )


def with_stray(verdict: Verdict, strays: Sequence[SceneObject]) -> Verdict:
    """The verdict, with what lies before the places, and may be what hides them."""
    if verdict.status is not GraphStatus.OCCLUDED or not strays:
        return verdict
    names = ", ".join(sorted(item.name for item in strays))
    return verdict._replace(message=f"{verdict.message}; before the places lies {names}")


def instability(
    blocks: Blocks,
    names: tuple[str, ...],
    standing: Standing,
    limits: StabilityLimits,
    hidden: Sequence[Hidden] = (),
) -> str:
    """A sentence about the first block that does not stand, or an empty string.

    What stands on hidden blocks does, as far as anybody can see.

    Nothing is said of blocks that were not measured, or where it is not known on which places.
    """
    if not blocks.measured:
        return ""
    on_hidden = {(item.place, item.level) for item in hidden}
    for stack, place in zip(standing.stacks, standing.places):
        below: MeasuredBlock | None = None
        under = "the table"
        for level, item in enumerate(stack):
            block, name = blocks.measured[item], names[item]
            pose = block.pose
            if block.tilt > limits.tilt:
                return f"{name} leans by {np.degrees(block.tilt):.0f} degrees; {_TIDY_UP}"
            if (place.index, level) in on_hidden:
                below, under = block, name
                continue
            support = place.position_world[2] if below is None else below.pose.top
            if abs(pose.bottom - support) > limits.gap:
                return f"{name} {_height_text(pose.bottom - support, under, below is None)}"
            centre = place.position_world if below is None else below.pose.position_world
            offset = float(np.hypot(*np.subtract(pose.position_world[:2], centre[:2])))
            if below is None and offset > limits.place_tolerance:
                base = base_name(place.index)
                beside = f"{1000 * offset:.0f} mm beside the centre of {base}"
                return f"{name} stands {beside}; {_TIDY_UP}, or calibrate the camera if all do"
            if below is not None and offset > limits.overhang * pose.size[0]:
                return f"{name} overhangs {under} by {1000 * offset:.0f} mm; {_TIDY_UP}"
            below, under = block, name
    return ""


def doubtful(blocks: Blocks, names: tuple[str, ...], limits: StabilityLimits) -> str:
    """A sentence about the block whose centre is known worst, or an empty string."""
    deviations = [max(block.deviation[:2]) for block in blocks.measured]
    most = limits.doubt * (BY_OUTLINE if blocks.by_outline else 1.0)
    if not deviations or max(deviations) <= most:
        return ""
    worst = int(np.argmax(deviations))
    return (
        f"how far {names[worst]} reaches back is not seen: its centre is known to "
        f"{1000 * deviations[worst]:.1f} mm only (required: {1000 * most:.1f} mm); look "
        "from another side or from higher up"
    )


def two_in_one(blocks: Blocks, names: tuple[str, ...]) -> str:
    """A sentence about the first block that may be two in one outline, or an empty string."""
    for block, name in zip(blocks.measured, names):
        wide, deep, high = block.pose.size
        if blocks.by_outline and high > TALL * max(wide, deep):
            return (
                f"{name} is {high / max(wide, deep):.1f} times as high as wide: in colour alone it "
                "may be two blocks; set mask_source to rgbd, or take it away"
            )
    return ""


def unclear_shape(blocks: Blocks, names: tuple[str, ...]) -> str:
    """A sentence about the first block that may as well have another shape, or an empty string."""
    for block, name in zip(blocks.measured, names):
        if block.rival:
            return (
                f"{name} may as well be a {block.rival}: both fit what is seen of it; look from "
                "another side, from higher up or from nearer"
            )
    return ""


def _height_text(gap: float, under: str, on_table: bool) -> str:
    """What a wrong height of a block's lower end over what is under it means [m]."""
    if gap > 0.0:
        end = f"its lower end is {1000 * gap:.0f} mm above {under}"
        return f"is in the air or tilted: {end}; {_TIDY_UP}"
    if on_table:  # where nothing can be: what is measured is wrong, not what stands there
        end = f"its lower end is {-1000 * gap:.0f} mm below {under}"
        return f"cannot be where it is measured: {end}; check camera/extrinsics and the depth"
    end = f"its lower end is {-1000 * gap:.0f} mm below the top of {under}"
    return f"lies or leans beside {under}: {end}; {_TIDY_UP}"
