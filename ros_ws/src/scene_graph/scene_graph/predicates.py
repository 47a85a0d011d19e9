# SPDX-License-Identifier: Apache-2.0
"""Predicates: what a relation can say, in code, in words, and in a state.

A new predicate is one entry of :data:`PREDICATES`: goals are parsed with its phrases, searched for
and checked with its meaning, and printed with its first phrase. It brings its negation, whose name
is ``not_`` and its own.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator
from dataclasses import dataclass
from typing import Final, NamedTuple

UP: Final = "up"
ABOVE: Final = "above"
LEFT: Final = "left"
BESIDE: Final = "beside"
FRONT: Final = "front"
#: In front of a predicate's name, its negation.
NOT: Final = "not_"


class Spot(NamedTuple):
    """Where something is in a state.

    Attributes:
        stack: from 0.
        level: in its stack; a base's is -1.
        row: of its place, 0 for the one that is nearest to the camera.
        rank: of its place from the left among those of all rows; None: that of its index.
    """

    stack: int
    level: int
    row: int = 0
    rank: int | None = None

    @property
    def column(self) -> int:
        """How far right its place is; places of equal columns lie one behind the other."""
        return self.stack if self.rank is None else self.rank


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
    """The known predicates by name; iterates over those added, in their order, without negations.

    Every predicate that is added brings its negation, whose name starts with :data:`NOT`.
    """

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
        return (name for name in self._by_name if not name.startswith(NOT))

    def negation(self, predicate: Predicate) -> Predicate:
        """The one that is true where ``predicate`` is not."""
        return self._by_name[NOT + predicate.name]

    @property
    def phrases(self) -> dict[tuple[str, ...], Phrase]:
        """Every way to write a predicate, as words; a fresh mapping."""
        return dict(self._phrases)

    def add(self, predicate: Predicate) -> None:
        """Makes a predicate known everywhere.

        Raises:
            ValueError: its name or one of its phrases is taken, or its name is that of a negation.
        """
        if predicate.name in self._by_name:
            raise ValueError(f"there is a predicate {predicate.name!r} already")
        if predicate.name.startswith(NOT):
            raise ValueError(f"{predicate.name!r} is a negation; every predicate brings its own")
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
        self._by_name[NOT + predicate.name] = Predicate(
            NOT + predicate.name,
            lambda subject, object_: not predicate.holds(subject, object_),
            phrases=(f"not {predicate.words}",),
            takes_place=predicate.takes_place,
        )
        self._phrases |= new

    def remove(self, name: str) -> None:
        """Forgets a predicate; raises KeyError for an unknown name."""
        predicate = self._by_name.pop(name)
        del self._by_name[NOT + name]
        self._phrases = {
            words: phrase
            for words, phrase in self._phrases.items()
            if phrase.predicate is not predicate
        }


#: The predicates of 3.2 and of goals. ``front`` is true of nothing where there is one row. The word
#: "the" is not part of a phrase: goals are read without it.
PREDICATES: Final = Predicates(
    Predicate(
        UP,
        lambda subject, object_: (
            subject.stack == object_.stack and subject.level == object_.level + 1
        ),
        phrases=(
            "on", "on top of", "on top", "up", "onto", "on to", "onto top of", "upon", "atop",
            "atop of", "over top of", "directly on", "directly on top of", "directly onto",
            "directly above", "directly over", "right on top of", "immediately above",
            "immediately on top of", "straight on top of",
        ),
        inverse_phrases=(
            "directly below", "directly under", "directly underneath", "directly beneath",
            "immediately below", "immediately under", "right under", "right below",
            "right underneath", "right beneath", "supports", "carries",
        ),
        place_phrases=("at bottom of", "at very bottom of"),
    ),
    Predicate(
        ABOVE,
        lambda subject, object_: subject.stack == object_.stack and subject.level > object_.level,
        phrases=("above", "over", "somewhere above"),
        inverse_phrases=("below", "under", "underneath", "beneath", "somewhere below"),
        place_phrases=("in", "into", "inside", "to", "at", "within"),
    ),
    Predicate(
        LEFT,
        lambda subject, object_: subject.column < object_.column,
        phrases=(
            "left of", "to left of", "left", "on left of", "at left of", "on left side of",
            "to left side of", "somewhere left of", "somewhere to left of", "left from",
            "further left than", "in a stack further left than",
        ),
        inverse_phrases=(
            "right of", "to right of", "right", "on right of", "at right of", "on right side of",
            "to right side of", "somewhere right of", "somewhere to right of", "right from",
            "further right than", "in a stack further right than",
        ),
        takes_place=False,
    ),
    Predicate(
        FRONT,
        lambda subject, object_: subject.row < object_.row,
        phrases=(
            "in front of", "in front", "front", "front of", "to front of", "somewhere in front of",
            "nearer than", "closer than", "in a stack in front of",
        ),
        inverse_phrases=("behind", "to back of", "somewhere behind", "in a stack behind"),
        takes_place=False,
    ),
    Predicate(
        BESIDE,
        lambda subject, object_: (
            subject.row == object_.row and abs(subject.stack - object_.stack) == 1
        ),
        phrases=("next to", "right next to", "directly next to", "beside", "right beside",
                 "adjacent to", "neighbouring"),
        takes_place=False,
    ),
)  # fmt: skip
