# SPDX-License-Identifier: Apache-2.0
"""Goals as people type them: "red on blue, the green box left of red and cyan on stack 2".

Parsing needs no scene, so that a goal that makes no sense is refused before anything else happens;
resolving then finds the objects that its names mean.
"""

from __future__ import annotations

import difflib
import re
from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from typing import Final

from scene_graph import base_name

from .errors import AmbiguousObjectError, InvalidGoalError, UnknownObjectError
from .goals import ABOVE, LEFT_OF, ON, Goal, GoalRelation

RIGHT_OF: Final = "right of"
IN: Final = "in"

#: Every way to write a predicate, as words; the longest that fits is taken.
PHRASES: Final[dict[tuple[str, ...], str]] = {
    ("on", "top", "of"): ON,
    ("on",): ON,
    ("up",): ON,
    ("above",): ABOVE,
    ("in",): IN,
    ("to", "the", "left", "of"): LEFT_OF,
    ("left", "of"): LEFT_OF,
    ("left",): LEFT_OF,
    ("to", "the", "right", "of"): RIGHT_OF,
    ("right", "of"): RIGHT_OF,
    ("right",): RIGHT_OF,
}
#: Words that may stand in front of a name or a predicate and mean nothing.
FILLERS: Final = frozenset({"the", "is"})
#: Words that fit every object.
NOUNS: Final = frozenset({"block", "object"})
EXAMPLE: Final = "write relations like 'red on blue, green left of red'"

_TOKEN: Final = re.compile(r"(?P<word>[^\W_][\w-]*)|(?P<separator>[,;])|(?P<other>\S)")
_BASE: Final = re.compile(r"stack[ _]?(\d+)")


@dataclass(frozen=True)
class Phrase:
    """Some words of the goal in lower case, and where they start, counted from 0."""

    text: str
    offset: int


@dataclass(frozen=True)
class ParsedRelation:
    """A relation whose names are not yet resolved; ``predicate`` is one of the four."""

    subject: Phrase
    predicate: str
    object: Phrase


def parse_goal(text: str) -> tuple[ParsedRelation, ...]:
    """Splits a goal into relations at commas, semicolons and "and".

    Raises:
        InvalidGoalError: if the goal is empty, or a part of it is not a relation.
    """
    relations = tuple(_parse_relation(text, clause) for clause in _clauses(text))
    if not relations:
        raise InvalidGoalError(f"the goal is empty; {EXAMPLE}")
    return relations


def resolve_goal(parsed: Sequence[ParsedRelation], names: Sequence[str]) -> Goal:
    """Finds the objects that the names of a parsed goal mean; repeated relations count once.

    Raises:
        UnknownObjectError: if a name fits no object of the scene.
        AmbiguousObjectError: if a name fits several.
    """
    relations: dict[GoalRelation, None] = {}
    for item in parsed:
        subject, object_ = resolve_name(item.subject, names), resolve_name(item.object, names)
        if item.predicate == RIGHT_OF:
            relation = GoalRelation(object_, LEFT_OF, subject)
        elif item.predicate == IN:
            relation = GoalRelation(subject, ABOVE, object_)
        else:
            relation = GoalRelation(subject, item.predicate, object_)
        relations[relation] = None
    return Goal(tuple(relations))


def resolve_name(phrase: Phrase, names: Sequence[str]) -> str:
    """The object or base that a phrase means: a full name, or any unambiguous part of one.

    Raises:
        UnknownObjectError, AmbiguousObjectError: see :func:`resolve_goal`.
    """
    base = _base(phrase)
    if base is not None:
        return base
    words = re.split(r"[ _]+", phrase.text)
    by_full_name = {name.lower(): name for name in names}
    full_name = "_".join(words)
    if full_name in by_full_name:
        return by_full_name[full_name]
    wanted = set(words) - NOUNS
    candidates = sorted(name for name in names if wanted <= set(name.lower().split("_")))
    if len(candidates) == 1:
        return candidates[0]
    where = f"at offset {phrase.offset}"
    if candidates:
        raise AmbiguousObjectError(
            phrase.text,
            candidates,
            f"{where}: '{phrase.text}' fits {', '.join(candidates)}; say which",
        )
    known = sorted(names)
    listed = f"the scene has {', '.join(known)}" if known else "the scene has no objects"
    parts = {part for name in by_full_name for part in name.split("_")}
    close = difflib.get_close_matches(full_name, [*by_full_name, *sorted(parts)], n=1)
    hint = f"; did you mean '{close[0]}'?" if close else ""
    raise UnknownObjectError(
        phrase.text, known, f"{where}: there is no '{phrase.text}'; {listed}{hint}"
    )


def _clauses(text: str) -> Iterator[list[Phrase]]:
    """The words of each relation; empty ones, as between ", and", are left out."""
    words: list[Phrase] = []
    for match in _TOKEN.finditer(text):
        if match["other"]:
            raise InvalidGoalError("unexpected character", match.start(), match["other"])
        if match["word"] and match["word"].lower() != "and":
            words.append(Phrase(match["word"].lower(), match.start()))
        elif words:
            yield words
            words = []
    if words:
        yield words


def _parse_relation(text: str, words: list[Phrase]) -> ParsedRelation:
    start, end = words[0].offset, words[-1].offset + len(words[-1].text)
    clause = text[start:end]
    found = list(_predicates(words))
    if not found:
        raise InvalidGoalError(
            "no relation found; known are on, above, up, in, left of and right of; " + EXAMPLE,
            start,
            clause,
        )
    if len(found) > 1:
        second = words[found[1][0]]
        raise InvalidGoalError(
            "a second relation starts here; separate relations by a comma or 'and'",
            second.offset,
            text[second.offset : end],
        )
    first, last, predicate = found[0]
    subject = _name(words[:first])
    object_ = _name(words[last:])
    if subject is None or object_ is None:
        start, end = words[first].offset, words[last - 1].offset + len(words[last - 1].text)
        side = "before" if subject is None else "after"
        raise InvalidGoalError(f"there is no block {side} this", start, text[start:end])
    _check_bases(subject, predicate, object_)
    return ParsedRelation(subject, predicate, object_)


def _predicates(words: Sequence[Phrase]) -> Iterator[tuple[int, int, str]]:
    """First word, word after the last, and meaning of every predicate phrase."""
    index = 0
    texts = tuple(word.text for word in words)
    while index < len(words):
        for length in range(min(4, len(words) - index), 0, -1):
            predicate = PHRASES.get(texts[index : index + length])
            if predicate:
                yield index, index + length, predicate
                index += length
                break
        else:
            index += 1


def _name(words: Sequence[Phrase]) -> Phrase | None:
    kept = [word for word in words if word.text not in FILLERS]
    return Phrase(" ".join(word.text for word in kept), kept[0].offset) if kept else None


def _base(phrase: Phrase) -> str | None:
    match = _BASE.fullmatch(phrase.text)
    return base_name(int(match[1])) if match else None


def _check_bases(subject: Phrase, predicate: str, object_: Phrase) -> None:
    base = _base(object_)
    if predicate == IN and base is None:
        raise InvalidGoalError(
            "'in' needs a place, such as stack0; use 'on' or 'above' for a block",
            object_.offset,
            object_.text,
        )
    if predicate in (LEFT_OF, RIGHT_OF):
        for phrase in (subject, object_):
            if _base(phrase) is not None:
                raise InvalidGoalError(
                    "left of and right of relate two blocks; use 'in' or 'on' for a place",
                    phrase.offset,
                    phrase.text,
                )
