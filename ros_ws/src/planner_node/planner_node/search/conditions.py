# SPDX-License-Identifier: Apache-2.0
"""The relations of a goal as conditions on encoded states."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass

from scene_graph import ONE_ROW, PREDICATES, Relation, Rows, Spot, base_index

from ..goals.goal import Count

#: A state of the search: a string a stack, one character an object, from the bottom.
State = tuple[str, ...]


@dataclass(frozen=True, slots=True)
class Condition:
    """One relation of the goal, or a number of relations.

    Attributes:
        symbols: the blocks that it is about; only a move of one of them can change its truth.
        holds: whether a state fulfils it.
    """

    symbols: str
    holds: Callable[[State], bool]


class Conditions:
    """Makes conditions of relations, for the states that are encoded with the same symbols."""

    def __init__(
        self,
        symbols: Mapping[str, str],
        stack_count: int,
        height: int,
        rows: Rows = ONE_ROW,
    ) -> None:
        """``height``: the most blocks that a stack can have."""
        self._symbols = symbols
        # All spots of blocks by stack and level, made once.
        self._spots = tuple(
            tuple(rows.spot(stack, level) for level in range(height))
            for stack in range(stack_count)
        )
        self._bases = tuple(rows.spot(stack, -1) for stack in range(stack_count))

    def of(self, relation: Relation) -> Condition:
        """The predicate's meaning, at the spots of its two; what is not there fulfils nothing."""
        subject, object_ = self._locate(relation.subject), self._locate(relation.object)
        if subject is None or object_ is None:
            return Condition("", lambda _state: False)
        holds = PREDICATES[relation.predicate].holds
        names = (relation.subject, relation.object)
        return Condition(
            "".join(self._symbols.get(name, "") for name in names),
            lambda state: holds(subject(state), object_(state)),
        )

    def of_count(self, count: Count) -> Condition:
        """Whether as many of its relations hold as are asked for."""
        parts = [self.of(relation) for relation in count.relations]
        return Condition(
            "".join(part.symbols for part in parts),
            lambda state: count.least <= sum(part.holds(state) for part in parts) <= count.most,
        )

    def _locate(self, name: str) -> Callable[[State], Spot] | None:
        index = base_index(name)
        if index is not None:
            if index >= len(self._bases):
                return None
            spot = self._bases[index]
            return lambda _state: spot
        symbol = self._symbols.get(name)
        if symbol is None:
            return None

        def locate(state: State) -> Spot:
            for stack, spots in zip(state, self._spots):
                if symbol in stack:
                    return spots[stack.index(symbol)]
            raise AssertionError(f"{name} is not in {state}")

        return locate
