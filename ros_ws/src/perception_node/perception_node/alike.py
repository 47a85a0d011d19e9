# SPDX-License-Identifier: Apache-2.0
"""Blocks that look alike keep their names while they move: they are followed over pictures."""

from __future__ import annotations

import math
import re
from dataclasses import replace
from typing import Final

from scene_graph import GraphStatus, SceneObject, is_hidden, object_name

from .pipeline import Perceived

Point = tuple[float, float, float]

#: A block that is seen this near to where it was is the same one, where no other one is [m].
NEAR: Final = 0.02
#: In pictures that follow one another as fast [ns], a block can have moved so far [m],
FAST: Final = 300_000_000
REACH: Final = 0.1
#: and is told from others that are so many times as far away.
APART: Final = 2.0
#: Who was not seen for so long is forgotten, if no block of the kind is left [ns].
FORGOTTEN: Final = 30_000_000_000


class Alike:
    """Remembers where blocks were that look like another one, and by which names.

    A block that is seen where one of its kind was has that one's name. Of those that are left, one
    name and one block belong together: it was moved. Where several of a kind moved between two
    frames nobody knows which is which: they get names that none had, so that names are never
    exchanged, and what was planned with the old ones is seen to be over.
    """

    def __init__(self) -> None:
        self._seen: dict[str, dict[str, Point]] = {}
        self._given: dict[str, int] = {}
        self._stamps: dict[str, int] = {}
        self._stamp = 0
        self._reach = 0.0

    def named(self, perceived: Perceived, stamp: int) -> Perceived:
        """The same with names as they were before.

        Args:
            perceived: a graph whose blocks of a kind are numbered anyhow; only where it is
                confident all of them are seen.
            stamp: when its picture was taken [ns].
        """
        graph, status = perceived.graph, perceived.status
        if stamp < self._stamp:  # the clock went back: another scene
            self._seen, self._given, self._stamps = {}, {}, {}
        self._reach = REACH if stamp - self._stamp <= FAST else 0.0
        self._stamp = stamp
        kinds: dict[str, list[SceneObject]] = {}
        for item in graph.objects:
            if is_hidden(item.name):  # no block: it is named by its place
                continue
            if not all(item.size):
                return perceived
            kinds.setdefault(object_name(item.color, item.shape), []).append(item)
        names = {}
        for kind, items in kinds.items():
            names.update(self._named(kind, items, status))
            self._stamps[kind] = stamp
        if status.sees_all:
            for kind in set(self._seen) - set(kinds):
                self._forget(kind)
        if all(old == new for old, new in names.items()):
            return perceived
        message = re.sub(r"\w+", lambda word: names.get(word[0], word[0]), perceived.message)
        return replace(perceived, graph=graph.renamed(names), message=message)

    def _forget(self, kind: str) -> None:
        if self._stamp - self._stamps.get(kind, 0) > FORGOTTEN:
            self._seen.pop(kind, None)
            self._given.pop(kind, None)

    def _named(self, kind: str, items: list[SceneObject], status: GraphStatus) -> dict[str, str]:
        """The names of blocks of a kind by those in the graph."""
        before = self._seen.get(kind)
        if before is None:
            self._seen[kind] = {item.name: item.position_world for item in items}
            self._given[kind] = len(items)
            return {}
        found: dict[str, SceneObject] = {}
        left = sorted(items, key=lambda item: item.name)
        for pairs in (self._near, self._moved):
            missing = [name for name in before if name not in found]
            for name, item in pairs(before, missing, left):
                found[name] = item
                left.remove(item)
        missing = [name for name in before if name not in found]
        guessed: dict[str, str] = {}
        if len(left) == 1 and len(missing) == 1:
            found[missing.pop()] = left.pop()
        elif left and missing and not status.sees_all:
            # Who is who may be seen yet: nothing is learnt of this picture.
            guessed = dict(zip((item.name for item in left), sorted(missing)))
            left = left[len(missing) :]
        elif left and missing:  # who is who is not known
            for name in missing:
                del before[name]
            missing = []
        for item in left:
            self._given[kind] += 1
            found[f"{kind}_{self._given[kind]}"] = item
        for name, item in found.items():
            before[name] = item.position_world
        if status.sees_all:  # all are seen: who is not there is gone
            for name in missing:
                del before[name]
        return {item.name: name for name, item in found.items()} | guessed

    @staticmethod
    def _near(
        before: dict[str, Point], missing: list[str], left: list[SceneObject]
    ) -> list[tuple[str, SceneObject]]:
        """Names and the blocks that stand where their owners stood."""
        here = [
            (name, item)
            for name in missing
            for item in left
            if math.dist(item.position_world, before[name]) < NEAR
        ]
        return [
            (name, item)
            for name, item in here
            if sum(name == other for other, _ in here) == 1
            and sum(item is other for _, other in here) == 1
        ]

    def _moved(
        self, before: dict[str, Point], missing: list[str], left: list[SceneObject]
    ) -> list[tuple[str, SceneObject]]:
        """Names and the blocks that can only be their owners, a moment later."""
        pairs = []
        for name in missing:
            for item in left:
                far = math.dist(item.position_world, before[name])
                others = [
                    *(math.dist(item.position_world, before[other])
                      for other in missing if other != name),
                    *(math.dist(other.position_world, before[name])
                      for other in left if other is not item),
                ]  # fmt: skip
                if far < self._reach and APART * far < min(others, default=math.inf):
                    pairs.append((name, item))
        return pairs
