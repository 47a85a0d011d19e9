# SPDX-License-Identifier: Apache-2.0
"""Layouts: which blocks start in which stack, random, enumerated or written by hand."""

from __future__ import annotations

import itertools
from collections.abc import Iterator, Sequence
from typing import Final

import numpy as np

from scene_graph import BOX, COLORS, Stacks, object_name, split_object_name

#: How many blocks can be put on the table.
MIN_BLOCKS: Final = 1
MAX_BLOCKS: Final = 7
#: How many a random scene of the simulator has at least: with fewer there is little to plan.
MIN_RANDOM_BLOCKS: Final = 3


class LayoutError(ValueError):
    """A layout that cannot be built; the sentence says why."""


def check_layout(layout: Stacks, stack_count: int) -> None:
    """Raises LayoutError for a layout that cannot be put on the table."""
    if len(layout) != stack_count:
        raise LayoutError(f"the table has {stack_count} stacks, the layout has {len(layout)}")
    names = [name for stack in layout for name in stack]
    if not MIN_BLOCKS <= len(names) <= MAX_BLOCKS:
        raise LayoutError(
            f"the layout has {len(names)} blocks; {MIN_BLOCKS} to {MAX_BLOCKS} are possible"
        )
    if repeated := sorted({name for name in names if names.count(name) > 1}):
        raise LayoutError(f"a block can be in one place only: {', '.join(repeated)}")
    for stack in layout:
        for name, above in itertools.zip_longest(stack, stack[1:]):
            try:
                _, shape = split_object_name(name)
            except ValueError as error:
                raise LayoutError(str(error)) from error
            if shape == "sphere" and above is not None:
                raise LayoutError(f"{above} cannot stand on {name}: it would roll off")


def parse_layout(texts: Sequence[str], stack_count: int) -> Stacks:
    """Parses ``["red_box,blue_box", "", "green_box"]``; raises LayoutError."""
    layout = tuple(
        tuple(name.strip() for name in text.split(",")) if text.strip() else () for text in texts
    )
    check_layout(layout, stack_count)
    return layout


def requested_layout(texts: Sequence[str], seed: int, blocks: int, stack_count: int) -> Stacks:
    """The layout that a request for a scene means.

    Args:
        texts: an explicit layout as :func:`parse_layout` reads it, of 1 to 7 blocks; or empty.
        seed, blocks: of the random layout where ``texts`` is empty; 3 to 7 blocks.

    Raises:
        LayoutError: the sentence says what is possible instead.
    """
    if texts:
        return parse_layout(texts, stack_count)
    if not MIN_RANDOM_BLOCKS <= blocks <= MAX_BLOCKS:
        raise LayoutError(
            f"{blocks} blocks asked for; a random scene has {MIN_RANDOM_BLOCKS} to {MAX_BLOCKS}, "
            f"an explicit layout may have {MIN_BLOCKS} to {MAX_BLOCKS}"
        )
    return random_layout(seed, blocks, stack_count)


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
    names = [object_name(color, BOX) for color in rng.permutation(list(COLORS))[:blocks]]
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
