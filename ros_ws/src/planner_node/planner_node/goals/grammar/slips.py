# SPDX-License-Identifier: Apache-2.0
"""What a word with a slip of the finger was meant to be."""

from __future__ import annotations

from collections.abc import Collection

from scene_graph import COLORS


def mended(word: str, known: Collection[str]) -> str | None:
    """The one known word that is nearest; None: none is near, or several are as near.

    In three letters two may be exchanged or one doubled; in four or five one may be wrong, and two
    in more.
    """
    if short := _shortened(word):
        return short
    best: list[str] = []
    limit = least = 1.0 if len(word) < 6 else 2.0
    for other in known:
        if abs(len(other) - len(word)) > 2 or len(other) < 2 or not other.isalpha():
            continue
        if word[0] != other[0] and sorted(word[:2]) != sorted(other[:2]) and len(word) < 5:
            continue
        distance = edits(word, other)
        if min(len(word), len(other)) < 4 and not _harmless(word, other):
            continue
        if min(len(word), len(other)) < 6 and distance > 1:
            continue
        if distance < least or (distance == least and distance <= limit and not best):
            best, least = [other], distance
        elif distance == least:
            best.append(other)
    best = [one for one in best if one in COLORS] or best
    return best[0] if len(best) == 1 else None


def _harmless(word: str, other: str) -> bool:
    """Two letters exchanged, or one written twice."""
    if len(word) == len(other):
        return sorted(word) == sorted(other)
    longer, shorter = sorted((word, other), key=len, reverse=True)
    return any(
        longer[:at] + longer[at + 1 :] == shorter and longer[at] in longer[at - 1 : at]
        for at in range(1, len(longer))
    )


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
