# SPDX-License-Identifier: Apache-2.0
"""What constraints are told of a phase: the moment of its switch, and the way through it."""

from __future__ import annotations

from dataclasses import dataclass, replace
from functools import cached_property

import numpy as np
from numpy.typing import NDArray

from ..blocks import Column
from ..phases import Phase, Switch
from ..robots import Arm
from ..settings import PathSettings
from .hulls import column_parameters
from .smooth import SMOOTHING

Array = NDArray[np.float64]


@dataclass(frozen=True)
class Clearances:
    """Distances that are kept.

    Attributes:
        margin: between the arm with what it holds and the blocks and the table [m].
        floor: height of the table [m].
        extra: kept from obstacles besides, between the vertical ends of a phase [m].
    """

    margin: float
    floor: float
    extra: float = 0.0

    @property
    def reserve(self) -> float:
        """At which a gap counts as the margin at the latest, smoothed as it is [m]."""
        return self.margin + SMOOTHING


def lowered(phase: Phase, switch: Switch, arm: Arm, clear: Clearances) -> tuple[Column, ...]:
    """The stacks of a phase while the hand moves vertically to or from a switch.

    The stack of the switch ends below what hangs from the palm: there the hand means to touch it,
    and the vertical line keeps it apart.
    """
    bottom = switch.position_world[2] + arm.gripper.tcp_offset - phase.tool.bottom
    top = bottom - clear.reserve - 0.002
    own = phase.columns[switch.stack]
    result = list(phase.columns)
    result[switch.stack] = replace(own, top=min(own.top, float(top)))
    return tuple(result)


@dataclass(frozen=True)
class AtSwitch:
    """The end of a phase, for P1 and P2.

    Attributes:
        phase: one that ends with a switch.
    """

    arm: Arm
    phase: Phase
    clear: Clearances

    @property
    def switch(self) -> Switch:
        """Where the phase ends."""
        assert self.phase.switch is not None
        return self.phase.switch

    @cached_property
    def columns(self) -> tuple[Column, ...]:
        """The stacks as they count while the hand moves vertically to or from the switch."""
        return lowered(self.phase, self.switch, self.arm, self.clear)

    @cached_property
    def column_parameters(self) -> Array:
        """``columns`` for :mod:`hulls`, shape (5 stacks,) [m]."""
        return column_parameters(self.columns)


@dataclass(frozen=True)
class VerticalEnd:
    """One end of a phase: a vertical line that the hand follows there.

    Attributes:
        reference: x, y [m] and yaw [rad] of the line.
        height, lift: where the line ends at the switch, and how far it reaches upwards [m].
        columns: the stacks as they count along the line.
    """

    reference: Array
    height: float
    lift: float
    columns: tuple[Column, ...]


@dataclass(frozen=True)
class AlongPath:
    """The steps of a phase between its ends, for P3.

    Attributes:
        shape: how the phase is divided.
        first, last: its vertical ends; None where it has none.
    """

    arm: Arm
    phase: Phase
    clear: Clearances
    shape: PathSettings
    first: VerticalEnd | None
    last: VerticalEnd | None

    @property
    def steps(self) -> int:
        """Number of the steps: all but the first and the last configuration."""
        return self.shape.steps - 1

    @property
    def between(self) -> int:
        """Number of the half steps that lie between those of the vertical ends."""
        return self.shape.steps - 2 * self.shape.vertical

    @cached_property
    def vertical(self) -> list[tuple[VerticalEnd, slice]]:
        """The vertical ends and their steps, counted from 0."""
        near = self.shape.vertical
        ends = [(self.first, slice(0, near)), (self.last, slice(self.steps - near, self.steps))]
        return [(end, here) for end, here in ends if end]

    @cached_property
    def column_parameters(self) -> Array:
        """The stacks as they count at each step, for :mod:`hulls`, shape (steps, 5 stacks) [m]."""
        result = np.repeat(column_parameters(self.phase.columns)[None], self.steps, axis=0)
        for end, here in self.vertical:
            result[here] = column_parameters(end.columns)
        return result
