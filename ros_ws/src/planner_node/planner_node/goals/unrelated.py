# SPDX-License-Identifier: Apache-2.0
"""Clauses without a relation of their own: a name, what to take, what is clear, a row's heading."""

from __future__ import annotations

from collections.abc import Sequence

from scene_graph import PREDICATES

from .around import asker, verb_at_start, without_ends
from .language import CLEAR, HEADING, MUTE, NEGATION, NOUN_VERBS, TAKES, meant
from .orders import ORDERS
from .phrases import RIGHT_WORDS, find
from .quantities import term_of
from .said import Link, Said, no_relation
from .terms import Kind, Term, Words, names_place


def unrelated(text: str, words: list[Words]) -> Said:
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
    rest = [item for item in words if item not in clear and item.text != NEGATION]
    start = max(verb_at_start(rest), asker(rest))
    name = without_ends(rest[start:])
    asks = [item for item in rest if item.text in MUTE and item not in name]
    if clear and [item.text for item in name[:2]] == ["top", "of"]:
        name = name[2:]  # "leave the top of red free"
    if clear and not name and words[0].text == "which":
        name = words[:1]
    while len(name) > 1 and name[-1].text in ("all", "both"):
        name = without_ends(name[:-1])  # "should all be clear"
    if len(clear) == 1 and name and not denied:
        return Said(words, term_of(name), clears=True)
    if len(clear) == 1 and name and denied:
        # "stack 1 must not be empty"
        term = term_of(name)
        some = Term(Words("block", clear[0].offset, clear[0].stop), Kind.COUNT)
        phrase = PREDICATES.phrases["in" if term.is_place else "on",]
        if term.kind in (Kind.THE, Kind.EVERY):
            return Said(words, some, ((phrase, False, term, clear[0]),), of_object=True)
    if clear or denied or not name:
        raise no_relation(text, words)
    return Said(words, term_of(name), asks=bool(asks))


def _there(words: Sequence[Words]) -> Said | None:
    """ "blue must not be there", "blue elsewhere": in the place that was spoken of, or not."""
    elsewhere = words[-1].text == "elsewhere"
    named = [item for item in words[verb_at_start(words) :] if item.text not in MUTE - NOUN_VERBS]
    denied = [item for item in named if item.text == NEGATION]
    named = [item for item in named if item.text not in (NEGATION, "elsewhere")]
    if not named or len(denied) + elsewhere > 1:
        return None
    there = Words("it", words[-1].offset, words[-1].stop)
    link = (PREDICATES.phrases["in",], bool(denied) or elsewhere, Term(there), words[-1])
    return Said(words, term_of(named), (link,))


def tower_heading(text: str, words: Sequence[Words], order: Words) -> Said:
    """The heading of a tower, "from bottom to top in stack 1", and the first name behind it."""
    rest = [
        item for item in words if item is not order and item.text not in HEADING | MUTE - NOUN_VERBS
    ]
    found = list(find(rest, PREDICATES.phrases))
    links: tuple[Link, ...] = ()
    if len(found) == 1:
        # A place; behind it there may be the first name.
        behind = rest[found[0].last :]
        place = next((behind[:last] for last in (2, 1) if names_place(behind[:last])), None)
        if place is None:
            raise no_relation(text, words)
        links = ((found[0].phrase, False, term_of(place), order),)
        rest = [*rest[: found[0].first], *behind[len(place) :]]
    elif found:
        raise no_relation(text, words)
    elif stop := next((last for last in (2, 1) if names_place(rest[:last])), 0):
        # "column 1 from bottom to top"
        phrase = PREDICATES.phrases["in",]
        links, rest = ((phrase, False, term_of(rest[:stop]), order),), rest[stop:]
    subject = term_of(rest) if rest else None
    return Said(words, subject, links, order=ORDERS[order.text])


def _taken(words: Sequence[Words]) -> list[Words]:
    """What "take …" or "pick … up" says to take; empty for other clauses."""
    for index, item in enumerate(words[:4]):
        if item.text in TAKES:
            name = list(words[index + 1 :])
            source = next((at for at, one in enumerate(name) if at and one.text == "from"), 0)
            name = name[:source] if source else name  # "take red from blue"
            return without_ends(name) if name else []
        if item.text not in MUTE and meant(item.text, MUTE | RIGHT_WORDS) not in MUTE:
            break
    return []
