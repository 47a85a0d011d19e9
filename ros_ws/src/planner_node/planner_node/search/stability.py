# SPDX-License-Identifier: Apache-2.0
"""What may stand on what: the shapes and widths of blocks decide, as they were seen (5.4.2).

From a sphere a block rolls, from the ridge of a prism it slides: there it cannot stand at all. On a
block that is much narrower it stands as long as nothing heavy comes on top of it. The motion node
puts a block with its centre up to the share o (``max_overhang``, 0.2) of its support's width w
beside its support's centre. Of a support, a block W wide on it and a heavy one on that, the centre
of mass is up to o w + o W beside the support's centre, and within the support as long as
o w + o W <= w / 2: W / w <= 1 / (2 o) - 1 = 1.5.
"""

from __future__ import annotations

from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass, field, replace
from typing import Final

import numpy as np

from scene_graph import (
    BOX,
    FLAT_TOPPED,
    SHAPES,
    SPHERE,
    Move,
    SceneObject,
    Stacks,
    rotation_from_quaternion,
)

#: Widths of a block and its support up to which what stands on both stays above the support.
MAX_WIDTH_RATIO: Final = 1.5


@dataclass(frozen=True)
class Figure:
    """What a block is like for what stands on it and under it.

    Attributes:
        shape: one of ``scene_graph.SHAPES``; any other counts as a box.
        long, short: its horizontal extents, the longer one first [m]; 0.0: not known.
    """

    shape: str = BOX
    long: float = 0.0
    short: float = 0.0

    @property
    def carries(self) -> bool:
        """Whether anything can stand on it."""
        return self.shape in FLAT_TOPPED or self.shape not in SHAPES


@dataclass(frozen=True)
class Unstable:
    """A block on one that it should not stand on.

    Attributes:
        block, support: their names.
        reason: a clause on the block, such as "it would roll off".
        falls: it cannot stand there; False: it stands, and tips when a heavy one comes onto it.
        step: the move of a plan that puts it there, from 0.
    """

    block: str
    support: str
    reason: str
    falls: bool
    step: int = 0

    def __str__(self) -> str:
        """Such as "red_box on green_sphere (it would roll off)"."""
        return f"{self.block} on {self.support} ({self.reason})"


@dataclass(frozen=True)
class Stability:
    """What may stand on what in one scene.

    Attributes:
        figures: of the blocks, by name; one that is missing counts as a box of unknown size.
        require: nothing is put where it is unstable; False: much wider ones on narrower ones are,
            where no plan avoids it.
        max_width_ratio: see :data:`MAX_WIDTH_RATIO`.
    """

    figures: Mapping[str, Figure] = field(default_factory=dict)
    require: bool = False
    max_width_ratio: float = MAX_WIDTH_RATIO

    def objection(self, block: str, support: str) -> Unstable | None:
        """What is wrong with a block on another; None: it stands."""
        upper, lower = self.figures.get(block, _PLAIN), self.figures.get(support, _PLAIN)
        if not lower.carries:
            way = "roll" if lower.shape == SPHERE else "slide"
            return Unstable(block, support, f"it would {way} off", falls=True)
        # A sphere touches what it is on in its middle.
        if upper.shape == SPHERE or not lower.short:
            return None
        most = self.max_width_ratio
        if upper.long <= most * lower.long and upper.short <= most * lower.short:
            return None
        ratio = max(upper.long / lower.long, upper.short / lower.short)
        return Unstable(block, support, f"it is {ratio:.1f} times as wide", falls=False)

    def unstable(self, initial: Stacks, moves: Sequence[Move]) -> tuple[Unstable, ...]:
        """What a plan puts where it is unstable, in order; of the start nothing is said."""
        found = []
        stacks = [list(stack) for stack in initial]
        for step, move in enumerate(moves):
            block, target = stacks[move.source].pop(), stacks[move.target]
            objection = self.objection(block, target[-1]) if target else None
            if objection is not None:
                found.append(replace(objection, step=step))
            target.append(block)
        return tuple(found)


_PLAIN: Final = Figure()


def stability_of(
    objects: Iterable[SceneObject],
    require: bool = False,
    max_width_ratio: float = MAX_WIDTH_RATIO,
) -> Stability:
    """What may stand on what among blocks as they were seen."""
    figures = {item.name: figure_of(item) for item in objects}
    return Stability(figures, require, max_width_ratio)


def figure_of(item: SceneObject) -> Figure:
    """The shape of a block and how wide it is as it stands."""
    numbers = np.array([*item.size, *item.quaternion_world], float)
    if not np.all(np.isfinite(numbers)) or min(item.size) <= 0.0 or not np.any(numbers[3:]):
        return Figure(item.shape)
    vertical = int(np.argmax(np.abs(rotation_from_quaternion(item.quaternion_world)[2])))
    short, long = sorted(edge for axis, edge in enumerate(item.size) if axis != vertical)
    return Figure(item.shape, long, short)
