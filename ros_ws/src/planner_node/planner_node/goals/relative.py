# SPDX-License-Identifier: Apache-2.0
"""Names that are told by a clause: "the block which is red", "the one on top of blue is red"."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Final

from scene_graph import COLORS, PREDICATES, SHAPES

from .language import MORE_COLORS, MUTE, NEGATION, NOUN_VERBS, NOUNS, PLURALS, SYNONYMS
from .phrases import find
from .terms import Words

_LOOKS: Final = frozenset(COLORS) | frozenset(SHAPES) | MORE_COLORS | SYNONYMS.keys()
_RELATIVE: Final = frozenset({"that", "which", "who"})
_COPULA: Final = frozenset({"is", "are"})
#: Behind what stands somewhere, they say who it is to be.
_TO_BE: Final = frozenset({"is", "should", "must", "be", "shall", "will", "needs", "to"})


def with_looks(clause: list[Words]) -> list[Words]:
    """ "the block which is red" as "red block", "the blocks that are red or blue" as both."""
    result: list[Words] = []
    index = 0
    while index < len(clause):
        noun = clause[index]
        one = PLURALS.get(noun.text, noun.text)
        told = [item.text for item in clause[index + 1 : index + 4]]
        if (
            one not in NOUNS
            or len(told) < 3
            or told[0] not in _RELATIVE
            or told[1] not in _COPULA
            or told[2] not in _LOOKS
        ):
            result.append(noun)
            index += 1
            continue
        plural = noun.text in PLURALS
        looks, behind = [clause[index + 3]], index + 4
        while plural and behind + 1 < len(clause) and clause[behind].text == "or":
            if clause[behind + 1].text not in _LOOKS:
                break
            looks.append(clause[behind + 1])
            behind += 2
        if len(looks) == 1:
            result += [*looks, noun]
        for number, look in enumerate(looks if len(looks) > 1 else ()):
            # All that are of either look, of each as many as there are.
            result += [Words("and", look.offset, look.offset)] if number else []
            result += [Words("all", look.offset, look.offset), look, noun]
        index = behind
    return result


def as_told_of(words: Sequence[Words]) -> list[Words] | None:
    """ "the block on top of blue should be red" as "red on top of blue"; None for all else."""
    texts = [item.text for item in words]
    found = list(find(words, PREDICATES.phrases))
    if len(found) != 1 or NEGATION in texts or texts[0] not in NOUNS | {"what", "whatever"}:
        return None
    first, last = found[0].first, found[0].last
    between = [text for text in texts[1:first] if text not in _RELATIVE]
    if any(text not in (MUTE - NOUN_VERBS) | {"i", "we", "you"} for text in between):
        return None
    at = next((index for index in range(last + 1, len(words)) if texts[index] in _TO_BE), 0)
    behind = at
    while at and behind < len(words) and texts[behind] in _TO_BE:
        behind += 1
    if not at or behind == len(words) or texts[behind - 1] not in ("is", "be"):
        return None
    if not any(text in _LOOKS for text in texts[behind:]):
        return None
    return [*words[behind:], *words[first:at]]
