# SPDX-License-Identifier: Apache-2.0
"""Layouts: which blocks start in which stack, random, enumerated or written by hand.

Those of other random kinds, for any scene, are in ``generators``.
"""

from __future__ import annotations

import itertools
from collections.abc import Iterator, Sequence
from typing import Final

import numpy as np

from scene_graph import (
    BASIC_COLORS,
    BOX,
    FLAT_TOPPED,
    SPHERE,
    Stacks,
    base_name,
    object_name,
)

from .scene import Blocks
from .scene.table import HIGHEST_STACK

#: How many blocks can be put on the table where no scene says more.
MIN_BLOCKS: Final = 1
MAX_BLOCKS: Final = 7
#: How many a random scene of the simulator has at least: with fewer there is little to plan.
MIN_RANDOM_BLOCKS: Final = 3


class LayoutError(ValueError):
    """A layout that cannot be built; the sentence says why."""


class TooHighError(LayoutError):
    """A stack that the arm could not build."""


def check_layout(
    layout: Stacks, stack_count: int, blocks: Blocks | None = None, seed: int = 0
) -> None:
    """Raises LayoutError for a layout that cannot be put on the table.

    Args:
        blocks: what they are like; None: as by default.
        seed: of the scene: what is left open of the blocks is drawn by it.
    """
    blocks = blocks or Blocks()
    if len(layout) != stack_count:
        raise LayoutError(f"the table has {stack_count} stacks, the layout has {len(layout)}")
    names = [name for stack in layout for name in stack]
    if not MIN_BLOCKS <= len(names) <= blocks.most:
        raise LayoutError(
            f"the layout has {len(names)} blocks; {MIN_BLOCKS} to {blocks.most} are possible"
        )
    if repeated := sorted({name for name in names if names.count(name) > 1}):
        raise LayoutError(f"a block can be in one place only: {', '.join(repeated)}")
    for index, stack in enumerate(layout):
        _check_stack(stack, base_name(index), blocks, seed)


def _check_stack(stack: Sequence[str], place: str, blocks: Blocks, seed: int) -> None:
    height = 0.0
    for name, above in itertools.zip_longest(stack, stack[1:]):
        try:
            block = blocks.block(name, seed)
        except ValueError as error:
            raise LayoutError(str(error)) from error
        if block.shape not in FLAT_TOPPED and above is not None:
            way = "roll" if block.shape == SPHERE else "slide"
            raise LayoutError(f"{above} cannot stand on {name}: it would {way} off")
        height += block.size[2]
    if height > HIGHEST_STACK:
        raise TooHighError(
            f"the blocks of {place} would stand {height:.2f} m high; the arm stacks up to "
            f"{HIGHEST_STACK:g} m"
        )


def parse_layout(
    texts: Sequence[str], stack_count: int, blocks: Blocks | None = None, seed: int = 0
) -> Stacks:
    """Parses ``["red_box,blue_box", "", "green_box"]``; raises LayoutError."""
    layout = tuple(
        tuple(name.strip() for name in text.split(",")) if text.strip() else () for text in texts
    )
    check_layout(layout, stack_count, blocks, seed)
    return layout


def format_layout(layout: Stacks) -> list[str]:
    """The inverse of :func:`parse_layout`."""
    return [",".join(stack) for stack in layout]


def random_layout(seed: int, blocks: int, stack_count: int = 3) -> Stacks:
    """Boxes of distinct colours, uniform over all states of those blocks.

    Raises:
        LayoutError: if ``blocks`` is out of range.
    """
    if not MIN_BLOCKS <= blocks <= MAX_BLOCKS:
        raise LayoutError(f"{blocks} blocks asked for; {MIN_BLOCKS} to {MAX_BLOCKS} are possible")
    rng = np.random.default_rng(seed)
    names = [object_name(color, BOX) for color in rng.permutation(BASIC_COLORS)[:blocks]]
    return random_arrangement(names, rng, stack_count)


def random_arrangement(
    names: Sequence[str], rng: np.random.Generator, stack_count: int = 3
) -> Stacks:
    """The named blocks in a random state, uniform over all their states."""
    # A state is an order of the blocks and m - 1 bars among them; both are drawn uniformly.
    order = [names[index] for index in rng.permutation(len(names))]
    places = len(names) + stack_count - 1
    bars = np.sort(rng.permutation(places)[: stack_count - 1])
    heights = np.diff(np.concatenate([[-1], bars, [places]])) - 1
    ends = np.cumsum(heights)
    return tuple(tuple(order[end - height : end]) for end, height in zip(ends, heights))


def all_layouts(names: Sequence[str], stack_count: int = 3) -> Iterator[Stacks]:
    """All n!·C(n+m-1, m-1) states of the named blocks: 2,520 for 5 blocks on 3 stacks."""
    count = len(names)
    for order in itertools.permutations(names):
        for bars in itertools.combinations(range(count + stack_count - 1), stack_count - 1):
            cuts = [bar - index for index, bar in enumerate(bars)]
            yield tuple(order[a:b] for a, b in zip([0, *cuts], [*cuts, count]))
