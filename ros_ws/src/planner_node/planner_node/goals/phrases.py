# SPDX-License-Identifier: Apache-2.0
"""The phrases of predicates among the words of a clause, with typos in them mended."""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass
from typing import Final

from scene_graph import COLORS, PREDICATES, SHAPES, Phrase

from .language import (
    ARTICLES,
    CARRIES,
    CLEAR,
    HOLDS,
    JOINS,
    MUTE,
    NOUNS,
    NUMBERS,
    OPENINGS,
    OTHER_WORDS,
    PLACE_NOUNS,
    PLURALS,
    SIDES,
    SYNONYMS,
    TAKES,
    VERBS,
    meant,
)
from .terms import Words
from .wordings import MERGED

#: Words of phrases that a typo is looked for; the shorter ones are like too much.
_TYPED_WRONG: Final = frozenset({
    "on", "onto", "upon", "above", "below", "under", "underneath", "beneath", "left", "right",
    "next", "beside", "adjacent", "inside", "directly",
})  # fmt: skip
#: Words that are right as they are.
RIGHT_WORDS: Final = frozenset().union(
    HOLDS, CARRIES,
    COLORS, SHAPES, NOUNS, MUTE, OPENINGS, CLEAR, TAKES, OTHER_WORDS, JOINS, PLURALS, SYNONYMS,
    NUMBERS, {"not", "it", "of", "no"},
)  # fmt: skip
_Phrases = Mapping[tuple[str, ...], Phrase]

#: Words that a slip of the fingers is looked for in every word.
_COMMON: Final = {"neither", "nothing", "everything", "different"} | frozenset(
    word
    for word in RIGHT_WORDS.union(*MERGED, *PREDICATES.phrases, PLACE_NOUNS, SIDES) - OTHER_WORDS
    if len(word) >= 4 and word.isalpha() and word not in COLORS and word not in SHAPES
)
#: The keys beside each on a keyboard, in its row.
_BESIDE: Final = {
    row[at]: row[max(at - 1, 0) : at] + row[at + 1 : at + 2]
    for row in ("qwertyuiop", "asdfghjkl", "zxcvbnm")
    for at in range(len(row))
}
_NO_SLIP: Final = RIGHT_WORDS.union(COLORS, SHAPES, *MERGED, *PREDICATES.phrases, ARTICLES, JOINS)


def without_slip(word: str) -> str:
    """A common word of goals without a slip: two letters exchanged, one left out or doubled.

    Another letter in its place is one only where its key is beside: others make other words of it.
    """
    if len(word) < 3 or word in _NO_SLIP or not word.isalpha():
        return word
    slips = {word[:at] + word[at + 1] + word[at] + word[at + 2 :] for at in range(len(word) - 1)}
    found = slips & (_COMMON if len(word) > 3 else NUMBERS.keys())
    if not found and len(word) >= 4:
        found = {
            word[:at] + word[at + 1 :] for at in range(1, len(word)) if word[at] == word[at - 1]
        } & (_COMMON | VERBS | {"all", "not", "and", "the"})
    if not found and len(word) >= 4:
        found = {
            known
            for known in _COMMON
            if len(known) == len(word) + 1
            and any(known[:at] + known[at + 1 :] == word for at in range(1, len(known)))
        }
    if not found and len(word) >= 4:
        found = {
            word[:at] + key + word[at + 1 :]
            for at in range(1, len(word))
            for key in _BESIDE.get(word[at], "")
        } & (_COMMON | VERBS)
    return found.pop() if len(found) == 1 else word


@dataclass(frozen=True)
class Found:
    """A phrase in a clause: its words from ``first`` to before ``last``."""

    first: int
    last: int
    phrase: Phrase


def phrases_in(words: list[Words]) -> tuple[list[Words], list[Found]]:
    """The phrases of a clause, and its words with typos in phrases mended where that finds more."""
    phrases = PREDICATES.phrases
    found = list(find(words, phrases))
    right = RIGHT_WORDS | {text for phrase in phrases for text in phrase}
    mended = [_mended(item, right) for item in words]
    if mended != words and (better := list(find(mended, phrases))):
        longer = len(found) == len(better) and _length(found) < _length(better)
        if longer or all(item.phrase.needs_place for item in found):
            return mended, better
    return words, found


def _length(found: Sequence[Found]) -> int:
    return sum(item.last - item.first for item in found)


def _mended(item: Words, right: frozenset[str]) -> Words:
    """A word of a phrase without its typo."""
    found = meant(item.text, _TYPED_WRONG | right, right)
    return Words(found, item.offset, item.stop) if found in _TYPED_WRONG else item


def find(words: Sequence[Words], phrases: _Phrases) -> Iterator[Found]:
    """Every phrase among the words; the longest that fits is taken."""
    longest = max(map(len, phrases), default=0)
    texts = tuple(word.text for word in words)
    index = 0
    while index < len(words):
        for last in range(min(index + longest, len(words)), index, -1):
            if phrase := phrases.get(texts[index:last]):
                yield Found(index, last, phrase)
                index = last
                break
        else:
            index += 1


def has_phrase(words: Sequence[Words]) -> bool:
    """Whether there is a phrase among the words."""
    return next(find(words, PREDICATES.phrases), None) is not None
