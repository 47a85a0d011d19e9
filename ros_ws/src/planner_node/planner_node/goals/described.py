# SPDX-License-Identifier: Apache-2.0
"""Blocks told by where they are: "the top block of stack1 is red"."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Final

from .language import MUTE, NOUN_VERBS, NOUNS
from .terms import Words, names_place

_EDGES: Final = {
    "top": "top", "topmost": "top", "uppermost": "top", "highest": "top", "bottom": "bottom",
    "lowest": "bottom", "bottommost": "bottom", "base": "bottom",
}  # fmt: skip
#: In front of "top of stack1", they make a relation of it.
_WITHIN: Final = frozenset({"at", "on", "onto", "to", "very", "directly", "over", "in"})
_OF: Final = frozenset({"of", "in", "on", "at"})


def by_place(words: Sequence[Words]) -> tuple[list[Words], str | None] | None:
    """A clause that says which block is at an edge of a place, or alone there.

    Returns:
        "red in stack1" and the edge, or "only red in stack1" and None; None where it says no such.
    """
    for start in range(len(words) - 2):
        within = start > 0 and words[start - 1].text in _WITHIN
        found = None if within else _described(words[start:])
        if found is None:
            continue
        edge, place, used = found
        name = [*words[:start], *words[start + used :]]
        name = [item for item in name if item.text not in MUTE - NOUN_VERBS]
        if not name or (start and start + used < len(words)):
            return None
        inside = Words("in", words[start].offset, place[-1].stop)
        if edge is None:
            return [Words("only", words[start].offset), *name, inside, *place], None
        return [*name, inside, *place], edge
    return None


def _described(words: Sequence[Words]) -> tuple[str | None, list[Words], int] | None:
    """The edge, the place and the number of words of "the top block of stack1".

    The edge is None for "the only block in stack1".
    """
    texts = [item.text for item in words]
    edge: str | None = None
    if texts[:2] == ["the-", "only"] and texts[2:3] and texts[2] in NOUNS:
        at = 3
    elif texts[0] in _EDGES:
        edge = _EDGES[texts[0]]
        at = 1 + (texts[1] in NOUNS)
    elif texts[0] in NOUNS and texts[1] == "at-top-of":
        edge, at = "top", 1
    elif texts[0] in NOUNS and texts[1] == "at" and texts[2] in _EDGES:
        edge, at = _EDGES[texts[2]], 3
    else:
        return None
    if texts[at : at + 1] != ["at-top-of"] and (at >= len(texts) or texts[at] not in _OF):
        return None
    for last in (at + 3, at + 2):
        place = list(words[at + 1 : last])
        if names_place(place):
            return edge, place, last
    return None
