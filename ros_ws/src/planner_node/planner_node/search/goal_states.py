# SPDX-License-Identifier: Apache-2.0
"""All states that fulfil a goal, where they are not too many: the other end of a search."""

from __future__ import annotations

from collections.abc import Callable
from typing import Final

import numpy as np

from .packed import Words, empty_word, inserted, inserted_like, spots
from .product import LIKE
from .wanted import Wanted

#: Arrangements of some of the blocks that are looked at, and states that are listed, at most.
MAX_TRIED: Final = 150_000
MAX_LISTED: Final = 30_000


def goal_states(wanted: Wanted, places: int, like: int, poll: Callable[[], None]) -> Words | None:
    """Every goal state as a word; None where there are too many; empty: no state is a goal.

    The blocks are put in one after the other, those first that the goal ties to the ones before;
    what the goal says of the blocks so far has to hold.
    """
    words = empty_word(places)
    inside: list[int] = []
    for block in _order(wanted):
        poll()
        if len(words) * (words.shape[1] + 1) > MAX_TRIED:
            return None
        words = inserted(words, block)
        inside.append(block)
        stack, level = spots(words, inside)
        words = words[wanted.holds_among(inside, stack, level)]
    for _ in range(like):
        poll()
        if len(words) * (words.shape[1] + 1) > MAX_TRIED:
            return None
        words = inserted_like(words, LIKE)
        stack, level = spots(words, inside)
        words = words[wanted.holds_among(inside, stack, level)]
    stack, level = spots(words, range(wanted.blocks))
    words = words[wanted.holds(stack, level)]
    return words if len(words) <= MAX_LISTED else None


def _order(wanted: Wanted) -> list[int]:
    left = list(range(wanted.blocks))
    order: list[int] = []
    while left:
        ties = [
            sum(int(wanted.linked[block, other]) for other in order)
            + int(wanted.linked[block].sum() > 0) * 0.5
            + wanted.pinned(block)
            for block in left
        ]
        order.append(left.pop(int(np.argmax(ties))))
    return order
