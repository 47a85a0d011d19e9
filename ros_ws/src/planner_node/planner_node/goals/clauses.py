# SPDX-License-Identifier: Apache-2.0
"""What one clause of a goal says by itself: its subject, its relations and their objects."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass, replace
from typing import Final

from scene_graph import PREDICATES, SHAPES, UP, Phrase

from ..errors import InvalidGoalError
from .language import (
    CLEAR,
    HEADING,
    IT,
    MODALS,
    MUTE,
    NEGATION,
    NOUN_VERBS,
    NOUNS,
    NUMBERS,
    SAME_PLACE,
    TAKES,
    meant,
)
from .orders import ORDERS
from .phrases import RIGHT_WORDS, Found, find, phrases_in
from .plainer import plainer
from .terms import Kind, Term, Words, term_of

EXAMPLE: Final = "write relations like 'red on blue, green left of red'"

_WANTS: Final = frozenset({"want", "wants"})
_GOES: Final = frozenset({"go", "be", "sit", "stand", "come"})
_AGAIN: Final = frozenset({"so", "neither", "nor"})
_MODALS: Final = MODALS | {"is", "may", "can", "does", "do", "will"}
_ANY: Final = {"anything": "nothing", "any": "no"}
_SKIPPED: Final = MUTE | TAKES | {NEGATION}


#: A phrase, whether it is negated, its object, and the words of the phrase.
Link = tuple[Phrase, bool, Term, Words]


@dataclass(frozen=True)
class Said:
    """What one clause says; a name without a relation has no links.

    Attributes:
        subject: None where the clause leaves it out.
        links: its relations, in their order.
        takes: it only says what to take, as in "take red and put it on blue".
        clears: it says of the name that nothing stands on it.
        order: the names that follow are a tower or a row, see ``ORDERS``; None: they are not.
        again: what was said before is said of its subject too: "so should blue", "nor should blue".
        asks: it has a verb, but no relation, as in "on blue, put red".
        edge: "top" or "bottom" where its subject is said to be there, of the place that is meant.
        adjacent: it says "directly left of": the places are neighbours too.
        of_object: it says of its object how many subjects it has: "stack1 has two blocks".
    """

    words: Sequence[Words]
    subject: Term | None
    links: tuple[Link, ...] = ()
    takes: bool = False
    clears: bool = False
    order: tuple[str, bool] | None = None
    asks: bool = False
    of_object: bool = False
    edge: str | None = None
    adjacent: bool = False
    again: str = ""

    def denies(self, subjects: Sequence[Term]) -> bool:
        """Whether its last relation does not hold: a list behind it then may go on."""
        return bool(self.links) and (
            self.links[-1][1] or all(subject.kind is Kind.NO for subject in subjects)
        )


def read_clause(text: str, words: list[Words]) -> Said:
    """What a clause says by itself."""
    if words[-1].text == "up" and words[0].text in TAKES:
        words = words[:-1]
    if words[0].text == "can" and len(words) > 2 and meant(words[1].text, {"you"}, {"your"}):
        words = words[2:]
    if words[0].text == "can" and any(item.text in _GOES for item in words):
        words = words[1:]
    if len(words) > 2 and words[0].text in _AGAIN and words[1].text in _MODALS:
        return Said(words, term_of(words[2:]), again=words[0].text)
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
        return _tower(text, words, order[0])
    words, found = phrases_in(words)
    texts = [item.text for item in words]
    if not found:
        return _without_phrase(text, words)
    verb, first = _verb_at_start(words), found[0].first
    verb = max(verb, _asker(words[:first]))
    before = [item for item in words[verb:first] if item.text not in MUTE - NOUN_VERBS - _WANTS]
    negated = [item for item in before if item.text == NEGATION]
    before = [item for item in before if item.text != NEGATION]
    if wants := [index for index, item in enumerate(before) if item.text in _WANTS]:
        # Who wants it is nothing that is on the table: "my students want red on blue".
        before = before[wants[-1] + 1 :] or before
    if before and before[0].text in ("no", "nothing", "none"):
        before = [item for item in before if item.text not in ("allowed", "permitted")]
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
            between = _without_ends(between)
        if not between:
            raise _missing("after", text, words, item)
        read.append((item.phrase, denied, term_of(between), written))
    if not before:
        return Said(words, None, tuple(read))
    subject = term_of(before)
    if negated and subject.kind is not Kind.THE and negated[0].offset < before[0].offset:
        raise InvalidGoalError("it is not clear what 'not' is said of", negated[0].offset, NEGATION)
    return Said(words, subject, tuple(read))


def _asker(words: Sequence[Words]) -> int:
    """Where it is said who asks: "for the next trial we need red on blue"; 0 where nobody does."""
    asker = [index for index, item in enumerate(words) if item.text in {"i", "we"} | _WANTS]
    if not asker or any(item.text == NEGATION for item in words[: asker[-1]]):
        return 0
    return asker[-1]


def _verb_at_start(words: Sequence[Words]) -> int:
    """How many words at the start ask and name nothing."""
    index = 0
    while index < len(words) and words[index].text in _SKIPPED:
        rest = words[index + 1 :]
        if words[index].text in NOUN_VERBS and _names_a_place(rest):
            break
        index += 1
    # What is denied is looked for behind.
    kept = [item for item in words[:index] if item.text == NEGATION]
    return words.index(kept[0]) if kept else index


def _names_a_place(rest: Sequence[Words]) -> bool:
    """Whether "stack" or "place" in front of these words is a noun."""
    if not rest or rest[0].text.isdigit() or rest[0].text in NUMBERS:
        return True
    phrases = PREDICATES.phrases
    kept = tuple(item.text for item in rest if item.text not in ("is", "are"))
    return any(kept[: len(phrase)] == phrase for phrase in phrases)


def _turned(words: Sequence[Words]) -> tuple[list[Words], list[Words]] | None:
    """Object and subject of "on OBJECT put SUBJECT": on either side of a verb."""
    if not words or " ".join(item.text for item in words[:2]) in SAME_PLACE:
        return None
    if words[0].text in IT and (named := [item for item in words[1:] if item.text not in MUTE]):
        return [words[0]], named  # "on that the red one"
    verbs = [
        index
        for index, item in enumerate(words)
        if item.text in MUTE
        and not (item.text in NOUN_VERBS and _names_a_place(words[index + 1 :]))
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


def _without_ends(words: Sequence[Words]) -> list[Words]:
    """Without the words at either end that mean nothing."""
    kept = list(words)
    while kept and kept[-1].text in MUTE - NOUN_VERBS:
        kept.pop()
    while kept and kept[0].text in MUTE - NOUN_VERBS:
        kept.pop(0)
    return kept


def _without_phrase(text: str, words: list[Words]) -> Said:
    """A name, something to take, or something that is to be clear."""
    if words[-1].text in ("there", "elsewhere") and (there := _there(words)):
        return there
    taken = _taken(words)
    if taken:
        return Said(words, term_of(taken), takes=True)
    clear = [item for item in words if item.text in CLEAR]
    if not clear:
        clear = [item for item in words[:2] if meant(item.text, CLEAR | RIGHT_WORDS) in CLEAR]
    denied = any(item.text == NEGATION for item in words)
    rest = [item for item in words if item not in clear]
    start = max(_verb_at_start(rest), _asker(rest))
    name = _without_ends(rest[start:])
    asks = [item for item in rest if item.text in MUTE and item not in name]
    if len(clear) == 1 and name and not denied:
        return Said(words, term_of(name), clears=True)
    if clear or denied or not name:
        raise no_relation(text, words)
    return Said(words, term_of(name), asks=bool(asks))


def _there(words: Sequence[Words]) -> Said | None:
    """ "blue must not be there", "blue elsewhere": in the place that was spoken of, or not."""
    elsewhere = words[-1].text == "elsewhere"
    named = [item for item in words[_verb_at_start(words) :] if item.text not in MUTE - NOUN_VERBS]
    denied = [item for item in named if item.text == NEGATION]
    named = [item for item in named if item.text not in (NEGATION, "elsewhere")]
    if not named or len(denied) + elsewhere > 1:
        return None
    there = Words("it", words[-1].offset, words[-1].stop)
    link = (PREDICATES.phrases["in",], bool(denied) or elsewhere, Term(there), words[-1])
    return Said(words, term_of(named), (link,))


def _tower(text: str, words: Sequence[Words], order: Words) -> Said:
    """The heading of a tower, "from bottom to top in stack 1", and the first name behind it."""
    rest = [
        item for item in words if item is not order and item.text not in HEADING | MUTE - NOUN_VERBS
    ]
    found = list(find(rest, PREDICATES.phrases))
    links: tuple[Link, ...] = ()
    if len(found) == 1:
        # A place; behind it there may be the first name.
        behind = rest[found[0].last :]
        place = next((behind[:last] for last in (2, 1) if _is_place(behind[:last])), None)
        if place is None:
            raise no_relation(text, words)
        links = ((found[0].phrase, False, term_of(place), order),)
        rest = [*rest[: found[0].first], *behind[len(place) :]]
    elif found:
        raise no_relation(text, words)
    elif stop := next((last for last in (2, 1) if _is_place(rest[:last])), 0):
        # "column 1 from bottom to top"
        phrase = PREDICATES.phrases["in",]
        links, rest = ((phrase, False, term_of(rest[:stop]), order),), rest[stop:]
    subject = term_of(rest) if rest else None
    return Said(words, subject, links, order=ORDERS[order.text])


def _is_place(words: Sequence[Words]) -> bool:
    return bool(words) and term_of(words).is_place


def _taken(words: Sequence[Words]) -> list[Words]:
    """What "take …" or "pick … up" says to take; empty for other clauses."""
    for index, item in enumerate(words[:4]):
        if item.text in TAKES:
            name = list(words[index + 1 :])
            return _without_ends(name) if name else []
        if item.text not in MUTE and meant(item.text, MUTE | RIGHT_WORDS) not in MUTE:
            break
    return []


def no_relation(text: str, words: Sequence[Words]) -> InvalidGoalError:
    """The error of a part of a goal that relates nothing to nothing."""
    start, end = words[0].offset, words[-1].stop
    return InvalidGoalError(
        f"no relation found; known are {', '.join(_known())}; {EXAMPLE}", start, text[start:end]
    )


def _missing(side: str, text: str, words: Sequence[Words], item: Found) -> InvalidGoalError:
    written = words[item.first : item.last]
    start, end = written[0].offset, written[-1].stop
    return InvalidGoalError(f"there is no block {side} this", start, text[start:end])


def _known() -> Iterator[str]:
    """One way to write each relation, its inverse, and its form for places."""
    for name in PREDICATES:
        predicate = PREDICATES[name]
        yield from predicate.phrases[:1]
        if name != UP:
            yield from predicate.inverse_phrases[:1]
            yield from predicate.place_phrases[:1]
