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
from dataclasses import dataclass, field
from math import inf
from typing import Any, Final

#: How many meanings of a category between two words are kept.
_KEPT: Final = 6

#: How many meanings are built before it is given up: a long text that may be read in many ways.
_MOST: Final = 40_000

#: Up to how many words all readings are looked for at once, and what those of more words may cost
#: before dearer ones are looked for.
_SHORT: Final = 24
_BOUNDS: Final = (1.5, 4.0, inf)

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


@dataclass
class _Node:
    """Rules that begin alike: what may follow, and what has been read where one ends here.

    Attributes:
        next: by part that follows.
        built: the functions of the rules that end here, and what they cost.
    """

    next: dict[_Part, _Node] = field(default_factory=dict)
    built: list[tuple[Callable[..., Any], float]] = field(default_factory=list)


class Grammar:
    """Rules by category.

    Args:
        last: categories that are looked for only where they reach to the end.
    """

    def __init__(self, last: Collection[str] = ()) -> None:
        self.last = frozenset(last)
        self._rules: dict[str, _Node] = {}
        self._first: dict[str, frozenset[str]] = {}

    def add(self, category: str, side: str, build: Callable[..., Any], cost: float = 0.0) -> None:
        """Adds a rule, with the function that builds its meaning."""
        node = self._rules.setdefault(category, _Node())
        for part in map(_part, side.split()):
            node = node.next.setdefault(part, _Node())
        node.built.append((build, cost))
        self._first.clear()

    def parses(self, category: str, lattice: Lattice, apart: float) -> list[Found]:
        """All readings of the whole that cost at most so much more than the cheapest.

        Raises:
            TooManyReadings: there are too many of its parts.
        """
        for bound in _BOUNDS if len(lattice) > _SHORT else (inf,):
            chart = _Chart(self, lattice, bound)
            found = [one for one in chart.found(category, 0) if one[0] == len(lattice)]
            # No part of a reading costs more than the whole: none is missing below the bound. In
            # a text of many parts that cost a little each, none of them costs more than the last.
            if found and (found[0][2] + apart <= bound or bound == _BOUNDS[-2]):
                break
        return found

    def rules(self, category: str) -> _Node | None:
        """Those of a category; None for a word's."""
        return self._rules.get(category)

    def first(self, category: str) -> frozenset[str]:
        """The kinds of word that something can begin with."""
        if category not in self._first:
            if category not in self._rules:
                return frozenset((category,))
            self._first[category] = frozenset()  # it does not begin with itself
            self._first[category] = frozenset(self._beginnings(self._rules[category]))
        return self._first[category]

    def _beginnings(self, node: _Node) -> Iterator[str]:
        for part, after in node.next.items():
            yield from self.first(part.category)
            if part.optional:
                yield from self._beginnings(after)

    def literals(self) -> frozenset[str]:
        """The words that rules name in quotes."""
        nodes, found = list(self._rules.values()), set()
        while nodes:
            for part, after in nodes.pop().next.items():
                nodes.append(after)
                if part.category.startswith("'"):
                    found.add(part.category.strip("'"))
        return frozenset(found)


def _part(text: str) -> _Part:
    argument, _, category = text.rpartition(":")
    mark = category[-1] if category[-1] in "?+*" else ""
    return _Part(category.rstrip("?+*"), argument, mark in ("?", "*"), mark in ("+", "*"))


class _Chart:
    def __init__(self, grammar: Grammar, lattice: Lattice, bound: float) -> None:
        self._grammar = grammar
        self._lattice = lattice
        self._bound = bound
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
        if rules is None:
            return list(here.get(category, ()))
        if self._grammar.first(category).isdisjoint(here):
            return []
        best: dict[tuple[int, Hashable], float] = {}
        last = category in self._grammar.last
        for end, node, values, cost in self._sequences(
            rules, start, {}, 0.0, inf if last else self._bound
        ):
            self._left -= 1
            if self._left < 0:
                raise TooManyReadings
            if last and end != len(self._lattice):
                continue
            for build, more in node.built:
                meaning = build(**values)
                if meaning is not None and cost + more < best.get((end, meaning), inf):
                    best[end, meaning] = cost + more
        kept: dict[int, int] = {}
        result = []
        for (end, meaning), cost in sorted(best.items(), key=lambda item: item[1]):
            kept[end] = kept.get(end, 0) + 1
            if kept[end] <= _KEPT:
                result.append((end, meaning, cost))
        return result

    def _sequences(
        self, node: _Node, start: int, values: Mapping[str, Any], cost: float, bound: float
    ) -> Iterator[tuple[int, _Node, Mapping[str, Any], float]]:
        """The ways to read the parts of rules one behind the other; what they share only once."""
        if node.built:
            yield start, node, values, cost
        for part, after in node.next.items():
            for end, value, more in self._one(part, start):
                if cost + more > bound:
                    continue
                known = {**values, part.argument: value} if part.argument else values
                yield from self._sequences(after, end, known, cost + more, bound)

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
