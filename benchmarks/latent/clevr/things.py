# SPDX-License-Identifier: Apache-2.0
"""The true graph of a scene: things, what they are like, and how they stand to one another."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Final

import numpy as np

from scene_graph import BOX, CYLINDER, FLAT_TOPPED, SPHERE

#: What things are like, and the words for it.
ATTRIBUTES: Final[dict[str, tuple[str, ...]]] = {
    "size": ("small", "large"),
    "color": ("red", "green", "blue", "yellow", "purple", "cyan"),
    "shape": (BOX, CYLINDER, SPHERE),
}
#: Edges and diameters [m].
EDGES: Final = {"small": 0.035, "large": 0.06}
RELATIONS: Final = ("left", "right", "front", "behind", "above", "below")

#: Where things stand on the table, x and y in world [m].
_AREA: Final = ((0.32, 0.72), (-0.24, 0.24))
#: Between the middles of things that stand beside one another, at least this along x or y; so what
#: is left or in front of what can be seen [m].
_CLEAR: Final = 0.03
#: Things at least [m] from another's middle, both ways together.
_APART: Final = 0.085
_ON_TOP: Final = 0.3
_TRIES: Final = 200


@dataclass(frozen=True)
class Thing:
    """One thing.

    Attributes:
        size, color, shape: words of :data:`ATTRIBUTES`.
        position_world: of its middle [m].
        yaw: about world's z [rad].
        on: number of the thing that it stands on; -1: on the table.
    """

    size: str
    color: str
    shape: str
    position_world: tuple[float, float, float]
    yaw: float
    on: int = -1

    def has(self, words: Sequence[str]) -> bool:
        """Whether all of the words are true of it."""
        return all(word in (self.size, self.color, self.shape) for word in words)


#: Things in the order in which they were put down.
Scene = tuple[Thing, ...]


def related(scene: Scene, relation: str, anchor: int) -> frozenset[int]:
    """What stands in a relation to a thing: seen from the camera, which looks along -x.

    Above and below hold within one stack only, and nothing of one stack is beside another of it.
    """
    here = scene[anchor]
    stack = _stack(scene, anchor)
    if relation in ("above", "below"):
        sign = 1.0 if relation == "above" else -1.0
        height = here.position_world[2]
        return frozenset(i for i in stack if sign * (scene[i].position_world[2] - height) > 1e-6)
    axis, sign = {"left": (1, -1.0), "right": (1, 1.0), "front": (0, 1.0), "behind": (0, -1.0)}[
        relation
    ]
    return frozenset(
        i
        for i, thing in enumerate(scene)
        if i not in stack and sign * (thing.position_world[axis] - here.position_world[axis]) > 0.0
    )


def _stack(scene: Scene, index: int) -> frozenset[int]:
    root = index
    while scene[root].on >= 0:
        root = scene[root].on
    found = {root}
    while more := {i for i, thing in enumerate(scene) if thing.on in found} - found:
        found |= more
    return frozenset(found)


def random_scene(rng: np.random.Generator, least: int = 3, most: int = 6) -> Scene:
    """Things apart enough that every relation can be seen."""
    count = int(rng.integers(least, most + 1))
    scene: list[Thing] = []
    for _ in range(_TRIES):
        if len(scene) == count:
            break
        thing = _draw(rng, scene)
        if thing is not None:
            scene.append(thing)
    return tuple(scene) if len(scene) == count else random_scene(rng, least, most)


def _draw(rng: np.random.Generator, scene: Sequence[Thing]) -> Thing | None:
    size, color, shape = (str(rng.choice(values)) for values in ATTRIBUTES.values())
    edge = EDGES[size]
    yaw = float(rng.uniform(-0.5, 0.5))
    below = int(rng.integers(len(scene))) if scene and rng.random() < _ON_TOP else -1
    if below >= 0:
        support = scene[below]
        taken = any(thing.on == below for thing in scene)
        wide = edge <= EDGES[support.size]
        if taken or not wide or support.shape not in FLAT_TOPPED:
            return None
        x, y, z = support.position_world
        height = z + 0.5 * EDGES[support.size] + 0.5 * edge
        return Thing(size, color, shape, (x, y, height), yaw, below)
    x, y = (float(rng.uniform(*span)) for span in _AREA)
    for other in scene:
        if other.on < 0:
            dx, dy = abs(x - other.position_world[0]), abs(y - other.position_world[1])
            if min(dx, dy) < _CLEAR or np.hypot(dx, dy) < _APART:
                return None
    return Thing(size, color, shape, (x, y, 0.5 * edge), yaw)
