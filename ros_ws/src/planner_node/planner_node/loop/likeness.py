# SPDX-License-Identifier: Apache-2.0
"""Which of the blocks of a plan those are that one frame shows.

A frame names blocks by what it shows. Of two that look alike the left one is the first, so the
names change hands when one is carried past the other; and of one that lies the shape is a guess.
"""

from __future__ import annotations

from collections.abc import Iterable, Mapping, Sequence

from scene_graph import SceneObject, object_name

from .expectation import Rest


def by_name(
    objects: Iterable[SceneObject], states: Sequence[Mapping[str, Rest | None]]
) -> dict[str, SceneObject]:
    """What is seen, by the names of the plan where it is one of its blocks.

    Args:
        states: where the blocks may be to rest; all have the same names.
    """
    seen = {item.name: item for item in objects}
    for names in _alike(states[0]):
        items = [seen.pop(name) for name in names if name in seen]
        left = []
        for name in names:  # those that are where they are to be
            rests = [rest for state in states if (rest := state[name]) is not None]
            there = [i for i in items if any(rest.holds(i.position_world) for rest in rests)]
            if there:
                seen[name] = there[0]
                items.remove(there[0])
            else:
                left.append(name)
        seen.update(zip(left, items))
    for name, item in [entry for entry in seen.items() if entry[0] not in states[0]]:
        if not all(item.size):
            unseen = states[0].keys() - seen.keys()
            same_color = [other for other in unseen if other.split("_")[0] == item.color]
            if len(same_color) == 1:
                seen[same_color[0]] = seen.pop(name)
    return seen


def _alike(names: Iterable[str]) -> list[list[str]]:
    """Those of which a scene has more than one, in order: ``red_box``, ``red_box_2``, …"""
    groups: dict[str, list[str]] = {}
    for name in sorted(names):
        color, shape, *_ = name.split("_")
        groups.setdefault(object_name(color, shape), []).append(name)
    return [group for group in groups.values() if len(group) > 1]
