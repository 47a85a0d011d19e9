# SPDX-License-Identifier: Apache-2.0
"""Which objects of a scene a name means, with its typos mended."""

from __future__ import annotations

import difflib
import re
from collections.abc import Sequence
from typing import Final

from scene_graph import (
    COLORS,
    SHAPES,
)

from ..errors import AmbiguousObjectError, UnknownObjectError
from .example import EXAMPLE
from .language import NOUNS, SYNONYMS
from .resolve_places import is_place_word, place_named, unknown_place
from .slips import mended
from .terms import Words

#: A name of nothing but these is that of a block, if not of one in the scene.
_LOOKS: Final = frozenset(COLORS) | frozenset(SHAPES) | NOUNS


def resolve_name(words: Words, names: Sequence[str], stack_count: int | None = None) -> str:
    """The object or base that is meant: by a full name, or any unambiguous part of one.

    A word that is none but is like one, and only one, is taken for it: "gren" for "green".

    Raises:
        UnknownObjectError, AmbiguousObjectError: see :func:`resolve_goal`.
    """
    candidates = fitting_names(words, names, stack_count)
    if len(candidates) > 1:
        raise AmbiguousObjectError(
            words.text,
            candidates,
            f"at offset {words.offset}: '{words.text}' fits {', '.join(candidates)}; say which",
        )
    return candidates[0]


def fitting_names(
    words: Words, names: Sequence[str], stack_count: int | None, every: bool = False
) -> list[str]:
    """All that a name fits; raises UnknownObjectError where that is nothing.

    Args:
        every: "red box" is red_box_2 as well, not only the one of just that name.
    """
    place = place_named(words, stack_count)
    if place is not None:
        return [place]
    by_full_name = {name.lower(): name for name in names}
    known = {part for name in by_full_name for part in name.split("_")}
    parts = [part for part in re.split(r"[ _-]+", words.text) if part]
    for right in (parts, _mended(parts, known)):
        if "_".join(right) in by_full_name and not (every and "_" not in words.text):
            return [by_full_name["_".join(right)]]
        wanted = {part if part in known else SYNONYMS.get(part, part) for part in right} - NOUNS
        candidates = sorted(name for name in names if wanted <= set(name.lower().split("_")))
        if candidates and right:
            return candidates
    if is_place_word(words.text):
        raise unknown_place(words, stack_count)
    raise _unknown_object(words, parts, names, known)


def _mended(parts: Sequence[str], known: set[str]) -> list[str]:
    """The words of a name without slips."""
    right = frozenset(known | NOUNS | SYNONYMS.keys())
    initials = {part[0]: part for part in known & set(COLORS)}
    if len(initials) == len(known & set(COLORS)):
        parts = [initials.get(part, part) for part in parts]  # "R on B"
    meant = [(part,) if part in right else mended(part, right) for part in parts]
    return [one[0] if len(one) == 1 else part for one, part in zip(meant, parts)]


def _unknown_object(
    words: Words, parts: Sequence[str], names: Sequence[str], known: set[str]
) -> UnknownObjectError:
    listed = f"the scene has {', '.join(sorted(names))}" if names else "the scene has no objects"
    full_name = "_".join(parts)
    close = difflib.get_close_matches(full_name, [*map(str.lower, names), *sorted(known)], n=1)
    hint = f"; did you mean '{close[0]}'?" if close else ""
    if parts and frozenset(parts) <= _LOOKS:
        hint += (
            "; if it is on the table, it stands on no place, or camera/extrinsics is not the "
            "camera's calibration"
        )
    elif parts and parts[0] not in known and known & set(parts[1:]):  # "polish red on blue"
        hint = f"; {EXAMPLE}"
    return UnknownObjectError(
        words.text,
        sorted(names),
        f"at offset {words.offset}: there is no '{words.text}'; {listed}{hint}",
    )
