# SPDX-License-Identifier: Apache-2.0
"""The words around a name that mean nothing: verbs in front, who asks, what is left behind."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Final

from scene_graph import PREDICATES

from .language import MUTE, NEGATION, NOUN_VERBS, NUMBERS, TAKES
from .terms import Words

WANTS: Final = frozenset({
    "want", "wants", "requires", "requested", "requests", "expects", "demands", "asked",
})  # fmt: skip
_SKIPPED: Final = MUTE | TAKES | {NEGATION}


def asker(words: Sequence[Words]) -> int:
    """Where it is said who asks: "for the next trial we need red on blue"; 0 where nobody does."""
    asker = [index for index, item in enumerate(words) if item.text in {"i", "we"} | WANTS]
    if not asker or any(item.text == NEGATION for item in words[: asker[-1]]):
        return 0
    if all(item.text in _SKIPPED | WANTS for item in words[asker[-1] :]):
        return 0  # "red wants to be on blue"
    return asker[-1]


def verb_at_start(words: Sequence[Words]) -> int:
    """How many words at the start ask and name nothing."""
    index = 0
    while index < len(words) and words[index].text in _SKIPPED:
        rest = words[index + 1 :]
        if words[index].text in NOUN_VERBS and names_a_place(rest):
            break
        index += 1
    # What is denied is looked for behind.
    kept = [item for item in words[:index] if item.text == NEGATION]
    return words.index(kept[0]) if kept else index


def names_a_place(rest: Sequence[Words]) -> bool:
    """Whether "stack" or "place" in front of these words is a noun."""
    if not rest or rest[0].text.isdigit() or rest[0].text in NUMBERS:
        return True
    phrases = PREDICATES.phrases
    kept = tuple(item.text for item in rest if item.text not in ("is", "are"))
    return any(kept[: len(phrase)] == phrase for phrase in phrases)


def without_ends(words: Sequence[Words]) -> list[Words]:
    """Without the words at either end that mean nothing."""
    kept = list(words)
    while kept and kept[-1].text in (MUTE - NOUN_VERBS) | {"which"}:
        kept.pop()
    while kept and kept[0].text in MUTE - NOUN_VERBS:
        kept.pop(0)
    return kept
