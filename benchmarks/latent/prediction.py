# SPDX-License-Identifier: Apache-2.0
"""How right predicted codes are, with the two baselines that see through the easy bits."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

Codes = NDArray[np.uint8]
#: Codes (n, b) and actions (n,) to codes (n, b).
Predict = Callable[[Codes, NDArray[np.int64]], Codes]

_POPCOUNT = np.unpackbits(np.arange(256, dtype=np.uint8)[:, None], axis=1).sum(1).astype(np.int32)


@dataclass(frozen=True)
class Accuracy:
    """Of predicted codes.

    Attributes:
        bits: share of bits that are right (the accuracy of 4.3).
        changed: the same over bits that the action changes.
        whole: share of codes all of whose bits are right.
        n: number of codes.
    """

    bits: float
    changed: float
    whole: float
    n: int


def accuracy(predicted: Codes, before: Codes, after: Codes) -> Accuracy:
    """Of predicted codes (n, b), beside those before and after the action."""
    wrong = _POPCOUNT[predicted ^ after].sum(1)
    changing = before ^ after
    changed = _POPCOUNT[changing].sum()
    missed = _POPCOUNT[(predicted ^ after) & changing].sum()
    bits = 8 * after.shape[1]
    return Accuracy(
        float(1.0 - wrong.mean() / bits),
        float(1.0 - missed / max(int(changed), 1)),
        float((wrong == 0).mean()),
        len(after),
    )


def distance(first: Codes, second: Codes) -> NDArray[np.int32]:
    """Number of bits that differ, shape (n, b) and (m, b) -> (n, m)."""
    found = np.zeros((len(first), len(second)), np.int32)
    for row, code in enumerate(first):
        found[row] = _POPCOUNT[second ^ code].sum(1)
    return found


class CopyState:
    """Baseline: nothing happens."""

    def __call__(self, codes: Codes, _actions: NDArray[np.int64]) -> Codes:
        """See :data:`Predict`."""
        return codes


class NearestTransition:
    """Baseline: what the same action led to in the most similar state that was seen."""

    def __init__(self, before: Codes, actions: NDArray[np.int64], after: Codes) -> None:
        varying = (before != before[:1]).any(0)
        self._varying = varying
        self._seen = {
            int(action): (before[actions == action][:, varying], after[actions == action])
            for action in np.unique(actions)
        }

    def __call__(self, codes: Codes, actions: NDArray[np.int64]) -> Codes:
        """See :data:`Predict`."""
        predicted = codes.copy()
        for action, (before, after) in self._seen.items():
            rows = np.flatnonzero(actions == action)
            if len(rows):
                nearest = distance(codes[rows][:, self._varying], before).argmin(1)
                predicted[rows] = after[nearest]
        return predicted
