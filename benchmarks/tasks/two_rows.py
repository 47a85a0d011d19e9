# SPDX-License-Identifier: Apache-2.0
"""Places in two rows, one behind the other, and goals that say so (5.4.3)."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import Any, Final

import numpy as np

from scene_graph import FRONT, LEFT, PREDICATES, UP, Stacks, base_name
from sim_node import random_arrangement

_DIGITS: Final = 4
Range = tuple[float, float]
Point = tuple[float, float]


@dataclass(frozen=True)
class TwoRows:
    """Two rows of places, drawn anew for each task, and a camera that looks at them from above.

    Attributes:
        count: of the places of each row.
        gap: between neighbours of a row [m].
        apart: between the rows [m].
        front: distance of the front row from the arm's axis [m].
        camera: height of the camera over the table [m].
        covered: share of the tasks that begin with blocks behind a tower that is higher by two.
    """

    count: int = 3
    gap: Range = (0.14, 0.16)
    apart: Range = (0.16, 0.18)
    front: Range = (0.57, 0.60)
    camera: Range = (0.50, 0.75)
    covered: float = 0.5

    def places(self, rng: np.random.Generator) -> tuple[Point, ...]:
        """From the left of the image, the front row first, (x, y) on the table [m]."""
        gap, apart, front = (
            float(rng.uniform(*item)) for item in (self.gap, self.apart, self.front)
        )
        across = [(index - 0.5 * (self.count - 1)) * gap for index in range(self.count)]
        return tuple(
            (round(x, _DIGITS), round(y, _DIGITS)) for x in (front, front - apart) for y in across
        )

    def view(self, rng: np.random.Generator) -> dict[str, Any]:
        """The camera's entry in a scene file."""
        height = round(float(rng.uniform(*self.camera)), _DIGITS)
        return {"name": "camera", "position": [1.45, 0.0, height], "target": [0.5, 0.0, 0.08]}

    def layout(self, names: Sequence[str], rng: np.random.Generator) -> Stacks:
        """A random state; in some tasks a tower stands before a block."""
        covered = rng.random() < self.covered
        while True:
            state = random_arrangement(names, rng, 2 * self.count)
            towers = zip(state[: self.count], state[self.count :])
            if not covered or any(far and len(near) >= len(far) + 2 for near, far in towers):
                return state


def row_goal(wanted: Stacks, count: int, rng: np.random.Generator) -> str:
    """Some relations of a state in words, in front of and left of one another among them.

    Args:
        count: places of each row.
    """
    spots = {
        name: (index, level)
        for index, stack in enumerate(wanted)
        for level, name in enumerate(stack)
    }
    true: list[tuple[str, str, str]] = []
    for one, (stack, level) in sorted(spots.items()):
        below = wanted[stack][level - 1] if level else base_name(stack)
        true.append((one, UP, below))
        for other, (there, _) in sorted(spots.items()):
            if stack // count < there // count:
                true.append((one, FRONT, other))
            if stack % count < there % count:
                true.append((one, LEFT, other))
    fronts = [item for item in true if item[1] == FRONT]
    chosen = [fronts[int(rng.integers(len(fronts)))]] if fronts else []
    more = int(rng.integers(1, 3))
    for index in rng.permutation(len(true)):
        if len(chosen) <= more and true[index] not in chosen:
            chosen.append(true[index])
    return ", ".join(_told(item, rng) for item in chosen)


_INVERSE: Final[Mapping[str, str]] = {FRONT: "behind", LEFT: "right of"}


def _told(relation: tuple[str, str, str], rng: np.random.Generator) -> str:
    subject, predicate, object_ = relation
    if predicate in _INVERSE and rng.random() < 0.5:
        return f"{object_} {_INVERSE[predicate]} {subject}"
    return f"{subject} {PREDICATES[predicate].words} {object_}"
