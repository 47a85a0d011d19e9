# SPDX-License-Identifier: Apache-2.0
"""Goals as people type them: "put red on blue, the green box left of red and cyan on stack 2".

Parsing needs no scene, so that a goal that makes no sense is refused before anything else happens;
:mod:`planner_node.goals.resolve` then finds the objects that its names mean. Every way to write a
relation comes from :data:`scene_graph.PREDICATES`.
"""

from __future__ import annotations

import re
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass
from typing import Final

from scene_graph import PREDICATES, Phrase, base_name

from ..errors import InvalidGoalError

#: Words that may stand in front of a name or a predicate and mean nothing.
FILLERS: Final = frozenset({"the", "is"})
#: Verbs that a relation may start with; the second kind are nouns too, as in "stack 2 below red".
VERBS: Final = frozenset({"put", "move"})
NOUN_VERBS: Final = frozenset({"place", "stack"})
POLITE: Final = "please"
EXAMPLE: Final = "write relations like 'red on blue, green left of red'"

_TOKEN: Final = re.compile(r"(?P<word>[^\W_][\w-]*)|(?P<separator>[,;])|(?P<other>\S)")
_BASE: Final = re.compile(r"stack[ _]?(\d+)")
_Phrases = Mapping[tuple[str, ...], Phrase]


@dataclass(frozen=True)
class Words:
    """Some words of the goal in lower case, and where they start, counted from 0."""

    text: str
    offset: int

    @property
    def base(self) -> str | None:
        """The name of the base that is meant, or None where it is a block."""
        match = _BASE.fullmatch(self.text)
        return base_name(int(match[1])) if match else None


@dataclass(frozen=True)
class ParsedRelation:
    """A relation whose names are not yet resolved; subject and object as they were written."""

    subject: Words
    phrase: Phrase
    object: Words


@dataclass(frozen=True)
class _Found:
    """A phrase in a clause: its words from ``first`` to before ``last``."""

    first: int
    last: int
    phrase: Phrase


def parse_goal(text: str) -> tuple[ParsedRelation, ...]:
    """Splits a goal into relations at commas, semicolons and "and".

    Raises:
        InvalidGoalError: if the goal is empty, or a part of it is not a relation.
    """
    phrases = PREDICATES.phrases
    relations = tuple(_parse_relation(text, clause, phrases) for clause in _clauses(text))
    if not relations:
        raise InvalidGoalError(f"the goal is empty; {EXAMPLE}")
    return relations


def _clauses(text: str) -> Iterator[list[Words]]:
    """The words of each relation; empty ones, as between ", and", are left out."""
    words: list[Words] = []
    for match in _TOKEN.finditer(text):
        if match["other"]:
            raise InvalidGoalError("unexpected character", match.start(), match["other"])
        if match["word"] and match["word"].lower() != "and":
            words.append(Words(match["word"].lower(), match.start()))
        elif words:
            yield words
            words = []
    if words:
        yield words


def _parse_relation(text: str, words: list[Words], phrases: _Phrases) -> ParsedRelation:
    start, end = words[0].offset, _end(words)
    words = _without_verb(words, phrases)
    found = list(_find(words, phrases))
    if not found:
        known = ", ".join(_known())
        raise InvalidGoalError(
            f"no relation found; known are {known}; {EXAMPLE}", start, text[start:end]
        )
    if len(found) > 1:
        second = words[found[1].first].offset
        raise InvalidGoalError(
            "a second relation starts here; separate relations by a comma or 'and'",
            second,
            text[second:end],
        )
    written = words[found[0].first : found[0].last]
    start, end = written[0].offset, _end(written)
    subject, object_ = _name(words[: found[0].first]), _name(words[found[0].last :])
    if subject is None or object_ is None:
        side = "before" if subject is None else "after"
        raise InvalidGoalError(f"there is no block {side} this", start, text[start:end])
    phrase = found[0].phrase
    _check_bases(subject, phrase, object_, " ".join(word.text for word in written))
    return ParsedRelation(subject, phrase, object_)


def _without_verb(words: list[Words], phrases: _Phrases) -> list[Words]:
    """The words of a clause without "please" and a verb in front."""
    if words[0].text == POLITE:
        words = words[1:]
    if not words:
        return words
    verb, rest = words[0].text, words[1:]
    names_a_place = not rest or rest[0].text.isdigit() or _starts_with(rest, phrases)
    is_verb = verb in VERBS or (verb in NOUN_VERBS and not names_a_place)
    return rest if is_verb else words


def _starts_with(words: Sequence[Words], phrases: _Phrases) -> bool:
    """Whether a phrase stands in front; fillers before it count for nothing."""
    kept = tuple(word.text for word in words if word.text not in FILLERS)
    return any(kept[: len(phrase)] == phrase for phrase in phrases)


def _end(words: Sequence[Words]) -> int:
    return words[-1].offset + len(words[-1].text)


def _find(words: Sequence[Words], phrases: _Phrases) -> Iterator[_Found]:
    """Every phrase among the words; the longest that fits is taken."""
    longest = max(map(len, phrases), default=0)
    texts = tuple(word.text for word in words)
    index = 0
    while index < len(words):
        for last in range(min(index + longest, len(words)), index, -1):
            if phrase := phrases.get(texts[index:last]):
                yield _Found(index, last, phrase)
                index = last
                break
        else:
            index += 1


def _name(words: Sequence[Words]) -> Words | None:
    kept = [word for word in words if word.text not in FILLERS]
    return Words(" ".join(word.text for word in kept), kept[0].offset) if kept else None


def _known() -> Iterator[str]:
    """One way to write each relation, its inverse, and its form for places."""
    for name in PREDICATES:
        predicate = PREDICATES[name]
        for ways in (predicate.phrases, predicate.inverse_phrases, predicate.place_phrases):
            yield from ways[:1]


def _check_bases(subject: Words, phrase: Phrase, object_: Words, written: str) -> None:
    if phrase.needs_place and object_.base is None:
        raise InvalidGoalError(
            f"'{written}' needs a place, such as stack0; "
            f"use '{phrase.predicate.words}' for a block",
            object_.offset,
            object_.text,
        )
    if not phrase.predicate.takes_place:
        for words in (subject, object_):
            if words.base is not None:
                fitting = [
                    f"'{PREDICATES[name].words}'"
                    for name in PREDICATES
                    if PREDICATES[name].takes_place and PREDICATES[name].phrases
                ]
                raise InvalidGoalError(
                    f"'{written}' relates two blocks; use {' or '.join(fitting)} for a place",
                    words.offset,
                    words.text,
                )
