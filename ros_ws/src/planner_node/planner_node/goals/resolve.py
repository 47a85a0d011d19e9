# SPDX-License-Identifier: Apache-2.0
"""What a goal means in the scene that is seen: its names become objects and places."""

from __future__ import annotations

import difflib
import re
from collections.abc import Sequence
from typing import Final

from scene_graph import Relation, Stacks

from ..errors import AmbiguousObjectError, GoalImageError, UnknownObjectError
from .goal import Goal, complete_goal
from .parse import ParsedRelation, Words

#: Words that fit every object.
NOUNS: Final = frozenset({"block", "object"})


def resolve_goal(parsed: Sequence[ParsedRelation], names: Sequence[str]) -> Goal:
    """Finds the objects that the names of a parsed goal mean; repeated relations count once.

    Raises:
        UnknownObjectError: if a name fits no object of the scene.
        AmbiguousObjectError: if a name fits several.
    """
    relations: dict[Relation, None] = {}
    for item in parsed:
        subject, object_ = resolve_name(item.subject, names), resolve_name(item.object, names)
        if item.phrase.inverse:
            subject, object_ = object_, subject
        relations[Relation(subject, item.phrase.predicate.name, object_)] = None
    return Goal(tuple(relations))


def resolve_name(words: Words, names: Sequence[str]) -> str:
    """The object or base that is meant: by a full name, or any unambiguous part of one.

    Raises:
        UnknownObjectError, AmbiguousObjectError: see :func:`resolve_goal`.
    """
    if words.base is not None:
        return words.base
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
    known = sorted(names)
    listed = f"the scene has {', '.join(known)}" if known else "the scene has no objects"
    known_parts = {part for name in by_full_name for part in name.split("_")}
    close = difflib.get_close_matches(full_name, [*by_full_name, *sorted(known_parts)], n=1)
    hint = f"; did you mean '{close[0]}'?" if close else ""
    raise UnknownObjectError(
        words.text, known, f"{where}: there is no '{words.text}'; {listed}{hint}"
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
