# SPDX-License-Identifier: Apache-2.0
"""What belongs together of few things, without what scipy spends on a sparse matrix."""

from __future__ import annotations

from collections.abc import Iterable

import numpy as np
from numpy.typing import NDArray


def components(count: int, pairs: Iterable[tuple[int, int]]) -> tuple[int, NDArray[np.intp]]:
    """How many groups linked things make, and the group of each, in the order of their first ones.

    Args:
        pairs: things that are linked, as numbers below ``count``.
    """
    first = list(range(count))  # of its group, or another one of it on the way there

    def find(thing: int) -> int:
        while first[thing] != thing:
            first[thing] = thing = first[first[thing]]
        return thing

    for one, other in pairs:
        one, other = find(one), find(other)
        first[max(one, other)] = min(one, other)
    numbers: dict[int, int] = {}
    groups = [numbers.setdefault(find(thing), len(numbers)) for thing in range(count)]
    return len(numbers), np.array(groups, np.intp)
