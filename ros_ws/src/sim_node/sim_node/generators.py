# SPDX-License-Identifier: Apache-2.0
"""Random layouts of any scene, by the name of what they are like."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from typing import Final

import numpy as np

from scene_graph import FLAT_TOPPED, Stacks, object_name, split_object_name

from .layouts import (
    MIN_BLOCKS,
    MIN_RANDOM_BLOCKS,
    LayoutError,
    TooHighError,
    check_layout,
    parse_layout,
    random_arrangement,
)
from .scene import Blocks, SceneConfig

#: So often a layout is drawn anew that is too high for the arm.
_DRAWS: Final = 200

#: Blocks of a scene to names: how many, and how many of them may be such that nothing stands on.
DrawNames = Callable[[Blocks, int, int, np.random.Generator], list[str]]
#: Names to a layout on so many places.
Arrange = Callable[[Sequence[str], np.random.Generator, int], Stacks]


@dataclass(frozen=True)
class LayoutGenerator:
    """One kind of random layout.

    Attributes:
        meaning: what it draws, for people.
        arrange: puts named blocks onto places.
        names: draws the blocks.
    """

    meaning: str
    arrange: Arrange
    names: DrawNames


def distinct_colors(blocks: Blocks, count: int, tops: int, rng: np.random.Generator) -> list[str]:
    """Names of which no two share a colour as long as there are colours left."""
    names: list[str] = []
    while len(names) < count:
        before = len(names)
        for color in rng.permutation(blocks.colors):
            allowed = FLAT_TOPPED if len(_pointed(names)) >= tops else blocks.shapes
            options = [
                object_name(color, shape)
                for shape in blocks.shapes
                if shape in allowed and object_name(color, shape) not in names
            ]
            if options and len(names) < count:
                drawn = int(rng.integers(len(options))) if len(options) > 1 else 0
                names.append(options[drawn])
        if len(names) == before:
            raise _too_few(before, tops)
    return names


def any_colors(blocks: Blocks, count: int, tops: int, rng: np.random.Generator) -> list[str]:
    """Names of which several may share a colour or a shape, all as likely as one another."""
    names: list[str] = []
    possible = [object_name(color, shape) for color in blocks.colors for shape in blocks.shapes]
    for name in (str(item) for item in rng.permutation(possible)):
        if len(names) < count and (_is_flat(name) or len(_pointed(names)) < tops):
            names.append(name)
    if len(names) < count:
        raise _too_few(len(names), tops)
    return names


def _too_few(found: int, tops: int) -> LayoutError:
    return LayoutError(
        f"there are only {found} blocks for such a layout: nothing stands on spheres and prisms, "
        f"so that it has {tops} of them at most, and the scene has no other names left"
    )


def _is_flat(name: str) -> bool:
    return split_object_name(name)[1] in FLAT_TOPPED


def _pointed(names: Sequence[str]) -> list[str]:
    return [name for name in names if not _is_flat(name)]


def _shuffled(names: Sequence[str], rng: np.random.Generator) -> tuple[list[str], list[str]]:
    """Those that others can stand on, and those that are only on top."""
    order = [names[index] for index in rng.permutation(len(names))]
    return [name for name in order if _is_flat(name)], _pointed(order)


def uniform(names: Sequence[str], rng: np.random.Generator, stack_count: int) -> Stacks:
    """All states in which the blocks can stand are equally likely."""
    tops = _pointed(names)
    if not tops:
        return random_arrangement(names, rng, stack_count)
    flat = [name for name in names if _is_flat(name)]
    stacks = [list(stack) for stack in random_arrangement(flat, rng, stack_count)]
    for name, stack in zip(tops, rng.permutation(stack_count)):
        stacks[stack].append(name)
    return tuple(map(tuple, stacks))


def tower(names: Sequence[str], rng: np.random.Generator, stack_count: int) -> Stacks:
    """All blocks in one stack."""
    flat, tops = _shuffled(names, rng)
    place = int(rng.integers(stack_count))
    return tuple((*flat, *tops) if index == place else () for index in range(stack_count))


def flat(names: Sequence[str], rng: np.random.Generator, stack_count: int) -> Stacks:
    """No block on another."""
    if len(names) > stack_count:
        raise LayoutError(
            f"{len(names)} blocks cannot all be on the table: it has {stack_count} places"
        )
    order = [names[index] for index in rng.permutation(len(names))]
    places = rng.permutation(stack_count)[: len(names)].tolist()
    return tuple(
        (order[places.index(index)],) if index in places else () for index in range(stack_count)
    )


def row(names: Sequence[str], rng: np.random.Generator, stack_count: int) -> Stacks:
    """Layer after layer, each from the left: all stacks are as high as one another, or one more."""
    flat_first = [name for part in _shuffled(names, rng) for name in part]
    return tuple(tuple(flat_first[index::stack_count]) for index in range(stack_count))


UNIFORM: Final = "uniform"
GENERATORS: Final[dict[str, LayoutGenerator]] = {
    UNIFORM: LayoutGenerator(
        "all states equally likely, colours distinct", uniform, distinct_colors
    ),
    "varied": LayoutGenerator(
        "all states, and all blocks that the scene allows, equally likely", uniform, any_colors
    ),
    "tower": LayoutGenerator("one tower, anywhere", tower, distinct_colors),
    "flat": LayoutGenerator("every block on the table", flat, distinct_colors),
    "row": LayoutGenerator("layer after layer from the left", row, distinct_colors),
}


def generate_layout(scene: SceneConfig, generator: str, seed: int, blocks: int) -> Stacks:
    """A random layout of a scene.

    Args:
        generator: a name of :data:`GENERATORS`; empty: uniform.
        blocks: how many.

    Raises:
        LayoutError: the sentence says what is possible instead.
    """
    generator = generator or UNIFORM
    if generator not in GENERATORS:
        raise LayoutError(f"there is no generator {generator!r}; known: {', '.join(GENERATORS)}")
    most = scene.blocks.most
    if not min(MIN_RANDOM_BLOCKS, most) <= blocks <= most:
        raise LayoutError(
            f"{blocks} blocks asked for; a random scene has {min(MIN_RANDOM_BLOCKS, most)} to "
            f"{most}, an explicit layout may have {MIN_BLOCKS} to {most}"
        )
    rng = np.random.default_rng(seed)
    chosen = GENERATORS[generator]
    tops = 1 if generator == "tower" else scene.stack_count
    problem = LayoutError("no layout was drawn")
    for _ in range(_DRAWS):
        names = chosen.names(scene.blocks, blocks, tops, rng)
        layout = chosen.arrange(names, rng, scene.stack_count)
        try:
            check_layout(layout, scene.stack_count, scene.blocks, seed)
        except TooHighError as error:
            problem = error
        else:
            return layout
    raise problem


def requested_layout(
    scene: SceneConfig, texts: Sequence[str], seed: int, blocks: int, generator: str = ""
) -> Stacks:
    """The layout that a request for a scene means.

    Args:
        texts: an explicit layout as :func:`parse_layout` reads it; or empty.
        seed, blocks, generator: of the random layout where ``texts`` is empty.

    Raises:
        LayoutError: the sentence says what is possible instead.
    """
    if texts:
        return parse_layout(texts, scene.stack_count, scene.blocks, seed)
    return generate_layout(scene, generator, seed, blocks)
