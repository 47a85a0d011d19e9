# SPDX-License-Identifier: Apache-2.0
"""Levers pulled together, each by an amount, and what that is called."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace
from typing import Final

import numpy as np

from .levers import Lever, Table

#: What is less is not worth telling, and so much is added to what is [m].
_SPARE: Final = 5e-4


@dataclass(frozen=True)
class Change:
    """Levers pulled together, each by an amount [m]."""

    levers: tuple[Lever, ...]
    amounts: tuple[float, ...]

    @property
    def size(self) -> float:
        """Sum of the amounts [m]."""
        return float(np.abs(self.amounts).sum())

    def beside(self, other: Change) -> float:
        """How far it is from another change of the same levers [m]."""
        return float(np.abs(np.subtract(self.amounts, other.amounts)).sum())

    def made(self, table: Table) -> Table:
        """The table after it."""
        for lever, amount in zip(self.levers, self.amounts):
            if amount:
                table = lever.pulled(table, amount)
        return table

    def grown(self, by: float) -> Change | None:
        """By so much more [m]; None where nothing can go farther."""
        more = [
            lever.rounded(a + float(np.sign(a)) * by) if a else 0.0
            for lever, a in zip(self.levers, self.amounts)
        ]
        amounts = _within(self.levers, more)
        return None if amounts == self.amounts else replace(self, amounts=amounts)

    def between(self, less: Change) -> Change | None:
        """Half way to a lesser change of the same levers; None where that is as much as this."""
        middle = [
            lever.rounded((one + other) / 2)
            for lever, one, other in zip(self.levers, self.amounts, less.amounts)
        ]
        return None if tuple(middle) == self.amounts else replace(self, amounts=tuple(middle))

    def words(self, table: Table) -> str:
        """Such as "move green_box 32 mm to the left and 4 mm nearer to the arm"."""
        parts: dict[str, list[str]] = {}
        for lever, amount in zip(self.levers, self.amounts):
            if amount:
                parts.setdefault(lever.thing, []).append(lever.by(amount, table))
        return ", and ".join(f"{thing} {' and '.join(by)}" for thing, by in parts.items())


def as_can_be_done(levers: Sequence[Lever], amounts: Sequence[float]) -> Change | None:
    """The change, rounded away from zero as levers say; None if nothing is left of it."""
    rounded = [
        lever.rounded(amount + float(np.sign(amount)) * _SPARE) if abs(amount) > _SPARE else 0.0
        for lever, amount in zip(levers, amounts)
    ]
    return Change(tuple(levers), _within(levers, rounded)) if any(rounded) else None


def _within(levers: Sequence[Lever], amounts: Sequence[float]) -> tuple[float, ...]:
    """Amounts, none farther than a lever goes."""
    return tuple(float(np.clip(amount, *lever.reach)) for lever, amount in zip(levers, amounts))
