# SPDX-License-Identifier: Apache-2.0
"""The error of words that relate nothing to nothing, and how goals are written."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from typing import Final

from scene_graph import PREDICATES, UP

from ..errors import InvalidGoalError
from .terms import Words

EXAMPLE: Final = "write relations like 'red on blue, green left of red'"


def no_relation(text: str, words: Sequence[Words]) -> InvalidGoalError:
    """The error of a part of a goal that relates nothing to nothing."""
    start, end = words[0].offset, words[-1].stop
    return InvalidGoalError(
        f"no relation found; known are {', '.join(_known())}; {EXAMPLE}", start, text[start:end]
    )


def _known() -> Iterator[str]:
    """One way to write each relation, its inverse, and its form for places."""
    for name in PREDICATES:
        predicate = PREDICATES[name]
        yield from predicate.phrases[:1]
        if name != UP:
            yield from predicate.inverse_phrases[:1]
            yield from predicate.place_phrases[:1]
