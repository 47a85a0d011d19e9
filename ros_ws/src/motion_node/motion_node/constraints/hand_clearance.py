# SPDX-License-Identifier: Apache-2.0
"""The hand with what it holds keeps its distance to each stack."""

from __future__ import annotations

from collections.abc import Sequence

import casadi as ca
import numpy as np

from scene_graph import base_name

from ..nlp import Demand
from ..phases import Phase
from ..robots import Arm
from ..robots.model import ArmModel
from ..settings import PathSettings
from .constraint import Constraint
from .hulls import (
    COLUMN_SIZE,
    HAND_SIZE,
    HandBox,
    column_parameters,
    hand_parameters,
    split_columns,
)
from .situation import AlongPath, AtSwitch


def hand_in_words(phase: Phase) -> str:
    """The hand with what it holds."""
    return f"hand with {phase.tool.held}" if phase.tool.held else "hand"


class HandClearance(Constraint):
    """Rows: gap to each stack less the margin [m].

    Between the vertical ends the hand is quick, and may be on one side of a stack at one step and
    on the other side at the next; so half steps count there, too.

    Parameters: columns, the hand's box, height of the table, margin.
    """

    name = "hand_clearance"

    def __init__(self, arm: Arm) -> None:
        self._arm = arm

    def parameter_count(self, stacks: int) -> int:
        """See :class:`Constraint`."""
        return COLUMN_SIZE * stacks + HAND_SIZE + 2

    def expression(self, model: ArmModel, parameters: ca.SX, stacks: int) -> ca.SX:
        """See the class."""
        ends = np.cumsum([0, COLUMN_SIZE * stacks, HAND_SIZE, 1, 1]).tolist()
        columns, box, floor, margin = ca.vertsplit(parameters, ends)
        hand = HandBox(model, box)
        return ca.vertcat(*[hand.gap(column, floor) - margin for column in split_columns(columns)])

    def row_names(self, phase: Phase) -> Sequence[str]:
        """See :class:`Constraint`."""
        hand = hand_in_words(phase)
        return [f"clearance of {hand} to {base_name(i)}" for i in range(len(phase.columns))]

    def at_switch(self, moment: AtSwitch) -> Demand:
        """Apart from all stacks, the switch's own where the hand does not mean to touch it."""
        parameters = np.concatenate([moment.column_parameters, self._others(moment)])
        lower = np.zeros((1, len(moment.columns)))
        return Demand(parameters[None], lower, np.full_like(lower, np.inf))

    def path_steps(self, shape: PathSettings) -> tuple[float, ...]:
        """All, then half steps."""
        between = range(shape.vertical, shape.steps - shape.vertical)
        return (*super().path_steps(shape), *(step + 0.5 for step in between))

    def along_path(self, way: AlongPath) -> Demand:
        """Apart at each step."""
        whole = np.repeat([column_parameters(way.phase.columns)], way.between, axis=0)
        columns = np.concatenate([way.column_parameters, whole])
        others = np.repeat([self._others(way)], len(columns), axis=0)
        lower = np.zeros((len(columns), len(way.phase.columns)))
        parameters = np.concatenate([columns, others], axis=1)
        return Demand(parameters, lower, np.full_like(lower, np.inf))

    def _others(self, where: AtSwitch | AlongPath) -> list[float]:
        """The parameters behind the columns'."""
        box = hand_parameters(self._arm.gripper, where.phase.tool)
        return [*box, where.clear.floor, where.clear.margin]
