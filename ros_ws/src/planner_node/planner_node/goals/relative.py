# SPDX-License-Identifier: Apache-2.0
"""Names that are told by a clause: "the block which is red", "the one on top of blue is red"."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Final

from scene_graph import COLORS, PREDICATES, SHAPES

from .language import INSTEAD, MORE_COLORS, MUTE, NEGATION, NOUN_VERBS, NOUNS, PLURALS, SYNONYMS
from .phrases import find
from .run_on import is_name
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


_TOPPING: Final = frozenset({"cover", "top", "crown", "cap"})
_TOPPED: Final = frozenset({"covered", "topped", "crowned", "capped"})


def as_topped(words: Sequence[Words]) -> list[Words] | None:
    """ "cover blue with red", "blue is topped by red" as "red on blue"; None for all else."""
    texts = [item.text for item in words]
    at = next((at for at, text in enumerate(texts) if at and text in ("with", "by")), 0)
    if not at or NEGATION in texts or list(find(words, PREDICATES.phrases)):
        return None
    below, above = words[:at], list(words[at + 1 :])
    if below[-1].text in _TOPPED:
        below = below[:-1]
    elif any(item.text in _TOPPING for item in below[:-1]):
        verb = next(index for index, item in enumerate(below) if item.text in _TOPPING)
        if any(item.text not in MUTE for item in below[:verb]):
            return None
        below = below[verb + 1 :]
    else:
        return None
    kept = [item for item in below if item.text not in MUTE - NOUN_VERBS]
    if not kept or not above:
        return None
    return [*above, Words("on", words[at].offset, words[at].stop), *kept]


def without_contrast(clause: list[Words]) -> list[Words]:
    """ "red on blue instead of on green", "it is red that goes on blue" as "red on blue"."""
    texts = [item.text for item in clause]
    that = next((at for at, text in enumerate(texts) if at > 2 and text in _RELATIVE), 0)
    if texts[:2] == ["it", "is"] and that and is_name(clause[2:that]):
        return [*clause[2:that], *clause[that + 1 :]]
    if INSTEAD not in texts:
        return clause
    at = texts.index(INSTEAD)
    phrase = next(find(clause[at + 1 :], PREDICATES.phrases), None)
    if phrase is None or phrase.first:
        return clause  # "red on blue instead of green": which of them is green instead of?
    start = at + 1 + phrase.last
    end = next((end for end in range(len(clause), start, -1) if is_name(clause[start:end])), 0)
    return [*clause[:at], *clause[end:]] if end else clause
