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
from .language import (
    CLEAR,
    MODALS,
    MUTE,
    NOUNS,
    NUMBERS,
    OTHER_WORDS,
    POLITE,
    SYNONYMS,
    TAKES,
    meant,
)
from .resolve_places import is_place_word, place_named, unknown_place
from .said import EXAMPLE
from .terms import Words

#: Left out of a name where they were typed wrong.
_LEFT_OUT: Final = frozenset(MUTE) | {"the"}
#: No typos of what is in the scene.
_RIGHT: Final = (
    frozenset(COLORS) | frozenset(SHAPES) | NOUNS | OTHER_WORDS | CLEAR | TAKES | MUTE
    | frozenset(NUMBERS)
)  # fmt: skip

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


def fitting_names(words: Words, names: Sequence[str], stack_count: int | None) -> list[str]:
    """All that a name fits; raises UnknownObjectError where that is nothing."""
    place = place_named(words, stack_count)
    if place is not None:
        return [place]
    by_full_name = {name.lower(): name for name in names}
    known = {part for name in by_full_name for part in name.split("_")}
    parts = [part for part in re.split(r"[ _-]+", words.text) if part]
    for mended in (parts, _mended(parts, known)):
        if "_".join(mended) in by_full_name:
            return [by_full_name["_".join(mended)]]
        wanted = {part if part in known else SYNONYMS.get(part, part) for part in mended} - NOUNS
        candidates = sorted(name for name in names if wanted <= set(name.lower().split("_")))
        if candidates and mended:
            return candidates
    if is_place_word(words.text):
        raise unknown_place(words, stack_count)
    raise _unknown_object(words, parts, names, known)


def _mended(parts: Sequence[str], known: set[str]) -> list[str]:
    """The words of a name without typos, and without those around it that mean nothing.

    In front there may be a verb, behind a "should" or "please", typed wrong; in between nothing is
    left out.
    """
    right = [
        meant(part, known | NOUNS | SYNONYMS.keys(), _RIGHT) or _shortened(part, known)
        for part in parts
    ]
    first, last = 0, len(parts)
    while first < last and right[first] is None and _means_nothing(parts[first], _LEFT_OUT):
        first += 1
    while (
        first < last
        and right[last - 1] is None
        and _means_nothing(parts[last - 1], MODALS | POLITE)
    ):
        last -= 1
    kept = [word or part for word, part in zip(right[first:last], parts[first:last])]
    return [one for part in kept for one in _apart(part, known)]


def _means_nothing(part: str, known: frozenset[str]) -> bool:
    """Whether it is one of these with a typo; the shorter a word, the more it is like others."""
    return part in known or (len(part) > 4 and meant(part, known, _RIGHT) is not None)


def _shortened(part: str, known: set[str]) -> str | None:
    """The one word of which letters were left out: "yel" or "ylw" for "yellow"."""
    if len(part) < 2 or part in _RIGHT:
        return None
    found = [word for word in known if word[0] == part[0] and _in_order(part, word)]
    if len(part) == 2:
        found = [word for word in found if len(word) == 3]  # "rd", "bx"
    return found[0] if len(found) == 1 else None


def _in_order(letters: str, word: str) -> bool:
    """Whether a word has these letters in this order."""
    rest = iter(word)
    return all(letter in rest for letter in letters)


def _apart(part: str, known: set[str]) -> list[str]:
    """ "redbox" as two words."""
    for word in known:
        if part not in known and part.startswith(word) and part.removeprefix(word) in known | NOUNS:
            return [word, part.removeprefix(word)]
    return [part]


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
