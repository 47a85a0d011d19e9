# SPDX-License-Identifier: Apache-2.0
"""A chart parser: every way to read some words by the rules of a grammar, the cheapest first.

It works from the top down and keeps, for every category and position, where it may end and what it
then means (the chart), so that nothing is read twice. A rule's right side names categories, each
with the argument of its function that takes the meaning: ``"who:NP verb:VERB? what:LINK+"``. ``?``
may be left out, ``+`` comes once or more, ``*`` any number of times; what is in quotes is a word. A
function that returns None refuses what it was given. No rule may begin with its own category.
"""

from __future__ import annotations

from collections.abc import Callable, Collection, Hashable, Iterator, Mapping, Sequence
from dataclasses import dataclass
from typing import Any, Final

#: How many meanings of a category between two words are kept.
_KEPT: Final = 6

#: How many meanings are built before it is given up: a long text that may be read in many ways.
_MOST: Final = 60_000

#: Where something ends, what it means, and at what cost.
Found = tuple[int, Hashable, float]
#: For every word, by category, what begins there.
Lattice = Sequence[Mapping[str, Sequence[Found]]]


class TooManyReadings(Exception):
    """A text may be read in too many ways to look at them all."""


@dataclass(frozen=True)
class _Part:
    category: str
    argument: str
    optional: bool
    repeated: bool


@dataclass(frozen=True)
class _Rule:
    parts: tuple[_Part, ...]
    build: Callable[..., Any]
    cost: float


class Grammar:
    """Rules by category.

    Args:
        last: categories that are looked for only where they reach to the end.
    """

    def __init__(self, last: Collection[str] = ()) -> None:
        self.last = frozenset(last)
        self._rules: dict[str, list[_Rule]] = {}
        self._first: dict[str, frozenset[str]] = {}

    def add(self, category: str, side: str, build: Callable[..., Any], cost: float = 0.0) -> None:
        """Adds a rule, with the function that builds its meaning."""
        parts = tuple(map(_part, side.split()))
        self._rules.setdefault(category, []).append(_Rule(parts, build, cost))
        self._first.clear()

    def parses(self, category: str, lattice: Lattice, start: int = 0) -> list[Found]:
        """All readings from a word on, the cheapest first.

        Raises:
            TooManyReadings: there are too many of its parts.
        """
        return _Chart(self, lattice).found(category, start)

    def rules(self, category: str) -> Sequence[_Rule]:
        """Those of a category; none for a word's."""
        return self._rules.get(category, ())

    def first(self, category: str) -> frozenset[str]:
        """The kinds of word that something can begin with."""
        if category not in self._first:
            if category not in self._rules:
                return frozenset((category,))
            self._first[category] = frozenset()  # it does not begin with itself
            kinds: set[str] = set()
            for rule in self._rules[category]:
                for part in rule.parts:
                    kinds |= self.first(part.category)
                    if not part.optional:
                        break
            self._first[category] = frozenset(kinds)
        return self._first[category]

    def literals(self) -> frozenset[str]:
        """The words that rules name in quotes."""
        return frozenset(
            part.category.strip("'")
            for rules in self._rules.values()
            for rule in rules
            for part in rule.parts
            if part.category.startswith("'")
        )


def _part(text: str) -> _Part:
    argument, _, category = text.rpartition(":")
    mark = category[-1] if category[-1] in "?+*" else ""
    return _Part(category.rstrip("?+*"), argument, mark in ("?", "*"), mark in ("+", "*"))


class _Chart:
    def __init__(self, grammar: Grammar, lattice: Lattice) -> None:
        self._grammar = grammar
        self._lattice = lattice
        self._known: dict[tuple[str, int], list[Found]] = {}
        self._left = _MOST

    def found(self, category: str, start: int) -> list[Found]:
        key = (category, start)
        if key not in self._known:
            self._known[key] = []
            self._known[key] = self._search(category, start)
        return self._known[key]

    def _search(self, category: str, start: int) -> list[Found]:
        here = self._lattice[start] if start < len(self._lattice) else {}
        rules = self._grammar.rules(category)
        if not rules:
            return list(here.get(category, ()))
        if self._grammar.first(category).isdisjoint(here):
            return []
        best: dict[tuple[int, Hashable], float] = {}
        last = category in self._grammar.last
        for rule in rules:
            for end, values, cost in self._sequence(rule.parts, start):
                self._left -= 1
                if self._left < 0:
                    raise TooManyReadings
                if last and end != len(self._lattice):
                    continue
                meaning = rule.build(**values)
                if meaning is None:
                    continue
                total = cost + rule.cost
                if total < best.get((end, meaning), 1e9):
                    best[end, meaning] = total
        kept: dict[int, int] = {}
        result = []
        for (end, meaning), cost in sorted(best.items(), key=lambda item: item[1]):
            kept[end] = kept.get(end, 0) + 1
            if kept[end] <= _KEPT:
                result.append((end, meaning, cost))
        return result

    def _sequence(
        self, parts: Sequence[_Part], start: int
    ) -> Iterator[tuple[int, dict[str, Any], float]]:
        """The ways to read the parts of a rule one behind the other."""
        if not parts:
            yield start, {}, 0.0
            return
        part, rest = parts[0], parts[1:]
        for end, value, cost in self._one(part, start):
            for last, values, more in self._sequence(rest, end):
                if part.argument:
                    values = {**values, part.argument: value}
                yield last, values, cost + more

    def _one(self, part: _Part, start: int) -> Iterator[tuple[int, Any, float]]:
        if part.optional:
            yield start, () if part.repeated else None, 0.0
        for end, value, cost in self.found(part.category, start):
            if not part.repeated:
                yield end, value, cost
                continue
            again = _Part(part.category, part.argument, True, True)
            for last, values, more in self._one(again, end):
                yield last, (value, *values), cost + more
