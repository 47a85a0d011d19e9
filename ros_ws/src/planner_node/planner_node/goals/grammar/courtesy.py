# SPDX-License-Identifier: Apache-2.0
"""Courtesies that say nothing of blocks: "if it isn't too much trouble", "if you have a moment"."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from typing import Final

from .lexicon import COURTESY, COURTESY_DENIED, COURTLY

_DENIALS: Final = frozenset({"not", "no"})


def courtesies(words: Sequence[str], start: int) -> Iterator[int]:
    """Where a courtesy may end that begins at a word.

    What is no trouble may be denied, what is possible may not: "if it is not possible" is a
    condition.
    """
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
