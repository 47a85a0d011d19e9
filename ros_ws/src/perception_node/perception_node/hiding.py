# SPDX-License-Identifier: Apache-2.0
"""What stands in a graph for blocks that others hide, see :mod:`scene_graph.hidden` (5.4.3)."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Final

from scene_graph import BOX, HIDDEN, Place, SceneObject, base_name, hidden_name

from .blocks import Blocks, MeasuredBlock
from .config import PerceptionConfig
from .covered import Glimpse
from .places import Standing
from .places.hidden import Cells

#: Width of what stands for hidden blocks [m].
WIDTH: Final = 0.06
#: Least height of it [m].
LEAST: Final = 0.01


@dataclass(frozen=True)
class Hidden:
    """A part of the column over a place in which blocks may be that are not seen.

    Attributes:
        place: its index.
        level: how many blocks that are seen stand under it.
        low, high: its ends [m].
    """

    place: int
    level: int
    low: float
    high: float

    def stand_in(self, place: Place, number: int = 1) -> SceneObject:
        """What the graph has in its place; ``number``: the how many-th on the place."""
        x, y, _ = place.position_world
        name = hidden_name(self.place) + ("" if number == 1 else f"_{number}")
        height = max(LEAST, self.high - self.low)
        return SceneObject(
            name=name,
            color=HIDDEN,
            shape=BOX,
            position_world=(x, y, self.low + 0.5 * height),
            size=(WIDTH, WIDTH, height),
            confidence=0.0,
        )


def find_hidden(
    cells: Sequence[Cells],
    standing: Standing,
    blocks: Blocks,
    glimpses: Sequence[Glimpse],
    config: PerceptionConfig,
) -> tuple[Hidden, ...]:
    """Where blocks may be that are not seen, from the first place to the last, from the bottom.

    Nothing is said of what is under a block that is seen to be in the air.

    Args:
        cells: over each place of ``standing``.
    """
    if not blocks.measured or not standing.places:
        return ()
    found: list[Hidden] = []
    for place, stack, over in zip(standing.places, standing.stacks, cells):
        here = [item for item in glimpses if item.place == place.index]
        level_of = place.position_world[2]
        for level, item in enumerate(stack):
            pose = blocks.measured[item].pose
            gap = pose.bottom - level_of
            among = any(level_of - config.limits.gap < one.high < pose.bottom + config.limits.gap
                        for one in here)  # fmt: skip
            if gap > config.limits.gap and (
                among or _hides_all(over, level_of, pose.bottom, config.smallest_block)
            ):
                found.append(Hidden(place.index, level, level_of, pose.bottom))
            level_of = pose.top
        glimpsed = max((item.high for item in here), default=-1.0)
        if glimpsed > level_of + config.limits.gap or _hides_next(
            over, level_of, place, blocks.measured[stack[-1]] if stack else None, config
        ):
            up = level_of + over.hidden_above(level_of, config.smallest_block)
            found.append(Hidden(place.index, len(stack), level_of, max(up, glimpsed)))
    return tuple(found)


def _hides_next(
    cells: Cells,
    level: float,
    place: Place,
    top: MeasuredBlock | None,
    config: PerceptionConfig,
) -> bool:
    """Whether a block can be unseen on a place, or on the highest block of it that is seen."""
    edge = config.smallest_block
    if top is None:
        return cells.can_hide(level, edge)
    x, y = (a - b for a, b in zip(top.pose.position_world[:2], place.position_world[:2]))
    return cells.can_hide(level, edge, (x, y), config.limits.overhang * edge)


def _hides_all(cells: Cells, low: float, high: float, edge: float) -> bool:
    """Whether between two heights a tower can be that is not seen."""
    return low + cells.hidden_above(low, edge) > high - edge


def hiders(places: Sequence[Place], tops: Sequence[float], hidden: int) -> tuple[int, ...]:
    """The places whose stacks hide something on a place.

    Args:
        tops: heights of the stacks over the table [m].
    """
    return tuple(
        place.index
        for place, top in zip(places, tops)
        if place.clear and top > place.clear[hidden] and place.index != hidden
    )


def hidden_by_blocks(
    hidden: Sequence[Hidden], standing: Standing, blocks: Blocks, names: Sequence[str]
) -> str:
    """A sentence about what is hidden, or an empty string."""
    if not hidden:
        return ""
    tops = [
        max((blocks.measured[item].pose.top for item in stack), default=place.position_world[2])
        - place.position_world[2]
        for stack, place in zip(standing.stacks, standing.places)
    ]
    hidden_on = sorted({item.place for item in hidden})
    before = sorted({one for place in hidden_on for one in hiders(standing.places, tops, place)})
    where = ", ".join(map(base_name, hidden_on))
    what = ", ".join(names[item] for place in before for item in standing.stacks[place])
    by = f"{what} on {', '.join(map(base_name, before))}" if what else "what is in front"
    return f"what stands on {where} is hidden by {by}; move that aside, or look from higher up"
