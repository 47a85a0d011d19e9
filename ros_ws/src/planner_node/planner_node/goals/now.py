# SPDX-License-Identifier: Apache-2.0
"""What is meant by how the blocks stand now: "the top one", "the other stack", "swap them"."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass

from scene_graph import (
    ABOVE,
    NOT,
    UP,
    Relation,
    Rows,
    Stacks,
    base_index,
    base_name,
    spots_of,
    up_relations,
)

from ..errors import AmbiguousObjectError, InvalidGoalError, UnknownObjectError
from .parsed import Changed
from .terms import Described, Term, Words

#: Finds the names that a term means.
Resolve = Callable[[Term], tuple[str, ...]]


@dataclass(frozen=True)
class Now:
    """How the blocks stand, and how to find those that words name."""

    stacks: Stacks
    rows: Rows
    resolve: Resolve

    def described(self, term: Term, fitting: Callable[[], Sequence[str]]) -> tuple[str, ...]:
        """Those of which what is described is true; one but for "an empty stack".

        Args:
            fitting: all that the words of the term fit.

        Raises:
            UnknownObjectError: it is true of none.
            AmbiguousObjectError: it is true of several.
        """
        said = term.described
        assert said is not None
        if said.place:
            return self._place(term, said)
        if said.how == "related":
            found = self._related(said, fitting())
        elif said.how == "below":
            (name,) = self._names(said)
            found = [self._support(name)]
        else:
            found = self._at_end(said)
        return (_only(found, term.words, "block"),)

    def _names(self, said: Described) -> list[str]:
        return [name for one in said.others for name in self.resolve(one)]

    def _related(self, said: Described, fitting: Sequence[str]) -> list[str]:
        spots, phrase = spots_of(self.stacks, self.rows.spot), said.phrase
        assert phrase is not None
        found = []
        for name in fitting:
            pairs = [(name, other) for other in self._names(said)]
            if phrase.inverse:
                pairs = [(other, one) for one, other in pairs]
            if all(one != other and phrase.predicate.holds(spots[one], spots[other])
                   for one, other in pairs):  # fmt: skip
                found.append(name)
        return found

    def _at_end(self, said: Described) -> list[str]:
        end = -1 if said.how == "top" else 0
        if said.others:
            places = [self._index(name) for name in self._names(said)]
            return [self.stacks[place][end] for place in places if self.stacks[place]]
        towers = [stack for stack in self.stacks if len(stack) > 1]
        return [stack[end] for stack in towers or [stack for stack in self.stacks if stack]]

    def _place(self, term: Term, said: Described) -> tuple[str, ...]:
        heights = [len(stack) for stack in self.stacks]
        places: list[int] = []
        if said.how in ("tallest", "shortest"):
            wanted = max(heights) if said.how == "tallest" else min(heights)
            places = [index for index, height in enumerate(heights) if height == wanted]
        elif said.how == "empty":
            places = [index for index, height in enumerate(heights) if not height]
            if places and term.least == 1 and term.kind.name == "COUNT":
                return tuple(map(base_name, places))
        elif said.how == "with":
            places = sorted({self._index(name) for name in self._names(said)})
            if len(places) > 1:
                places = []
        elif said.how == "other":
            own = {self._index(name) for name in self._names(said)}
            places = [index for index in range(len(self.stacks)) if index not in own]
        return (_only([base_name(index) for index in places], term.words, "place"),)

    def _index(self, name: str) -> int:
        """The place of a block, or a place itself."""
        base = base_index(name)
        if base is not None:
            return base
        return next(index for index, stack in enumerate(self.stacks) if name in stack)

    def _support(self, name: str) -> str:
        index = self._index(name)
        level = self.stacks[index].index(name)
        return self.stacks[index][level - 1] if level else base_name(index)

    def changed(self, change: Changed, moved: frozenset[str]) -> Iterator[Relation]:
        """The relations of the state that a change asks for.

        Args:
            moved: of whom something else is asked.
        """
        names = [name for term in change.terms for name in self.resolve(term)]
        words = change.words
        if change.kind == "same":
            for relation in sorted(up_relations(self.stacks)):
                if relation.subject not in moved:
                    yield relation
        elif change.kind == "keep":
            for name in names:
                yield from self._kept(name)
        elif change.kind == "swap":
            if len(names) != 2 or (base_index(names[0]) is None) != (base_index(names[1]) is None):
                raise InvalidGoalError(
                    "two blocks or two places can be exchanged", words.offset, words.text
                )
            yield from sorted(up_relations(self._swapped(*names)))
        elif change.kind == "turn":
            yield from sorted(up_relations(self._turned(names, words)))
        else:
            yield from self._shifted(names, change)

    def _kept(self, name: str) -> Iterator[Relation]:
        index = base_index(name)
        if index is None:
            yield Relation(name, UP, self._support(name))
            return
        yield from (
            relation
            for relation in sorted(up_relations(self.stacks))
            if relation.subject in self.stacks[index]
        )
        for other in sorted(other for stack in self.stacks for other in stack):
            if other not in self.stacks[index]:
                yield Relation(other, NOT + ABOVE, name)

    def _swapped(self, one: str, other: str) -> Stacks:
        first, second = base_index(one), base_index(other)
        if first is not None and second is not None:
            stacks = list(self.stacks)
            stacks[first], stacks[second] = stacks[second], stacks[first]
            return tuple(stacks)
        exchanged = {one: other, other: one}
        return tuple(tuple(exchanged.get(name, name) for name in stack) for stack in self.stacks)

    def _turned(self, names: Sequence[str], words: Words) -> Stacks:
        towers = [index for index, stack in enumerate(self.stacks) if len(stack) > 1]
        if names:
            towers = [self._index(name) for name in names]
        wanted = _only([base_name(index) for index in towers], words, "place")
        return tuple(
            stack[::-1] if base_name(index) == wanted else stack
            for index, stack in enumerate(self.stacks)
        )

    def _shifted(self, names: Sequence[str], change: Changed) -> Iterator[Relation]:
        for name in names:
            index = self._index(name) + change.steps
            if base_index(name) is not None or not 0 <= index < len(self.stacks):
                raise InvalidGoalError(
                    f"there is no place {abs(change.steps)} further for {name}",
                    change.words.offset,
                    change.words.text,
                )
            yield Relation(name, ABOVE, base_name(index))


def _only(found: Sequence[str], words: Words, kind: str) -> str:
    if len(found) == 1:
        return found[0]
    if not found:
        raise UnknownObjectError(
            words.text, (), f"at offset {words.offset}: no {kind} is like that now; name it"
        )
    raise AmbiguousObjectError(
        words.text,
        found,
        f"at offset {words.offset}: now that may be {', '.join(found)}; say which",
    )


def needs_state(words: Words) -> InvalidGoalError:
    """The error of a goal that depends on how the blocks stand where that is not known."""
    return InvalidGoalError(
        "this depends on how the blocks stand now, which is not known here; name blocks and places",
        words.offset,
        words.text,
    )
