# SPDX-License-Identifier: Apache-2.0
"""What the path problem asks of one phase: bounds, parameters and a starting point."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from .features import LEAN_ROWS, SMOOTHING, SWITCH_ROWS, Features
from .inverse_kinematics import InverseKinematics
from .k_order import Bounds
from .keyframes import Clearances, lowered
from .phases import Column, Phase, Switch

Array = NDArray[np.float64]


@dataclass(frozen=True)
class PathSettings:
    """Shape of a phase.

    Attributes:
        steps: intervals a phase.
        vertical: of these, at its start and its end, along a vertical line.
        lift: height of the vertical lines at least [m].
        margin: clearance of the arm with what it holds to blocks and table [m].
        max_lean: how far the hand may lean from vertical in between [rad].
    """

    steps: int = 14
    vertical: int = 4
    lift: float = 0.05
    margin: float = 0.015
    max_lean: float = 0.15


@dataclass(frozen=True)
class _End:
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


class PhaseBounds:
    """Bounds and starting points of one phase.

    A phase that starts at a switch leaves it along a vertical line. One that starts anywhere else
    (the first, and a way home after a stop) rises first if what hangs from the palm is not yet
    above the stacks; clearances that do not hold at its start may not shrink.
    """

    def __init__(
        self,
        features: Features,
        settings: PathSettings,
        phase: Phase,
        start: Array,
        goal: Array,
        clear: Clearances,
    ) -> None:
        self.features, self.settings, self.phase, self.clear = features, settings, phase, clear
        self.start_q, self.goal_q = start, goal
        self._reserve = clear.margin + SMOOTHING
        self.first = self._start_end()
        self.last = self._switch_end(phase.switch) if phase.switch else None

    def _tool_bottom(self, tcp_height: float) -> float:
        return tcp_height + self.features.robot.gripper.tcp_offset - self.phase.tool.bottom

    def _switch_end(self, switch: Switch) -> _End:
        robot, phase = self.features.robot, self.phase
        x, y, z = switch.position_world
        columns = lowered(
            phase.columns, switch, phase.tool, robot.gripper.tcp_offset, self.clear.margin
        )
        above_own = phase.columns[switch.stack].top - self._tool_bottom(z) + self._reserve + 0.002
        lift = max(self.settings.lift, above_own)
        return _End(np.array([x, y, switch.yaw]), z, lift, columns)

    def _start_end(self) -> _End | None:
        if self.phase.start is not None:
            return self._switch_end(self.phase.start)
        (x, y, z), yaw = self.features.hand_pose(self.start_q)
        bottom = self._tool_bottom(z)
        tops = [column.top for column in self.phase.columns]
        if bottom > max(tops) + self._reserve:
            return None
        near = [
            column.top
            for column in self.phase.columns
            if np.hypot(column.center[0] - x, column.center[1] - y) < 0.15
        ]
        lift = max([self.settings.lift, *[top - bottom + self._reserve for top in near]])
        return _End(np.array([x, y, yaw]), z, lift, self.phase.columns)

    def bounds(self) -> list[Bounds]:
        """Of both features of :class:`PathProblem`."""
        features, settings, phase, clear = self.features, self.settings, self.phase, self.clear
        ends, inner = settings.vertical, settings.steps - 1
        mode = features.mode(phase.columns, phase.tool, clear.floor, clear.margin)
        modes = np.tile(mode, (inner, 1))
        lower = np.zeros((inner, features.path.rows))
        upper = np.full_like(lower, np.inf)
        lower[:, :LEAN_ROWS], upper[:, :LEAN_ROWS] = -settings.max_lean, settings.max_lean
        references = np.zeros((2 * ends, 3))
        low = np.full((2 * ends, SWITCH_ROWS), -np.inf)
        high = np.full((2 * ends, SWITCH_ROWS), np.inf)
        for end, here, edge, top in (
            (self.first, slice(0, ends), slice(0, ends), ends - 1),
            (self.last, slice(inner - ends, inner), slice(ends, 2 * ends), ends),
        ):
            if end is None:
                continue
            modes[here] = features.mode(end.columns, phase.tool, clear.floor, clear.margin)
            lower[here, :LEAN_ROWS] = upper[here, :LEAN_ROWS] = 0.0
            lower[here, features.tool_floor_row] = -np.inf
            references[edge] = end.reference
            low[edge, :3] = high[edge, :3] = 0.0
            low[edge, 3] = end.height
            low[top, 3] = end.height + end.lift
        if phase.start is None:
            self._relax(modes, lower, upper)
        return [Bounds(modes, lower, upper), Bounds(references, low, high)]

    def _relax(self, modes: Array, lower: Array, upper: Array) -> None:
        """Lets the first steps begin from a start that is not as the path constraints ask."""
        ends, half = self.settings.vertical, self.settings.steps // 2
        at_start = np.array(self.features.path.value(self.start_q, modes[0])).ravel()
        lower[:ends] = np.minimum(lower[:ends], at_start - 1e-3)
        lean = np.abs(at_start[:LEAN_ROWS]).max() + 1e-3
        if lean > 0.02:
            lower[:half, :LEAN_ROWS] = -max(lean, self.settings.max_lean)
            upper[:half, :LEAN_ROWS] = max(lean, self.settings.max_lean)
        else:
            lower[:ends, :LEAN_ROWS] = np.minimum(lower[:ends, :LEAN_ROWS], -lean)
            upper[:ends, :LEAN_ROWS] = np.maximum(upper[:ends, :LEAN_ROWS], lean)

    def guess(self, inverse: InverseKinematics, higher: float, inwards: float) -> Array:
        """A starting point that goes up, across and down, shape (steps + 1, n) [rad].

        Args:
            higher: how much higher than needed to pass over the stacks [m].
            inwards: share by which the way across is drawn towards the arm's base.
        """
        settings = self.settings
        tops = [column.top for column in self.phase.columns]
        hanging = self.phase.tool.bottom - self.features.robot.gripper.tcp_offset
        across = max(tops) + hanging + self._reserve + 0.01 + higher
        share = 1.3 * settings.vertical / settings.steps
        ends = ((self.first, self.start_q, share), (self.last, self.goal_q, 1 - share))
        points, yaws, near, shares = [], [], [], [0.0]
        for end, q, when in ends:
            if end is None:
                continue
            points.append(end.reference * (1 - inwards))
            points[-1][2] = max(across, end.height + end.lift)
            yaws.append(self.features.hand_pose(q)[1])
            near.append(q)
            shares.append(when)
        between: list[Array] = []
        if near:
            between = list(inverse.solve(np.array(points), np.array(yaws), np.array(near)))
        knots = [self.start_q, *between, self.goal_q]
        shares.append(1.0)
        at = np.linspace(0.0, 1.0, settings.steps + 1)
        return np.column_stack([np.interp(at, shares, column) for column in np.array(knots).T])
