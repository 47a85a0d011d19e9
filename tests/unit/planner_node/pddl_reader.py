# SPDX-License-Identifier: Apache-2.0
"""A small planner for PDDL that knows nothing of blocks: what a file says is what it does."""

from __future__ import annotations

import re
from collections import defaultdict
from collections.abc import Iterator
from heapq import heappop, heappush
from typing import Any

Atom = tuple[str, ...]


def parsed(text: str) -> Any:
    """Nested lists of words."""
    tokens = re.findall(r"[()]|[^\s()]+", re.sub(";.*", "", text.lower()))

    def read() -> Any:
        token = tokens.pop(0)
        if token != "(":
            return token
        items = []
        while tokens[0] != ")":
            items.append(read())
        tokens.pop(0)
        return items

    return read()


def typed(words: list[str]) -> list[tuple[str, str]]:
    """Names with their types."""
    result: list[tuple[str, str]] = []
    waiting: list[str] = []
    rest = iter(words)
    for word in rest:
        if word == "-":
            kind = next(rest)
            result += [(name, kind) for name in waiting]
            waiting = []
        else:
            waiting.append(word)
    return result + [(name, "object") for name in waiting]


class Task:
    """A domain and a problem, as they are written."""

    def __init__(self, domain: str, problem: str) -> None:
        parts = {item[0]: item for item in parsed(domain)[1:] if item[0] != ":action"}
        self.requirements = parts[":requirements"][1:]
        self._supertype = dict(typed(parts[":types"][1:]))
        self._declared = {item[0]: len(typed(item[1:])) for item in parts[":predicates"][1:]}
        self._actions = [
            (
                item[1],
                typed(item[3]),
                self._conjuncts(item[5]),
                self._conjuncts(item[7]),
            )
            for item in parsed(domain)[1:]
            if item[0] == ":action"
        ]
        told = {item[0]: item for item in parsed(problem)[1:]}
        self._kinds = dict(typed(told[":objects"][1:]) + typed(parts.get(":constants", [""])[1:]))
        facts = told[":init"][1:]
        self.start = frozenset(tuple(item) for item in facts if item[0] != "=")
        self._numbers = {tuple(item[1]): int(item[2]) for item in facts if item[0] == "="}
        self.goal = {tuple(item) for item in self._conjuncts(told[":goal"][1])}
        for fact in self.start | self.goal:
            assert len(fact) - 1 == self._declared[fact[0]], f"{fact} is not declared so"
        changing = {atom[0] for *_, effects in self._actions for atom in self._flat(effects)}
        self._static = frozenset(fact for fact in self.start if fact[0] not in changing)

    def cheapest(self) -> tuple[int, list[Atom]] | None:
        """The least cost (moves only, where there are prices) and steps; None: there is no plan."""
        start = self.start - self._static
        goal = self.goal - self._static
        queue: list[tuple[int, int, frozenset[Atom], list[Atom]]] = [(0, 0, start, [])]
        known: set[frozenset[Atom]] = set()
        count = 0
        while queue:
            cost, _, state, steps = heappop(queue)
            if state in known:
                continue
            known.add(state)
            if goal <= state:
                return cost, steps
            for step, after, price in self.following(state):
                if after not in known:
                    count += 1
                    heappush(queue, (cost + price, count, after, [*steps, step]))
        return None

    def following(self, state: frozenset[Atom]) -> Iterator[tuple[Atom, frozenset[Atom], int]]:
        """Every step that is possible, the state after it, and its cost."""
        facts: dict[str, list[Atom]] = defaultdict(list)
        for fact in (*state, *self._static):
            facts[fact[0]].append(fact)
        for name, parameters, conditions, effects in self._actions:
            for values in self._bindings(parameters, conditions, facts):
                price = 1 if not self._numbers else 0
                added, removed = set(), set()
                for effect in effects:
                    if effect[0] == "increase":
                        price = self._numbers[self._ground(effect[2], values)]
                    elif effect[0] == "not":
                        removed.add(self._ground(effect[1], values))
                    else:
                        added.add(self._ground(effect, values))
                step = (name, *(values[parameter] for parameter, _ in parameters))
                yield step, (state - removed) | added, price

    def _bindings(self, parameters: Any, conditions: Any, facts: Any) -> Iterator[dict[str, str]]:
        kinds = dict(parameters)
        atoms = [item for item in conditions if item[0] not in ("not", "or", "=")]
        others = [item for item in conditions if item[0] in ("not", "or", "=")]

        def bind(index: int, values: dict[str, str]) -> Iterator[dict[str, str]]:
            if index == len(atoms):
                assert set(values) == set(kinds), "a parameter is not bound"
                if all(self._true(item, values, facts) for item in others):
                    yield values
                return
            for fact in facts[atoms[index][0]]:
                extended = dict(values)
                for word, value in zip(atoms[index][1:], fact[1:]):
                    wanted = extended.setdefault(word, value) if word[0] == "?" else word
                    if wanted != value or not self._is(value, kinds.get(word, "object")):
                        break
                else:
                    yield from bind(index + 1, extended)

        yield from bind(0, {})

    def _true(self, condition: Any, values: dict[str, str], facts: Any) -> bool:
        if condition[0] == "or":
            return any(self._true(item, values, facts) for item in condition[1:])
        if condition[0] == "not":
            return not self._true(condition[1], values, facts)
        atom = self._ground(condition, values)
        return atom[1] == atom[2] if atom[0] == "=" else atom in facts[atom[0]]

    def _is(self, value: str, kind: str) -> bool:
        mine = self._kinds[value]
        while mine != kind and mine in self._supertype:
            mine = self._supertype[mine]
        return mine == kind or kind == "object"

    @staticmethod
    def _ground(atom: list[str], values: dict[str, str]) -> Atom:
        return tuple(values.get(word, word) for word in atom)

    @staticmethod
    def _conjuncts(condition: Any) -> Any:
        return condition[1:] if condition[0] == "and" else [condition]

    @staticmethod
    def _flat(effects: Any) -> list[Any]:
        return [item[1] if item[0] == "not" else item for item in effects]
