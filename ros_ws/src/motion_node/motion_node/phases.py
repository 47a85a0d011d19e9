# SPDX-License-Identifier: Apache-2.0
"""Phases: what a move comes to for the arm (5.1).

A phase ends with a switch: a pose of the hand at which it stands still while the fingers open or
close. Between two switches the mode is constant: what is held, and how high each stack is.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Final

import numpy as np
from numpy.typing import NDArray

from .blocks import Column
from .grasps import Grasp

PICK: Final = "pick"
PLACE: Final = "place"
HOME: Final = "home"


@dataclass(frozen=True)
class Switch:
    """Where the hand stands still at the end of a phase.

    Attributes:
        position_world: tool centre point [m]; the hand points straight down.
        yaw: direction of the fingers' motion, counter-clockwise from world x [rad].
        stack: index of the stack it belongs to.
    """

    position_world: tuple[float, float, float]
    yaw: float
    stack: int


@dataclass(frozen=True)
class Tool:
    """What hangs below the palm, as a box in the hand's frame: the fingers and a held block.

    Attributes:
        half_x, half_y: half extents along the hand's axes, y being the fingers' direction [m].
        bottom: z of the lower end in the hand's frame [m].
        held: name of the held block, or empty.
        finger: position of each finger joint when the hand arrives [m].
    """

    half_x: float
    half_y: float
    bottom: float
    held: str = ""
    finger: float = 0.0


@dataclass(frozen=True)
class Phase:
    """One phase: from the switch before to ``switch`` in a constant mode.

    Attributes:
        kind: ``pick``, ``place`` or ``home``.
        move: index of the move; the number of moves for ``home``.
        object_name: the block that the move is about; empty for ``home``.
        switch: where the phase ends; None: at the arm's home.
        start: where it starts, if it starts at a switch.
        tool: what hangs below the palm on the way.
        columns: the stacks on the way, a held block left out.
        grip: finger position commanded after the switch [m].
        grasp: how the block is taken; None for ``home``.
        grasps: how many ways to take it there are.
        choice: which of these it is.
    """

    kind: str
    move: int
    object_name: str
    switch: Switch | None
    start: Switch | None
    tool: Tool
    columns: tuple[Column, ...]
    grip: float
    grasp: Grasp | None = None
    grasps: int = 1
    choice: int = 0


@dataclass(frozen=True)
class PhasePath:
    """A solved phase.

    Attributes:
        phase: what it is about.
        q: configurations at equal steps, first and last included, shape (steps + 1, n) [rad].
    """

    phase: Phase
    q: NDArray[np.float64]
