# SPDX-License-Identifier: Apache-2.0
"""Moves: the high-level actions between stacks (5.3.1)."""

from __future__ import annotations

from dataclasses import dataclass


@dataclass(frozen=True, order=True)
class Move:
    """Take the top of stack ``source`` to stack ``target``: the action (p, q), from 0."""

    source: int
    target: int

    def __str__(self) -> str:
        return f"({self.source}, {self.target})"


def all_moves(stack_count: int) -> tuple[Move, ...]:
    """The fixed action set A^v of 5.2.2 for m stacks: every (p, q) with p ≠ q."""
    return tuple(Move(p, q) for p in range(stack_count) for q in range(stack_count) if p != q)
