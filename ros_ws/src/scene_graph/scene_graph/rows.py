# SPDX-License-Identifier: Apache-2.0
"""Rows: how the places lie, seen from the camera, and what follows from it for stacks (5.4.3)."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass, replace
from typing import Final

import numpy as np

from .hidden import is_hidden
from .places import Place, Point
from .predicates import FRONT, Spot
from .relations import Relation
from .stacks import Stacks

#: Places whose distances along their rows differ by less lie one behind the other [m].
SAME_COLUMN: Final = 0.03
#: Two rows differ in their distance from the camera by more than the places of one [m].
ROW_DEPTH: Final = 0.06


@dataclass(frozen=True)
class Rows:
    """In which row each place lies, and how far to the right; empty: all lie in one row.

    Attributes:
        rows: for each place the number of its row, 0 for the one that is nearest to the camera.
        columns: for each place its rank from the left among all rows; places of one column lie one
            behind the other.
    """

    rows: tuple[int, ...] = ()
    columns: tuple[int, ...] = ()

    @property
    def count(self) -> int:
        """How many rows there are."""
        return max(self.rows, default=0) + 1

    def spot(self, stack: int, level: int) -> Spot:
        """The spot at a level of a stack."""
        if stack >= len(self.rows):
            return Spot(stack, level)
        return Spot(stack, level, self.rows[stack], self.columns[stack])


#: All places side by side, however many there are.
ONE_ROW: Final = Rows()


def rows_of(places: Sequence[Place]) -> Rows:
    """How places lie, as their graph tells."""
    if all(place.row == 0 for place in places):
        return ONE_ROW
    return Rows(tuple(place.row for place in places), tuple(place.column or 0 for place in places))


def in_rows(positions: Sequence[Point], camera: Point) -> tuple[Place, ...]:
    """Places by how they lie for an upright camera: in one row, or in two.

    A second row begins where a place is further left than the one before, if all places from there
    on are further away by :data:`ROW_DEPTH`. The places of a row are numbered from the left. What
    is in no such order is taken for one row.

    Args:
        positions: in world [m].
        camera: its position in world [m].
    """
    places = tuple(Place(index, position) for index, position in enumerate(positions))
    ground = np.array(positions, dtype=np.float64).reshape(-1, 3)[:, :2]
    begins = _second_row(ground, np.array(camera[:2]))
    if begins is None:
        return places
    along = ground[begins - 1] - ground[0] + ground[-1] - ground[begins]
    if not along.any():  # one place a row
        away = ground.mean(axis=0) - camera[:2]
        along = np.array([away[1], -away[0]])
    columns = _ranks(ground @ (along / np.linalg.norm(along)))
    return tuple(
        replace(place, row=int(place.index >= begins), column=columns[place.index])
        for place in places
    )


def _second_row(ground: np.ndarray, camera: np.ndarray) -> int | None:
    """The index of the first place of a second row; None where there is none."""
    if len(ground) < 2:
        return None
    away = ground - camera
    middle = away.mean(axis=0)
    middle = middle / np.linalg.norm(middle)
    depth, aside = away @ middle, away @ np.array([middle[1], -middle[0]])
    bearing = [math.atan2(right, forward) for right, forward in zip(aside, depth)]
    begins = [i for i in range(1, len(ground)) if bearing[i] <= bearing[i - 1] + 1e-3]
    if len(begins) != 1 or depth[begins[0] :].min() <= depth[: begins[0]].max() + ROW_DEPTH:
        return None
    return begins[0]


def _ranks(values: np.ndarray) -> tuple[int, ...]:
    """Ranks from 0; values that are nearly the same have one rank."""
    order = np.argsort(values, kind="stable")
    steps = np.diff(values[order], prepend=values[order[0]]) > SAME_COLUMN
    ranks = np.empty(len(values), int)
    ranks[order] = np.cumsum(steps)
    return tuple(int(rank) for rank in ranks)


def front_relations(stacks: Stacks, rows: Rows) -> frozenset[Relation]:
    """Front-relations between the lowest blocks of stacks of different rows (5.4.3).

    What stands for hidden blocks is in none: nobody knows whether it is there.
    """
    lowest = {
        index: next((name for name in stack if not is_hidden(name)), None)
        for index, stack in enumerate(stacks[: len(rows.rows)])
    }
    return frozenset(
        Relation(near, FRONT, far)
        for i, near in lowest.items()
        for j, far in lowest.items()
        if near is not None and far is not None and rows.rows[i] < rows.rows[j]
    )
