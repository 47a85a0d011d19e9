# SPDX-License-Identifier: Apache-2.0
"""Follows a recording's commands in a world of any engine, by the simulator's own controller."""

from __future__ import annotations

from typing import Final, Protocol, cast

import numpy as np
from numpy.typing import NDArray

from sim_node.controller import ArmController
from sim_node.simulated_arms import SimulatedArm
from sim_node.trajectory import TrajectoryError
from sim_node.world import World

from .recording import Recording, Trace

Array = NDArray[np.float64]

#: How long things may go on falling after the last command has ended [s].
REST_SECONDS: Final = 1.5
#: Controller steps between two entries of a trace: 30 Hz.
STEPS_PER_ENTRY: Final = 8


class ReplayWorld(Protocol):
    """What a world has to offer; arrays over joints have shape (n,) in the order of the arm's."""

    arm: SimulatedArm
    timestep: float
    steps: int
    lower: Array
    upper: Array
    max_velocity: Array

    @property
    def names(self) -> tuple[str, ...]:
        """Of the blocks."""

    def command(self, positions: Array, velocities: Array | None = None) -> None:
        """Targets of the motors."""

    def step(self) -> None:
        """Advances by ``timestep``."""

    def joint_state(self) -> tuple[Array, Array, Array]:
        """Positions, velocities, efforts."""

    def poses(self) -> Array:
        """Of the blocks, shape (b, 7)."""


def carry_out(recording: Recording, world: ReplayWorld) -> Trace:
    """What becomes of the blocks when the arm is commanded once more what it was commanded.

    A trajectory that the controller refuses is noted; the arm goes on then as a real one does.
    """
    controller = ArmController(cast(World, world))
    waiting = list(recording.commands)
    end = REST_SECONDS + max(
        [float(recording.trace.times[-1])]
        + [item.begins + float(item.times[-1]) for item in waiting if len(item.times)]
    )
    trace = TraceWriter(world.names)
    for step in range(round(end / world.timestep) + 1):
        while waiting and round(waiting[0].begins / world.timestep) <= step:
            command = waiting.pop(0)
            if not len(command.times):
                controller.stop()
                continue
            try:
                controller.follow(
                    recording.joints, command.times, command.positions, command.velocities
                )
            except TrajectoryError as error:
                trace.notes.append(f"{command.begins:.1f} s: trajectory refused: {error}")
        if step % STEPS_PER_ENTRY == 0:
            trace.add(step * world.timestep, world.joint_state()[0], world.poses())
        controller.update()
        world.step()
    return trace.finished()


class TraceWriter:
    """Collects a trace; ``notes`` may be added to."""

    def __init__(self, names: tuple[str, ...]) -> None:
        self._names = names
        self._rows: list[tuple[float, Array, Array]] = []
        self.notes: list[str] = []

    def add(self, time: float, joints: Array, poses: Array) -> None:
        """One entry: time [s], joints (n,), poses (b, 7)."""
        self._rows.append((time, joints, poses))

    def finished(self) -> Trace:
        """All entries."""
        times, joints, poses = zip(*self._rows)
        return Trace(
            np.array(times), np.array(joints), np.array(poses), self._names, tuple(self.notes)
        )
