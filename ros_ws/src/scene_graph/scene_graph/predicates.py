# SPDX-License-Identifier: Apache-2.0
"""Predicates: what a relation can say, in code, in words, and in a state.

A new predicate is one entry of :data:`PREDICATES`: goals are parsed with its phrases, searched for
and checked with its meaning, and printed with its first phrase.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator
from dataclasses import dataclass
from typing import Final, NamedTuple

UP: Final = "up"
ABOVE: Final = "above"
LEFT: Final = "left"
FRONT: Final = "front"


class Spot(NamedTuple):
    """Where something is in a state: its stack, from 0, and its level there; a base's is -1."""

    stack: int
    level: int


@dataclass(frozen=True)
class Predicate:
    """One kind of relation between a subject and an object.

    Attributes:
        name: the one word that code and messages use.
        holds: the meaning: whether it is true of a subject and an object at these spots.
        phrases: how people write it; the first is how they are told. None: it is not asked for.
        inverse_phrases: how people write it with subject and object exchanged.
        place_phrases: further phrases, whose object has to be a place.
        takes_place: whether the object may be a place (its base).
    """

    name: str
    holds: Callable[[Spot, Spot], bool]
    phrases: tuple[str, ...] = ()
    inverse_phrases: tuple[str, ...] = ()
    place_phrases: tuple[str, ...] = ()
    takes_place: bool = True

    @property
    def words(self) -> str:
        """How people are told, such as "on"."""
        return self.phrases[0] if self.phrases else self.name


class Phrase(NamedTuple):
    """One way to write a predicate.

    Attributes:
        predicate: what it means.
        inverse: whether subject and object are exchanged.
        needs_place: whether the object has to be a place.
    """

    predicate: Predicate
    inverse: bool = False
    needs_place: bool = False


class Predicates:
    """The known predicates by name; iterates over names in the order they were added."""

    def __init__(self, *predicates: Predicate) -> None:
        self._by_name: dict[str, Predicate] = {}
        self._phrases: dict[tuple[str, ...], Phrase] = {}
        for predicate in predicates:
            self.add(predicate)

    def __getitem__(self, name: str) -> Predicate:
        return self._by_name[name]

    def __contains__(self, name: object) -> bool:
        return name in self._by_name

    def __iter__(self) -> Iterator[str]:
        return iter(self._by_name)

    @property
    def phrases(self) -> dict[tuple[str, ...], Phrase]:
        """Every way to write a predicate, as words; a fresh mapping."""
        return dict(self._phrases)

    def add(self, predicate: Predicate) -> None:
        """Makes a predicate known everywhere.

        Raises:
            ValueError: its name or one of its phrases is taken.
        """
        if predicate.name in self._by_name:
            raise ValueError(f"there is a predicate {predicate.name!r} already")
        new: dict[tuple[str, ...], Phrase] = {}
        for texts, phrase in (
            (predicate.phrases, Phrase(predicate)),
            (predicate.inverse_phrases, Phrase(predicate, inverse=True)),
            (predicate.place_phrases, Phrase(predicate, needs_place=True)),
        ):
            new |= {tuple(text.split()): phrase for text in texts}
        if taken := sorted(" ".join(words) for words in new.keys() & self._phrases.keys()):
            raise ValueError(f"the phrase {taken[0]!r} has a meaning already")
        self._by_name[predicate.name] = predicate
        self._phrases |= new

    def remove(self, name: str) -> None:
        """Forgets a predicate; raises KeyError for an unknown name."""
        predicate = self._by_name.pop(name)
        self._phrases = {
            words: phrase
            for words, phrase in self._phrases.items()
            if phrase.predicate is not predicate
        }


#: The predicates of 3.2 and of goals. ``front`` is true of nothing as long as there is one row.
PREDICATES: Final = Predicates(
    Predicate(
        UP,
        lambda subject, object_: (
            subject.stack == object_.stack and subject.level == object_.level + 1
        ),
        phrases=("on", "on top of", "up"),
    ),
    Predicate(
        ABOVE,
        lambda subject, object_: subject.stack == object_.stack and subject.level > object_.level,
        phrases=("above",),
        inverse_phrases=("below",),
        place_phrases=("in",),
    ),
    Predicate(
        LEFT,
        lambda subject, object_: subject.stack < object_.stack,
        phrases=("left of", "to the left of", "left"),
        inverse_phrases=("right of", "to the right of", "right"),
        takes_place=False,
    ),
    Predicate(FRONT, lambda _subject, _object: False, takes_place=False),
)
