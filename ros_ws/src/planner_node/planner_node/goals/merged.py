# SPDX-License-Identifier: Apache-2.0
"""The words of a part of a goal with those that belong together as one."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Final

from .language import ARTICLES, HOLDS, JOINS, MUTE, NOUN_VERBS, TAKES, VERBS
from .orders import order_at
from .places import place_at
from .terms import Words, names_place, number_of
from .wordings import MERGED, PROVISOS

_TOWERS: Final = frozenset({"tower", "stack", "pile"})
_BUILDING: Final = VERBS | {"", "want", "need", "like", "please", "be", "is"}
_LONGEST: Final = max(map(len, MERGED))


def merged(words: Sequence[Words]) -> list[Words]:
    """With several words that stand for others replaced, the longest first; without articles."""
    words = list(_without_articles(words))
    result: list[Words] = []
    index, removing = 0, False
    while index < len(words):
        before = result[-1].text if result else ""
        removing = removing or words[index].text in ("remove", "removing", "removed")
        found, used = _at(words[index:], before, removing)
        result += found
        index += used
    return result


def _at(words: Sequence[Words], before: str, removing: bool) -> tuple[list[Words], int]:
    """What some words begin with, as it is read, and how many words it is.

    Args:
        before: the word in front.
        removing: "remove" is in front, so that "from" says where something is not to be.
    """
    for length in range(min(_LONGEST, len(words)), 0, -1):
        texts = tuple(item.text for item in words[:length])
        if texts in PROVISOS and before:
            return [], length
        if texts in MERGED:
            offset, stop = words[0].offset, words[length - 1].stop
            return [Words(text, offset, stop) for text in MERGED[texts]], length
    texts = tuple(item.text for item in words)
    if texts[0] == "rest" and (not before or before in JOINS):
        return [Words("others", words[0].offset, words[0].stop)], 1
    if order := order_at(texts, before):
        name, used = order
        return [Words(name, words[0].offset, words[used - 1].stop)], used
    if place := place_at(words, before):
        return place
    if texts[0] == "a" and texts[2:3] == ("of",) and texts[1] in _TOWERS and before in _BUILDING:
        return [], 3  # "build a tower of red on blue"
    if between := _between(texts):
        text, used = between
        return [Words(text, words[0].offset, words[used - 1].stop)], used
    if away := _away(words, removing):
        return away
    if texts[:2] == ("up", "to") and number_of(" ".join(texts[2:3])) is not None:
        return [Words("at-most", words[0].offset, words[1].stop)], 2
    if texts[0] == "to" and len(texts) > 1 and _is_verb(texts[1:]):
        return [], 1  # "I want you to put red on blue"
    return [words[0]], 1


def _away(words: Sequence[Words], removing: bool) -> tuple[list[Words], int] | None:
    """ "off blue" as "not on blue", "off stack 1" as "not in stack 1"; None for other words."""
    texts = [item.text for item in words[:4]]
    used = 0
    if texts[0] == "off":
        used = 1 + (texts[1:2] == ["of"])
    elif texts[0] == "from" and removing:
        used = 3 if texts[1:3] == ["top", "of"] else 1
    if not used or used == len(words):
        return None
    behind = words[used : used + 3]
    named = place_at(behind) or any(names_place(behind[:last]) for last in (1, 2))
    offset, stop = words[0].offset, words[used - 1].stop
    inside = "in" if named else "on"
    return [Words("not", offset, stop), Words(inside, offset, stop)], used


def _is_verb(texts: Sequence[str]) -> bool:
    """Whether "to" in front of these words is no relation."""
    if texts[0] in NOUN_VERBS:
        return len(texts) > 1 and number_of(texts[1]) is None and texts[1] != "number"
    return texts[0] in MUTE | TAKES | HOLDS


def _between(texts: Sequence[str]) -> tuple[str, int] | None:
    """ "between two and three", "two or three" as one number; None where it is none."""
    start = int(texts[0] == "between")
    if len(texts) < start + 3 or texts[start + 1] not in ("and", "or", "to"):
        return None
    low, high = number_of(texts[start]), number_of(texts[start + 2])
    if low is None or high is None or low >= high:
        return None
    if not start and (texts[start + 1] != "or" or high != low + 1):
        return None
    return f"{low}-to-{high}", start + 3


def _without_articles(words: Sequence[Words]) -> list[Words]:
    """ "the two boxes" as "all two boxes"; "the only box" keeps its article, all others go."""
    result: list[Words] = []
    for index, item in enumerate(words):
        if item.text == "rest" and index and words[index - 1].text in ARTICLES:
            result.append(Words("others", item.offset, item.stop))
            continue
        if item.text not in ARTICLES:
            result.append(item)
            continue
        behind = words[index + 1].text if index + 1 < len(words) else ""
        if (number_of(behind) or 0) > 1:
            result.append(Words("all", item.offset, item.stop))
        elif behind == "only":
            result.append(Words("the-", item.offset, item.stop))
    return result
