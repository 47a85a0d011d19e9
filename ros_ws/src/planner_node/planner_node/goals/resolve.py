# SPDX-License-Identifier: Apache-2.0
"""What a goal means in the scene that is seen: its names become objects and places."""

from __future__ import annotations

import difflib
import re
from collections.abc import Sequence
from typing import Final

from scene_graph import Relation, Stacks, base_index, base_name

from ..errors import AmbiguousObjectError, GoalImageError, UnknownObjectError
from .goal import Goal, complete_goal
from .parse import EXAMPLE, ParsedRelation, Words

#: Words that fit every object.
NOUNS: Final = frozenset({"block", "object"})

#: What people call a place, with or without a number; only ``stack0`` … are places.
_PLACE: Final = re.compile(
    r"(stack|place|position|spot|slot|column|pile|tower|base)s?[ _-]*\d*"
    r"|table|tabletop|floor|ground|desk|surface"
)


def resolve_goal(
    parsed: Sequence[ParsedRelation], names: Sequence[str], stack_count: int | None = None
) -> Goal:
    """Finds the objects that the names of a parsed goal mean; repeated relations count once.

    Args:
        stack_count: how many places the scene has; None where any may exist.

    Raises:
        UnknownObjectError: if a name fits no object and no place of the scene.
        AmbiguousObjectError: if a name fits several.
    """
    relations: dict[Relation, None] = {}
    for item in parsed:
        subject = resolve_name(item.subject, names, stack_count)
        object_ = resolve_name(item.object, names, stack_count)
        if item.phrase.inverse:
            subject, object_ = object_, subject
        relations[Relation(subject, item.phrase.predicate.name, object_)] = None
    return Goal(tuple(relations))


def resolve_name(words: Words, names: Sequence[str], stack_count: int | None = None) -> str:
    """The object or base that is meant: by a full name, or any unambiguous part of one.

    Raises:
        UnknownObjectError, AmbiguousObjectError: see :func:`resolve_goal`.
    """
    if (base := words.base) is not None:
        index = base_index(base)
        if stack_count is not None and index is not None and index >= stack_count:
            raise _unknown_place(words, stack_count)
        return base
    parts = re.split(r"[ _]+", words.text)
    by_full_name = {name.lower(): name for name in names}
    full_name = "_".join(parts)
    if full_name in by_full_name:
        return by_full_name[full_name]
    wanted = set(parts) - NOUNS
    candidates = sorted(name for name in names if wanted <= set(name.lower().split("_")))
    if len(candidates) == 1:
        return candidates[0]
    where = f"at offset {words.offset}"
    if candidates:
        raise AmbiguousObjectError(
            words.text,
            candidates,
            f"{where}: '{words.text}' fits {', '.join(candidates)}; say which",
        )
    if _PLACE.fullmatch(words.text):
        raise _unknown_place(words, stack_count)
    known = sorted(names)
    listed = f"the scene has {', '.join(known)}" if known else "the scene has no objects"
    known_parts = {part for name in by_full_name for part in name.split("_")}
    close = difflib.get_close_matches(full_name, [*by_full_name, *sorted(known_parts)], n=1)
    hint = f"; did you mean '{close[0]}'?" if close else ""
    if parts[0] not in known_parts and known_parts & set(parts[1:]):  # "build red on blue"
        hint = f"; {EXAMPLE}"
    raise UnknownObjectError(
        words.text, known, f"{where}: there is no '{words.text}'; {listed}{hint}"
    )


def _unknown_place(words: Words, stack_count: int | None) -> UnknownObjectError:
    """What to say of a name that looks like a place and is none."""
    if stack_count is None:
        known: tuple[str, ...] = ()
        listed = f"places are called {base_name(0)}, {base_name(1)}, … from the left"
    else:
        known = tuple(base_name(index) for index in range(stack_count))
        listed = f"the places are {', '.join(known)} from the left"
    numbered = re.search(r"\d", words.text)
    example = "" if numbered else f"; write which one, such as 'red on {base_name(0)}'"
    return UnknownObjectError(
        words.text,
        known,
        f"at offset {words.offset}: there is no place '{words.text}'; {listed}{example}",
    )


def goal_of_picture(shown: Stacks, seen: Stacks) -> Goal:
    """The complete goal that a goal image shows (A.2.6), for the scene that is seen.

    Raises:
        GoalImageError: the image shows other objects, or another number of stacks.
    """
    in_picture = {name for stack in shown for name in stack}
    in_scene = {name for stack in seen for name in stack}
    missing, extra = sorted(in_scene - in_picture), sorted(in_picture - in_scene)
    if missing or extra:
        differences = [
            f"{', '.join(names)} {verb}"
            for names, verb in ((missing, "missing in the image"), (extra, "not in the scene"))
            if names
        ]
        raise GoalImageError(
            f"the goal image shows other objects than the scene: {'; '.join(differences)}",
            missing,
            extra,
        )
    if len(shown) != len(seen):
        raise GoalImageError(f"the goal image shows {len(shown)} stacks, the scene has {len(seen)}")
    return complete_goal(shown)
