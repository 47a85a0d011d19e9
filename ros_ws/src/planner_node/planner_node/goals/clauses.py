# SPDX-License-Identifier: Apache-2.0
"""What one clause of a goal says by itself: its subject, its relations and their objects."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace
from typing import Final

from scene_graph import COLORS, SHAPES

from ..errors import InvalidGoalError
from .around import WANTS, asker, names_a_place, verb_at_start, without_ends
from .language import (
    BYGONE,
    CLEAR,
    IT,
    MODALS,
    MORE_COLORS,
    MUTE,
    NEGATION,
    NOUN_VERBS,
    NOUNS,
    SAME_PLACE,
    TAKES,
    meant,
)
from .orders import ORDERS
from .phrases import Found, has_phrase, phrases_in
from .plainer import plainer
from .quantities import term_of
from .said import Said, no_relation
from .terms import Kind, Words
from .unrelated import tower_heading, unrelated

_GOES: Final = frozenset({"go", "be", "sit", "stand", "come"})
_AGAIN: Final = frozenset({"so", "neither", "nor"})
_MODALS: Final = MODALS | {"is", "may", "can", "does", "do", "will"}
#: What is not said of all may be said of some.
_ALL: Final = frozenset({"all", "every", "each", "everything"})
_ANY: Final = {"anything": "nothing", "any": "no"}


def read_clause(text: str, words: list[Words]) -> Said:
    """What a clause says by itself."""
    if bygone := [item for item in words if item.text == BYGONE]:
        where = bygone[0]
        raise InvalidGoalError(
            "this says what was; say what is to be", where.offset, text[where.offset : where.stop]
        )
    if words[-1].text == "up" and words[0].text in TAKES:
        words = words[:-1]
    if words[0].text == "can" and len(words) > 2 and meant(words[1].text, {"you"}, {"your"}):
        words = words[2:]
    if words[0].text == "can" and any(item.text in _GOES for item in words):
        words = words[1:]
    if len(words) > 2 and words[0].text in _AGAIN and words[1].text in _MODALS:
        return Said(words, term_of(words[2:]), again=words[0].text)
    if words[-1].text == "too" and len(words) > 1:
        words = words[:-1]
        related = has_phrase(words)
        if not related and not any(item.text in CLEAR for item in words):
            return Said(words, term_of(words), again="so")
    if plain := plainer(words):
        said = read_clause(text, plain.words)
        if plain.adjacent and (len(said.links) != 1 or said.links[0][1]):
            raise no_relation(text, words)
        return replace(
            said,
            edge=plain.edge or said.edge,
            adjacent=plain.adjacent or said.adjacent,
            of_object=plain.of_object or said.of_object,
        )
    if order := [item for item in words if item.text in ORDERS]:
        return tower_heading(text, words, order[0])
    words, found = phrases_in(words)
    texts = [item.text for item in words]
    if not found:
        return unrelated(text, words)
    verb, first = verb_at_start(words), found[0].first
    verb = max(verb, asker(words[:first]))
    _check_subject(words[verb:first])
    before = [item for item in words[verb:first] if item.text not in MUTE - NOUN_VERBS - WANTS]
    negated = [item for item in before if item.text == NEGATION]
    before = [item for item in before if item.text != NEGATION]
    while len(before) > 1 and before[-1].text in WANTS:
        before = before[:-1]  # "red wants to be on blue"
    if wants := [index for index, item in enumerate(before) if item.text in WANTS]:
        # Who wants it is nothing that is on the table: "my students want red on blue".
        before = before[wants[-1] + 1 :] or before
    if before and before[0].text in ("no", "nothing", "none"):
        before = [item for item in before if item.text not in ("allowed", "permitted")]
    if negated and before and before[0].text in _ALL and not _is_away(text, negated[0]):
        raise InvalidGoalError("say 'no' for none of them", negated[0].offset, NEGATION)
    if negated and before and before[0].offset < negated[0].offset < before[-1].offset:
        # "the boxes not red"
        raise InvalidGoalError("it is not clear what 'not' is said of", negated[0].offset, NEGATION)
    if len(before) > 1 and before[-1].text in ("both", "all"):
        # "red and blue both in stack 1"
        before = before[:-1]
    if len(negated) == 1 and before and before[0].text in _ANY:
        # "do not put anything on red"
        none = Words(_ANY[before[0].text], before[0].offset, before[0].stop)
        before, negated = [none, *before[1:]], []
    links = []
    for number, item in enumerate(found):
        last = found[number + 1].first if number + 1 < len(found) else len(words)
        between = list(words[item.last : last])
        denied = bool(number == 0 and negated)
        if number + 1 < len(found):
            denied_next = [other for other in between if other.text == NEGATION]
            if denied_next:
                raise InvalidGoalError(
                    "it is not clear what this is said of; separate relations by a comma",
                    denied_next[0].offset,
                    NEGATION,
                )
        written = Words(" ".join(texts[item.first : item.last]), words[item.first].offset)
        links.append((item, denied, between, written))
    if len(negated) > 1:
        raise InvalidGoalError("it says 'not' twice", negated[1].offset, NEGATION)
    if not before and len(found) == 1 and (turned := _turned(links[0][2])):
        # "on blue put red"
        objects, before = turned
        links = [(links[0][0], links[0][1], objects, links[0][3])]
    read = []
    for item, denied, between, written in links:
        if not (len(between) == 1 and between[0].text in IT):
            between = without_ends(between)
        if not between:
            raise _missing("after", text, words, item)
        read.append((item.phrase, denied, term_of(between), written))
    if not before:
        return Said(words, None, tuple(read))
    subject = term_of(before)
    if negated and subject.kind is not Kind.THE and negated[0].offset < before[0].offset:
        raise InvalidGoalError("it is not clear what 'not' is said of", negated[0].offset, NEGATION)
    return Said(words, subject, tuple(read))


def _is_away(text: str, denial: Words) -> bool:
    """Whether it was written "off", "out of" or "from": "everything off red"."""
    return text[denial.offset : denial.stop].lower().startswith(("off", "out", "from"))


def _check_subject(words: Sequence[Words]) -> None:
    """Raises InvalidGoalError for "the one that is on blue": what is there now is not known."""
    for noun, that, verb in zip(words, words[1:], words[2:]):
        known = noun.text in NOUNS or noun.text in SHAPES or noun.text in {*COLORS, *MORE_COLORS}
        if known and that.text in ("that", "which", "who") and verb.text in MUTE:
            raise InvalidGoalError("say which block by its name", that.offset, that.text)


def _turned(words: Sequence[Words]) -> tuple[list[Words], list[Words]] | None:
    """Object and subject of "on OBJECT put SUBJECT": on either side of a verb."""
    if not words or " ".join(item.text for item in words[:2]) in SAME_PLACE:
        return None
    if words[0].text in IT and (named := [item for item in words[1:] if item.text not in MUTE]):
        return [words[0]], named  # "on that the red one"
    verbs = [
        index
        for index, item in enumerate(words)
        if item.text in MUTE and not (item.text in NOUN_VERBS and names_a_place(words[index + 1 :]))
    ]
    for first in verbs:
        before = list(words[:first])
        after = [item for index, item in enumerate(words) if index > first and index not in verbs]
        if before and after:
            return before, after
    # "in stack 0 the brown box", "on it the blue one"
    for last in (2, 1):
        name = Words(" ".join(item.text for item in words[:last]), words[0].offset)
        if (name.is_place or name.text == "it") and len(words) > last:
            return list(words[:last]), list(words[last:])
    # "on the blue box the red box"
    for last, item in enumerate(words[:-1], start=1):
        if item.text in NOUNS or item.text in SHAPES:
            return list(words[:last]), list(words[last:])
    return None


def _missing(side: str, text: str, words: Sequence[Words], item: Found) -> InvalidGoalError:
    written = words[item.first : item.last]
    start, end = written[0].offset, written[-1].stop
    return InvalidGoalError(f"there is no block {side} this", start, text[start:end])
