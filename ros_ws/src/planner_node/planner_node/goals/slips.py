# SPDX-License-Identifier: Apache-2.0
"""What a word with a slip of the finger may have been meant to be."""

from __future__ import annotations

import re
from collections.abc import Iterator
from functools import lru_cache

from scene_graph import COLORS

from .grammar.lexicon import NO_SLIPS

#: How many words one may be meant to be.
_MOST = 4


@lru_cache(maxsize=4096)
def mended(word: str, known: frozenset[str]) -> tuple[str, ...]:
    """The known words that are nearest; none where none is near, or too many are as near.

    Two letters may be exchanged, or one doubled, in any word, and vowels left out; in four to six
    letters one may be wrong, and two in more.
    """
    if word in NO_SLIPS or not word.isalpha():
        return ()
    if short := _shortened(word):
        return (short,)
    near: dict[float, set[str]] = {}
    limit = 0 if len(word) < 4 else 1 if len(word) < 7 else 2
    for other in known:
        if abs(len(other) - len(word)) > 2 or len(other) < 2 or not other.isalpha():
            continue
        if _harmless(word, other):
            near.setdefault(0.5, set()).add(other)
        elif other in COLORS and word[0] == other[0] and sorted(word) == sorted(other):
            near.setdefault(0.7, set()).add(other)
        elif (
            (len(other) > 3 or other in COLORS)
            and len(word) > 2
            and word[0] == other[0]
            and (len(other) >= len(word) or other in COLORS)
            and _vowelless(word) == _vowelless(other)
        ):
            near.setdefault(0.8, set()).add(other)
        elif len(word) == 3 and other[:-1] == word:
            near.setdefault(1.0, set()).add(other)
        elif len(word) < 6 and word[0] != other[0]:
            continue
        elif (len(other) > 3 or other in COLORS) and (distance := edits(word, other)) <= limit:
            near.setdefault(float(distance), set()).add(other)
    if not near:
        return ()
    best = near[min(near)]
    best = best & set(COLORS) or best
    if len(best) > _MOST:
        fewest = min(edits(word, other) for other in best)
        best = {other for other in best if edits(word, other) == fewest}
    return tuple(sorted(best)) if len(best) <= _MOST else ()


def _vowelless(word: str) -> str:
    return word[0] + re.sub("[aeiou]", "", word[1:])


def _harmless(word: str, other: str) -> bool:
    """Two neighbours exchanged, or a letter written twice."""
    if len(word) == len(other):
        return other in _exchanged(word)
    return re.sub(r"(.)\1+", r"\1", word) == re.sub(r"(.)\1+", r"\1", other)


def _exchanged(word: str) -> Iterator[str]:
    for at in range(len(word) - 1):
        yield word[:at] + word[at + 1] + word[at] + word[at + 2 :]


def _shortened(word: str) -> str | None:
    """The one colour of which letters were left out: "yel" or "ylw" for "yellow"."""
    if len(word) < 2:
        return None
    found = [
        color
        for color in COLORS
        if color[0] == word[0] and len(color) > len(word) and _in_order(word, color)
    ]
    if len(word) == 2:
        found = [color for color in found if len(color) == 3]
    return found[0] if len(found) == 1 else None


def _in_order(letters: str, word: str) -> bool:
    rest = iter(word)
    return all(letter in rest for letter in letters)


def edits(one: str, other: str) -> int:
    """Letters to change, leave out, put in, or exchange with the next (Damerau, Levenshtein)."""
    before: list[int] = []
    row = list(range(len(other) + 1))
    for i, letter in enumerate(one, 1):
        now = [i]
        for j, target in enumerate(other, 1):
            cost = min(row[j] + 1, now[j - 1] + 1, row[j - 1] + (letter != target))
            if i > 1 and j > 1 and letter == other[j - 2] and one[i - 2] == target:
                cost = min(cost, before[j - 2] + 1)
            now.append(cost)
        before, row = row, now
    return row[-1]
