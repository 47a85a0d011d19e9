# SPDX-License-Identifier: Apache-2.0
"""Levers pulled by trying: where an elastic problem finds nothing, as it is a local solver's."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Sequence
from typing import Final

import numpy as np
from numpy.typing import NDArray

from .changes import Change, as_can_be_done
from .levers import HeightLever, Lever, Table

Array = NDArray[np.float64]

#: Shares of a lever's reach in the order in which they are tried.
_SHARES: Final = (0.125, 0.25, 0.5, 1.0)
#: A pull is known this well [m].
_EXACT: Final = 2e-3


def pulled(
    levers: Sequence[Lever],
    table: Table,
    possible: Callable[[Table], bool],
    over: Callable[[], bool],
    shares: Sequence[float] = _SHARES,
    exact: float = _EXACT,
) -> Change | None:
    """The least pull of one of the levers, or of heights alike, with which a table is possible.

    Each is pulled ever farther until it is; then the bound in between is halved. None: no pull
    that was tried is enough.

    Args:
        shares: of a lever's reach, in the order in which they are tried.
        exact: how well a pull is known [m].
    """
    best: Change | None = None
    for way in _ways(levers):
        less = 0.0
        for share in shares:
            change = as_can_be_done(levers, (share * way).tolist())
            if change is None or over() or (best and less * np.abs(way).sum() >= best.size):
                break
            if possible(change.made(table)):
                found = _halved(levers, way, (less, share), change, table, possible, over, exact)
                best = found if best is None or found.size < best.size else best
                break
            less = share
    return best


def _ways(levers: Sequence[Lever]) -> Iterator[Array]:
    """As far as each lever goes to either side, and as far as heights go together."""
    for index, lever in enumerate(levers):
        for end in lever.reach:
            if end:
                yield end * np.eye(len(levers))[index]
    if len(levers) > 1 and all(isinstance(lever, HeightLever) for lever in levers):
        yield np.array([lever.reach[1] for lever in levers])


def _halved(
    levers: Sequence[Lever],
    way: Array,
    between: tuple[float, float],
    change: Change,
    table: Table,
    possible: Callable[[Table], bool],
    over: Callable[[], bool],
    exact: float,
) -> Change:
    """The least change along a way between a share that is too little and one that is enough."""
    less, enough = between
    while (enough - less) * np.abs(way).max() > exact and not over():
        middle = (less + enough) / 2
        other = as_can_be_done(levers, (middle * way).tolist())
        if other is not None and possible(other.made(table)):
            enough, change = middle, other
        else:
            less = middle
    return change
