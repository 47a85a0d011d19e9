# SPDX-License-Identifier: Apache-2.0
"""Who is left out, and who alone is meant: "everything but red", "only red and blue in stack 0"."""

from __future__ import annotations

from collections.abc import Sequence

from .language import EVERYONE, EXCEPT, HOLDS, MUTE, NEGATION, NOUN_VERBS, PLURALS
from .phrases import has_phrase
from .terms import Words, names_place


def with_exceptions(clause: list[Words]) -> list[Words]:
    """ "all boxes but the white one", "everything in stack1 but red", with "except"."""
    texts = [item.text for item in clause]
    for at in range(1, len(clause) - 1):
        if texts[at] != "but" or not any(text in EVERYONE for text in texts[:at]):
            continue
        named = not has_phrase(clause[at + 1 :]) and NEGATION not in texts[at + 1 :]
        if named or not has_phrase(clause[:at]):
            word = Words(EXCEPT, clause[at].offset, clause[at].stop)
            return [*clause[:at], word, *clause[at + 1 :]]
    return clause


def with_only(clauses: Sequence[list[Words]]) -> list[list[Words]]:
    """ "stack 0 contains red and blue only" as "only red and blue in stack 0"."""
    clauses = list(clauses)
    for number, clause in enumerate(clauses):
        at = next((index for index, item in enumerate(clause) if item.text in HOLDS), 0)
        place = [item for item in clause[:at] if item.text not in MUTE - NOUN_VERBS]
        last = number
        while last + 1 < len(clauses) and not has_phrase(clauses[last + 1]):
            last += 1
        held = [clause[at + 1 :], *clauses[number + 1 : last + 1]]
        texts = [item.text for part in held for item in part]
        if not names_place(place) or "only" not in (*texts[:1], *texts[-1:]) or NEGATION in texts:
            continue
        only = next(item for part in held for item in part if item.text == "only")
        held = [[item for item in part if item is not only] for part in held]
        held[0] = [only, *held[0]]
        inside = Words("in", place[0].offset, place[0].offset)
        held[-1] = [*held[-1], inside, *place]
        clauses[number : last + 1] = held
        break
    return clauses


def without_both(part: list[Words]) -> list[Words]:
    """ "both red" in front of "and blue" without its "both"."""
    at = next((index for index, item in enumerate(part) if item.text == "both"), len(part) - 1)
    named = at + 1 < len(part) and part[-1].text not in PLURALS and not has_phrase(part[at:])
    return [*part[:at], *part[at + 1 :]] if named else part


def leaves_out(part: Sequence[Words]) -> bool:
    """Whether it says who is left out, and not yet of what."""
    return any(item.text == EXCEPT for item in part) and not has_phrase(part)
