# SPDX-License-Identifier: Apache-2.0
"""What a disturbance is; each kind is a module beside this one."""

from __future__ import annotations

from dataclasses import dataclass
from typing import ClassVar, Final

import numpy as np

from ..controller import CommandsMotors
from ..world import World
from .hand import touched_block
from .request import DisturbanceError, Request, Vector


@dataclass(frozen=True)
class Stage:
    """What a disturbance can lay hands on.

    Attributes:
        block: that of the event which was waited for; empty where there was none.
    """

    world: World
    arm: CommandsMotors
    block: str = ""


class Disturbance:
    """One thing that goes wrong: it begins, acts before each step of the physics, and ends.

    It is made, and all its methods are called, by the thread that owns the physics.

    Attributes:
        uses: which amounts of a request it understands, by their names in
            :class:`~sim_node.disturbance.request.Request`.
        alone: whether there can be only one of its kind at a time.
        seconds: for how long it acts [s]; 0: all is done when it has begun.
        sentence: what happens, for people; without the time.

    Args:
        request: its amounts; raises DisturbanceError for impossible ones.
    """

    uses: ClassVar[frozenset[str]] = frozenset()
    alone: ClassVar[bool] = False
    seconds: float = 0.0
    sentence: str

    def __init__(self, request: Request) -> None:
        raise NotImplementedError

    def check(self, stage: Stage) -> None:
        """When it is asked for.

        Raises:
            DisturbanceError: it can never happen, such as to a block that is not there.
        """

    def begin(self, stage: Stage) -> None:
        """When its moment has come.

        Raises:
            DisturbanceError: it cannot happen as things are now; nothing has been changed.
        """

    def act(self, stage: Stage) -> None:
        """Before each step of the physics, ``seconds`` long; after the arm's own command."""

    def end(self, stage: Stage) -> None:
        """Afterwards."""


#: Where pushes go if nobody says anything.
ALONG_X: Final[Vector] = (1.0, 0.0, 0.0)
ALONG_Y: Final[Vector] = (0.0, 1.0, 0.0)


def unit(direction: Vector, default: Vector, horizontal: bool = False) -> Vector:
    """A direction of length 1.

    Raises:
        DisturbanceError: it points up or down where only the table's plane is possible.
    """
    vector = np.array(direction if any(direction) else default)
    if horizontal and vector[2] != 0.0:
        raise DisturbanceError(
            f"direction {_triple(direction)} leaves the table's plane; its z has to be 0"
        )
    x, y, z = vector / np.abs(vector).max() / np.linalg.norm(vector / np.abs(vector).max())
    return float(x), float(y), float(z)


def along(direction: Vector) -> str:
    """``towards (0, 1, 0)``, for sentences."""
    return f"towards {_triple(direction)}"


def named_blocks(request: Request, least: int, most: int) -> tuple[str, ...]:
    """The blocks of a request; raises DisturbanceError for too few, too many, or one twice."""
    names = request.blocks
    if not least <= len(names) <= most:
        wanted = f"{least}" if least == most else f"{least} or {most}"
        plural = "" if wanted == "1" else "s"
        raise DisturbanceError(f"{request.kind} takes {wanted} block{plural}, not {len(names)}")
    if len(set(names)) < len(names):
        raise DisturbanceError(f"{request.kind} takes {most} different blocks")
    return names


def check_there(stage: Stage, *names: str) -> None:
    """Raises DisturbanceError, with the names of those that are, if a block is not there."""
    for name in names:
        if name not in stage.world.names:
            there = ", ".join(sorted(stage.world.names)) or "none"
            raise DisturbanceError(f"there is no block {name!r}; there are {there}")


def block_in_hand(stage: Stage) -> str:
    """The block in the hand; raises DisturbanceError if there is none."""
    if not (name := touched_block(stage.world)):
        raise DisturbanceError("no block is in the hand")
    return name


def _triple(vector: Vector) -> str:
    return "(" + ", ".join(f"{value:.3g}" for value in vector) + ")"
