# SPDX-License-Identifier: Apache-2.0
"""The arm, its hand and what it holds keep their distance to what stands around."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Final

import casadi as ca
import numpy as np
from numpy.typing import NDArray

from ..nlp import Demand
from ..obstacles import Obstacle
from ..phases import Phase
from ..robots import Arm
from ..robots.model import ArmModel
from .constraint import Constraint
from .obstacle_hulls import (
    OBSTACLE_SIZE,
    HandPart,
    ObstacleHull,
    obstacle_parameters,
    sphere_gap,
    split_obstacles,
)
from .situation import AlongPath, AtSwitch
from .smooth import smooth_min

Array = NDArray[np.float64]

#: Problems are built for so many obstacles, so that few have to be built.
CAPACITIES: Final = (1, 2, 4, 8, 16, 32, 64, 160)
_TOOL_SIZE: Final = 3


def capacity_for(count: int) -> int:
    """The least number of obstacles that problems are built for, ``count`` included."""
    return next(capacity for capacity in CAPACITIES if capacity >= count)


class ObstacleClearance(Constraint):
    """Rows: for each obstacle, the gap of each part of the arm to it less the margin [m].

    Parameters: obstacles, half extents and lower end of what hangs from the palm, margin.

    Args:
        obstacles: at least one.
        capacity: for how many the rows are made.
    """

    name = "obstacle_clearance"

    def __init__(self, arm: Arm, obstacles: Sequence[Obstacle], capacity: int) -> None:
        self._arm, self.capacity = arm, capacity
        self.surround(obstacles)
        self._spheres = (*arm.bodies, *arm.upper_bodies)
        self._bodies = list(dict.fromkeys(body.name for body in self._spheres))

    def surround(self, obstacles: Sequence[Obstacle]) -> None:
        """Other obstacles, at most ``capacity``, from now on."""
        self._obstacles = tuple(obstacles)
        self._parameters = obstacle_parameters(obstacles, self.capacity)

    def parameter_count(self, stacks: int) -> int:
        """See :class:`Constraint`."""
        return OBSTACLE_SIZE * self.capacity + _TOOL_SIZE + 1

    def expression(self, model: ArmModel, parameters: ca.SX, stacks: int) -> ca.SX:
        """See the class."""
        ends = np.cumsum([0, OBSTACLE_SIZE * self.capacity, _TOOL_SIZE, 1]).tolist()
        listed, tool, margin = ca.vertsplit(parameters, ends)
        gripper = self._arm.gripper
        palm = HandPart(model, gripper.hand_half, ca.SX(gripper.hand_top), ca.SX(gripper.palm))
        below = HandPart(model, (tool[0], tool[1]), ca.SX(gripper.palm), tool[2])
        spheres: dict[str, list[tuple[ca.SX, float]]] = {name: [] for name in self._bodies}
        for body in self._spheres:
            rotation, position = model.link_pose(body.link)
            spheres[body.name].append((position + rotation @ ca.DM(body.center), body.radius))
        gaps = []
        for own in split_obstacles(listed):
            obstacle = ObstacleHull(own)
            gaps += [palm.gap(obstacle), below.gap(obstacle)]
            gaps += [
                smooth_min([sphere_gap(*sphere, obstacle) for sphere in parts])
                for parts in spheres.values()
            ]
        return ca.vertcat(*gaps) - margin

    def row_names(self, phase: Phase) -> Sequence[str]:
        """See :class:`Constraint`."""
        held = phase.tool.held
        parts = ["hand", f"fingers with {held}" if held else "fingers", *self._bodies]
        names = [item.name for item in self._obstacles]
        names += ["nothing"] * (self.capacity - len(names))
        return [f"clearance of {part} to {name}" for name in names for part in parts]

    def at_switch(self, moment: AtSwitch) -> Demand:
        """Apart from all of them."""
        return self._demand(moment.phase, moment.clear.margin, 1)

    def along_path(self, way: AlongPath) -> Demand:
        """Apart at each step, more so between the vertical ends."""
        demand = self._demand(way.phase, way.clear.margin, way.steps)
        if way.clear.extra:
            between = np.ones(way.steps, dtype=bool)
            for _, here in way.vertical:
                between[here] = False
            demand.parameters[between, -1] += way.clear.extra
        return demand

    def _demand(self, phase: Phase, margin: float, steps: int) -> Demand:
        tool = phase.tool
        own = [*self._parameters, tool.half_x, tool.half_y, tool.bottom, margin]
        lower = np.zeros((steps, self.capacity * (2 + len(self._bodies))))
        return Demand(np.repeat([own], steps, axis=0), lower, np.full_like(lower, np.inf))
