# SPDX-License-Identifier: Apache-2.0
"""Courtesies that say nothing of blocks: "if it isn't too much trouble", "if you have a moment"."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from typing import Final

from .lexicon import COURTESY, COURTESY_DENIED, COURTLY

#: When it is to be so: "when everything's been done".
_WHEN: Final = frozenset({"when", "once", "after"})
_BEEN: Final = frozenset({
    "everything", "all", "it", "this", "that", "you", "we", "i", "they", "the", "robot", "work",
    "job", "task", "building", "stacking", "thing", "whole", "your", "our",
    "is", "are", "am", "has", "have", "had", "been", "'s", "be", "get", "gets", "got", "will",
})  # fmt: skip
_DONE: Final = frozenset(
    {"done", "finished", "ready", "complete", "completed", "finish", "through"}
)
_DENIALS: Final = frozenset({"not", "no"})


def courtesies(words: Sequence[str], start: int) -> Iterator[int]:
    """Where a courtesy may end that begins at a word.

    What is no trouble may be denied, what is possible may not: "if it is not possible" is a
    condition.
    """
    if words[start] in _WHEN:
        for at in range(start + 1, len(words)):
            if words[at] in _DONE and at > start + 1:
                yield at + 1
            if words[at] not in _BEEN:
                break
    if words[start] not in ("if", "when", "whenever"):
        return
    denied = said = False
    for at in range(start + 1, len(words)):
        word = words[at]
        if word in _DENIALS:
            denied = True
        elif word in (COURTESY_DENIED if denied else COURTESY):
            said = True
        elif word not in COURTLY and not word.endswith("ly"):
            return
        if said:
            yield at + 1
