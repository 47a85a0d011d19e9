# SPDX-License-Identifier: Apache-2.0
"""Names of places: "the left pile", "the second stack from the right", "stacks 0 and 2"."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Final

from .language import PLACE_NOUNS, PLURALS, SIDES, meant
from .terms import Words, number_of

_ORDINALS: Final = {
    "first": 0, "1st": 0, "second": 1, "2nd": 1, "third": 2, "3rd": 2, "fourth": 3, "4th": 3,
    "fifth": 4, "5th": 4,
}  # fmt: skip
_INSIDE: Final = frozenset({"in", "into", "to", "at", "inside"})
_FURTHEST: Final = frozenset({"far", "very", "outer", "outermost"})
#: Behind a number, they say that it counts something: "in stack 1 and 2 blocks in stack 0".
_COUNTED: Final = PLURALS.keys() | {"block", "in", "on", "of", "more", "other", "others"}


def place_at(words: Sequence[Words], before: str = "") -> tuple[list[Words], int] | None:
    """The names of the places that some words begin with, and how many words they are.

    A place with a number keeps its words; what is told from a side becomes "left stack" or
    "stack 1 from right". Several are joined by "and" or "or", as they were.
    """
    texts = [item.text for item in words]
    return (
        _beside(words, texts, before)
        or _on_side(words, texts)
        or _from_side(words, texts, before)
        or _several(words)
    )


def _beside(
    words: Sequence[Words], texts: Sequence[str], before: str
) -> tuple[list[Words], int] | None:
    """ "left stack" as the name of a place; in "left stack 1", left is a relation."""
    at = int(texts[0] in _FURTHEST)
    behind = texts[at + 1 : at + 3]
    known = SIDES.keys() if behind[:1] and behind[0] in PLACE_NOUNS else ()
    side = SIDES.get(meant(texts[at], known) or texts[at]) if at < len(texts) else None
    if side is None:
        return None
    noun = bool(behind) and (meant(behind[0], PLACE_NOUNS, SIDES) or "") in PLACE_NOUNS
    # "in the leftmost one", "in the far left", "all the way to the right" name places too.
    furthest = at > 0 or texts[at].endswith("most")
    inside = before in _INSIDE and furthest
    if not noun and inside and behind[:1] != ["of"]:
        used = at + 1 + int(behind[:1] == ["one"])
    elif noun and (before in _INSIDE or not behind[1:] or number_of(behind[1]) is None):
        used = at + 2
    else:
        return None
    return [Words(f"{side} stack", words[0].offset, words[used - 1].stop)], used


def _on_side(words: Sequence[Words], texts: Sequence[str]) -> tuple[list[Words], int] | None:
    """ "stack on the left"."""
    if texts[0] not in PLACE_NOUNS or len(texts) < 3 or texts[1] not in ("on", "at"):
        return None
    far = 2 + (texts[2] in _FURTHEST)
    side = SIDES.get(texts[far]) if far < len(texts) else None
    used = far + 1 + (list(texts[far + 1 : far + 2]) == ["side"])
    if side is None or list(texts[used : used + 1]) == ["of"]:
        return None
    return [Words(f"{side} stack", words[0].offset, words[used - 1].stop)], used


def _from_side(
    words: Sequence[Words], texts: Sequence[str], before: str
) -> tuple[list[Words], int] | None:
    """ "second stack from the left"."""
    number = _ORDINALS.get(texts[0])
    if number is None:
        return None
    noun = len(texts) > 1 and (texts[1] in PLACE_NOUNS or texts[1] == "one")
    if not noun and before not in _INSIDE:
        return None
    used = 1 + int(noun)
    used += list(texts[used : used + 1]) in (["counting"], ["counted"])
    if list(texts[used : used + 1]) != ["from"] or len(texts) < used + 2:
        return None
    side = texts[used + 1]
    if side not in ("left", "right"):
        return None
    name = f"stack {number}" if side == "left" else f"stack {number} from right"
    return [Words(name, words[0].offset, words[used + 1].stop)], used + 2


def _several(words: Sequence[Words]) -> tuple[list[Words], int] | None:
    """ "stacks 0 and 1", "stack 0 or 2": a number that ends a clause belongs to the place."""
    noun = PLURALS.get(words[0].text, words[0].text)
    plural = noun != words[0].text
    if noun not in PLACE_NOUNS:
        return None
    found: list[Words] = []
    used = 1
    while used < len(words) and number_of(words[used].text) is not None:
        if found and words[used + 1 : used + 2] and not plural:
            break
        if words[used + 1 : used + 2] and words[used + 1].text in _COUNTED and found:
            break
        number = words[used]
        if found:
            found.append(words[used - 1])
        start = number.offset if found else words[0].offset
        found.append(Words(f"stack {number_of(number.text)}", start, number.stop))
        used += 1
        if used < len(words) and words[used].text in ("and", "or"):
            used += 1
        else:
            return (found, used) if len(found) > 1 else None
    return (found, used - 1) if len(found) > 1 else None
