# SPDX-License-Identifier: Apache-2.0
"""Pictures from before the one that is looked at: what a camera has sent that froze since."""

from __future__ import annotations

import itertools

import numpy as np

from perception.scenes import Drawn
from perception_node import Observation
from perception_node.continuity import Continuity
from scene_graph import Stacks
from sim_node import Frame, World, random_arrangement


def seen_frozen(earlier: Frame, way: Frame, now: Observation) -> bool:
    """Whether the node says so of colours of earlier that come with newer depth, twice."""
    continuity = Continuity()
    for stamp, depth in enumerate((earlier.depth, way.depth)):
        continuity.frozen_colors(10**8 * stamp, earlier.rgb, depth)
    return continuity.frozen_colors(2 * 10**8, now.rgb, now.depth) > 0.0


def earlier_state(world: World, drawn: Drawn, as_high: bool) -> Frame:
    """A picture of another state of the same blocks.

    Args:
        as_high: whether its stacks are as high as those of now, or some of them are not.
    """
    world.reset(_other_layout(drawn, as_high), drawn.seed)
    return world.render()


def on_the_way(world: World, drawn: Drawn, as_high: bool) -> Frame:
    """A picture after the first move from there: the highest block of some stack on the next."""
    stacks = [list(stack) for stack in _other_layout(drawn, as_high)]
    source = max(range(len(stacks)), key=lambda place: len(stacks[place]))
    stacks[(source + 1) % len(stacks)].append(stacks[source].pop())
    world.reset(tuple(map(tuple, stacks)), drawn.seed)
    return world.render()


def _other_layout(drawn: Drawn, as_high: bool) -> Stacks:
    """The state of :func:`earlier_state`, for its arguments."""
    names = [name for stack in drawn.layout for name in stack]
    heights = [len(stack) for stack in drawn.layout]
    rng = np.random.default_rng([drawn.seed, 14])
    while True:
        layout = random_arrangement(names, rng, len(heights))
        if as_high:
            order = iter([name for stack in layout for name in stack])
            layout = tuple(tuple(itertools.islice(order, height)) for height in heights)
        if layout != drawn.layout and as_high == ([len(stack) for stack in layout] == heights):
            return layout
