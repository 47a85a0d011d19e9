# SPDX-License-Identifier: Apache-2.0
"""Blocks: their sizes, masses and friction, given or drawn by a seed."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field
from typing import Annotated, Final, NamedTuple

import numpy as np

from scene_graph import (
    BASIC_COLORS,
    BOX,
    COLORS,
    CYLINDER,
    PRISM,
    SHAPES,
    SPHERE,
    split_object_name,
)

from .errors import SceneError
from .reading import Count, OneOf, ReadBy, Within, read

Size = tuple[float, float, float]

#: Edges that a block may have: the fingers open by 8 cm [m].
LEAST_EDGE: Final = 0.025
MOST_EDGE: Final = 0.07
#: How many blocks there can be in any scene.
MOST_BLOCKS: Final = 14


class Span(NamedTuple):
    """A range to draw from; both ends are the same where there is nothing to draw."""

    low: float
    high: float

    def draw(self, rng: np.random.Generator) -> float:
        """Uniform."""
        return self.low + (self.high - self.low) * float(rng.random())


_SIZE: Final = Span(0.045, 0.045)
_MASS: Final = Span(0.08, 0.08)
_FRICTION: Final = Span(0.9, 0.9)


def read_span(data: object, key: str) -> Span:
    """A number, or [low, high]; raises SceneError."""
    if not isinstance(data, list):
        value = read(float, data, key)
        return Span(value, value)
    if len(data) != 2:
        raise SceneError(key, f"= {data} is neither a number nor a range [low, high]")
    low, high = read(tuple[float, float], data, key)
    if low > high:
        raise SceneError(key, f"= {data} is a range whose low end is above its high end")
    return Span(low, high)


def read_edges(data: object, key: str) -> Size:
    """A number for all three edges, or [x, y, z]; raises SceneError."""
    if isinstance(data, list):
        edges: Size = read(tuple[float, float, float], data, key)
        return edges
    edge = read(float, data, key)
    return (edge, edge, edge)


def centre_above_body(shape: str, size: Size) -> float:
    """Height of the middle of something's extents above its centre of mass [m].

    A prism of height h has its centre of mass at h / 3.
    """
    return size[2] / 6.0 if shape == PRISM else 0.0


_Edges = Annotated[Size, ReadBy(read_edges), Within(LEAST_EDGE, MOST_EDGE, "m")]
_Mass = Within(0.005, 2.0, "kg")
_Friction = Within(0.05, 2.0)
_Paint = Within(0.0, 1.0)


@dataclass(frozen=True)
class Block:
    """A block as it is in one scene.

    Attributes:
        name: colour and shape, as ``red_box``.
        color, shape: as words.
        size: full extents along its own axes [m]; diameter twice and height of a cylinder, the
            diameter thrice of a sphere, base, length and height of a prism.
        mass: [kg].
        friction: lateral, against what has a friction of 1.
        paint: how it looks, sRGB in 0..1; None: as ``COLORS`` has its colour.
    """

    name: str
    color: str
    shape: str
    size: Size
    mass: float
    friction: float
    paint: Size | None = None

    @property
    def centre_above_body(self) -> float:
        """Height of the middle of its extents above its centre of mass, when it is upright [m]."""
        return centre_above_body(self.shape, self.size)


@dataclass(frozen=True)
class NamedBlock:
    """What a scene says of one block; None: as of all others."""

    size: _Edges | None = None
    mass: Annotated[float, _Mass] | None = None
    friction: Annotated[float, _Friction] | None = None
    paint: Annotated[Size, _Paint] | None = None


@dataclass(frozen=True)
class Blocks:
    """What the blocks of a scene are like.

    Attributes:
        size: edge of a box; diameter and height of a cylinder; diameter of a sphere; base, length
            and height of a prism [m].
        shapes, colors: that random layouts draw from; explicit ones may name any.
        mass: [kg].
        friction: lateral.
        most: how many there can be at once.
        named: what is otherwise about single blocks, by their names.
    """

    size: Annotated[Span, ReadBy(read_span), Within(LEAST_EDGE, MOST_EDGE, "m")] = _SIZE
    shapes: Annotated[tuple[Annotated[str, OneOf(SHAPES)], ...], Count(1, len(SHAPES))] = (BOX,)
    colors: Annotated[tuple[Annotated[str, OneOf(tuple(COLORS))], ...], Count(1, len(COLORS))] = (
        BASIC_COLORS
    )
    mass: Annotated[Span, ReadBy(read_span), _Mass] = _MASS
    friction: Annotated[Span, ReadBy(read_span), _Friction] = _FRICTION
    most: Annotated[int, Within(1, MOST_BLOCKS, "blocks")] = 7
    named: Mapping[str, NamedBlock] = field(default_factory=dict, hash=False)

    def block(self, name: str, seed: int = 0) -> Block:
        """The block of a name in the scene of a seed, the same in whatever stack it stands.

        Raises:
            ValueError: for a name that is not ``color_shape``.
        """
        color, shape = split_object_name(name)
        rng = np.random.default_rng([seed, list(COLORS).index(color), SHAPES.index(shape)])
        edge, mass, friction = (span.draw(rng) for span in (self.size, self.mass, self.friction))
        own = self.named.get(name, NamedBlock())
        return Block(
            name,
            color,
            shape,
            own.size or (edge, edge, edge),
            mass if own.mass is None else own.mass,
            friction if own.friction is None else own.friction,
            own.paint,
        )

    @property
    def widest(self) -> float:
        """The longest horizontal edge that a block can have [m]."""
        return max(
            [self.size.high, *(max(own.size[:2]) for own in self.named.values() if own.size)]
        )


def check_blocks(blocks: Blocks, key: str) -> None:
    """Raises SceneError for what cannot be, though every single value could."""
    for name in ("shapes", "colors"):
        words = getattr(blocks, name)
        if len(set(words)) != len(words):
            raise SceneError(f"{key}.{name}", f"= {list(words)} names one twice")
    possible = len(blocks.shapes) * len(blocks.colors)
    if blocks.most > possible:
        raise SceneError(
            f"{key}.most",
            f"= {blocks.most} is more than the {possible} names that {len(blocks.colors)} colors "
            f"and {len(blocks.shapes)} shapes make; list more of them",
        )
    for name, own in blocks.named.items():
        try:
            _, shape = split_object_name(name)
        except ValueError as error:
            raise SceneError(f"{key}.named", str(error)) from error
        size = own.size
        if size and shape == SPHERE and len(set(size)) > 1:
            raise SceneError(f"{key}.named.{name}.size", f"= {list(size)}: a sphere has one size")
        if size and shape == CYLINDER and size[0] != size[1]:
            raise SceneError(
                f"{key}.named.{name}.size",
                f"= {list(size)}: a cylinder is [diameter, diameter, height]",
            )
