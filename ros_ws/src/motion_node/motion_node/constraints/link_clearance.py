# SPDX-License-Identifier: Apache-2.0
"""The links behind the hand keep their distance to each stack."""

from __future__ import annotations

from collections.abc import Sequence

import casadi as ca
import numpy as np

from scene_graph import base_name

from ..nlp import Demand
from ..phases import Phase
from ..robots import Arm
from ..robots.model import ArmModel
from .constraint import Constraint
from .hulls import COLUMN_SIZE, sphere_gap, split_columns
from .situation import AlongPath, AtSwitch
from .smooth import smooth_min


class LinkClearance(Constraint):
    """Rows: for each stack, each body's gap to it less the margin [m].

    Parameters: columns, margin.
    """

    name = "link_clearance"

    def __init__(self, arm: Arm) -> None:
        self._arm = arm
        self._names = list(dict.fromkeys(body.name for body in arm.bodies))

    def parameter_count(self, stacks: int) -> int:
        """See :class:`Constraint`."""
        return COLUMN_SIZE * stacks + 1

    def expression(self, model: ArmModel, parameters: ca.SX, stacks: int) -> ca.SX:
        """See the class."""
        columns, margin = ca.vertsplit(parameters, [0, COLUMN_SIZE * stacks, parameters.numel()])
        spheres: dict[str, list[tuple[ca.SX, float]]] = {name: [] for name in self._names}
        for body in self._arm.bodies:
            rotation, position = model.link_pose(body.link)
            spheres[body.name].append((position + rotation @ ca.DM(body.center), body.radius))
        gaps = [
            smooth_min([sphere_gap(*sphere, column) for sphere in parts]) - margin
            for column in split_columns(columns)
            for parts in spheres.values()
        ]
        return ca.vertcat(ca.SX(0, 1), *gaps)

    def row_names(self, phase: Phase) -> Sequence[str]:
        """See :class:`Constraint`."""
        stacks = range(len(phase.columns))
        return [f"clearance of {name} to {base_name(i)}" for i in stacks for name in self._names]

    def at_switch(self, moment: AtSwitch) -> Demand:
        """Apart from all stacks, the switch's own where the hand does not mean to touch it."""
        lower = np.zeros((1, len(moment.columns) * len(self._names)))
        parameters = np.append(moment.column_parameters, moment.clear.margin)[None]
        return Demand(parameters, lower, np.full_like(lower, np.inf))

    def along_path(self, way: AlongPath) -> Demand:
        """Apart at each step."""
        margins = np.full((way.steps, 1), way.clear.margin)
        lower = np.zeros((way.steps, len(way.phase.columns) * len(self._names)))
        parameters = np.concatenate([way.column_parameters, margins], axis=1)
        return Demand(parameters, lower, np.full_like(lower, np.inf))
