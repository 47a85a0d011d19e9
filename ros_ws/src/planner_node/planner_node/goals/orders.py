# SPDX-License-Identifier: Apache-2.0
"""In which order a tower or a row is told: "from bottom to top", "from the ground up"."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Final

from scene_graph import LEFT, UP

#: The relation of each name to the one before, and whether the one before is its object.
ORDERS: Final = {
    "bottom-to-top": (UP, True),
    "top-to-bottom": (UP, False),
    "left-to-right": (LEFT, False),
    "right-to-left": (LEFT, True),
}
_ENDS: Final = {
    "bottom": "bottom", "base": "bottom", "ground": "bottom", "floor": "bottom",
    "below": "bottom", "top": "top",
    "above": "top", "left": "left", "right": "right",
}  # fmt: skip
_OPPOSITE: Final = {"bottom": "top", "top": "bottom", "left": "right", "right": "left"}
#: What may be in front: "in this order, starting from the bottom".
_BEFORE: Final = frozenset({
    "from", "starting", "start", "beginning", "counted", "counting", "reading", "read", "listed",
    "told", "named", "going", "ordered", "at",
})  # fmt: skip
_THIS_ORDER: Final = frozenset({("in", "that", "order"), ("in", "this", "order")})
_ONWARDS: Final = {
    "up": "bottom", "upwards": "bottom", "upward": "bottom", "down": "top", "downwards": "top",
    "downward": "top",
}  # fmt: skip


def order_at(texts: Sequence[str], before: str = "") -> tuple[str, int] | None:
    """The order that some words begin with, as one of :data:`ORDERS`, and how many words say so.

    Args:
        before: the word in front: "the second from the bottom" is no order.
    """
    start = 3 if tuple(texts[:3]) in _THIS_ORDER else 0
    at = start
    while at < len(texts) and texts[at] in _BEFORE:
        at += 1
    said = at > start and texts[at - 1] != "told"
    rest = texts[at:]
    if not rest:
        return None
    if said and texts[start] != "at" and rest[0] in _ONWARDS:
        return _named(_ONWARDS[rest[0]]), at + 1
    end = _ENDS.get(rest[0])
    if end is None:
        return None
    if len(rest) > 2 and rest[1] == "to" and _ENDS.get(rest[2]) == _OPPOSITE[end]:
        further = len(rest) > 3 and rest[3] == "of"
        return None if further else (_named(end), at + 3)
    if end not in ("bottom", "top") or before in ("second", "third", "fourth"):
        return None
    onwards = rest[1] if len(rest) > 1 else ""
    if _ONWARDS.get(onwards) == end or onwards == "first":
        return _named(end), at + 2
    if said and texts[at - 1] == "from" and onwards != "of":
        return _named(end), at + 1
    if at - start > 1 and texts[at - 1] == "at" and onwards != "of":
        return _named(end), at + 1
    return None


def _named(end: str) -> str:
    return f"{end}-to-{_OPPOSITE[end]}"
