# SPDX-License-Identifier: Apache-2.0
"""What the hand had between its fingers, when, and how far it slid there."""

from __future__ import annotations

import itertools
from collections.abc import Callable, Iterator
from dataclasses import dataclass
from typing import Final

import numpy as np
from numpy.typing import NDArray

from motion_node.robots import arm_named
from motion_node.robots.kinematics import Kinematics
from sim_node.simulated_arms import SIMULATED_ARMS

from .recording import Recording, Trace

Array = NDArray[np.float64]

#: Fingers that are sent to less than this share of their open position are sent to close.
_CLOSED: Final = 0.85
#: By so much they are sent apart when they open [m].
_PARTING: Final = 0.0003
#: So long after they are sent to close they have closed [s].
_SETTLED: Final = 0.3
#: A block that moves less while the fingers are closed was not carried [m].
_CARRIED: Final = 0.01


@dataclass(frozen=True)
class Grasp:
    """From the command to close the fingers to the command to open them.

    Attributes:
        start, end: since the recording's start [s].
        block: what was carried in the engine in which it was executed; empty: nothing.
    """

    start: float
    end: float
    block: str


def grasps(recording: Recording) -> tuple[Grasp, ...]:
    """All grasps of a task, in order."""
    arm = SIMULATED_ARMS[recording.robot]
    columns = [recording.joints.index(name) for name in arm.finger_joints]
    trace = recording.trace
    found = []
    for start, end in _closed(recording, columns, _CLOSED * arm.fingers_open):
        during = (trace.times >= start) & (trace.times <= end)
        block = ""
        if during.any():
            way = np.linalg.norm(np.diff(trace.poses[during][:, :, :3], axis=0), axis=2).sum(axis=0)
            if len(way) and way.max() > _CARRIED:
                block = trace.names[int(way.argmax())]
        found.append(Grasp(start, end, block))
    return tuple(found)


def _closed(recording: Recording, columns: list[int], limit: float) -> list[tuple[float, float]]:
    """From when the fingers are sent below a position [m] until they are first sent apart again."""
    spans: list[tuple[float, float]] = []
    started = ended = 0.0
    least = np.inf
    for time, target in _finger_targets(recording, columns):
        if target < limit:
            if least == np.inf:
                started = time
            if target <= least + _PARTING:
                ended = time
            least = min(least, target)
        elif least < np.inf:
            spans.append((started, ended))
            least = np.inf
    if least < np.inf:
        spans.append((started, float(recording.trace.times[-1])))
    return spans


def _finger_targets(recording: Recording, columns: list[int]) -> Iterator[tuple[float, float]]:
    """Times since the start [s] and mean targets of the fingers [m], a trajectory's points each."""
    for command, later in itertools.zip_longest(recording.commands, recording.commands[1:]):
        until = later.begins if later else np.inf
        for time, positions in zip(command.times, command.positions):
            if command.begins + time <= until:
                yield float(command.begins + time), float(positions[columns].mean())


def hand_poses(recording: Recording) -> Callable[[Array], Array]:
    """The hand's pose (4, 4) in world at joint positions (n,), in the recording's order."""
    arm = arm_named(recording.robot)
    urdf = SIMULATED_ARMS[recording.robot].urdf.read_text(encoding="utf-8")
    kinematics = Kinematics(urdf, recording.joints)
    return lambda joints: kinematics.pose_at(arm.gripper.hand_link, joints)


def slip(grasp: Grasp, trace: Trace, hand: Callable[[Array], Array]) -> float:
    """How far a carried block gets from where it was in the closed hand, at most [m].

    NaN if nothing was carried, or for too short a time to say.
    """
    inside = (trace.times >= grasp.start + _SETTLED) & (trace.times <= grasp.end)
    entries = np.flatnonzero(inside)
    if not grasp.block or len(entries) < 2:
        return float("nan")
    block = trace.names.index(grasp.block)
    places = []
    for entry in entries:
        world_from_hand = hand(trace.joints[entry])
        offset = trace.poses[entry, block, :3] - world_from_hand[:3, 3]
        places.append(world_from_hand[:3, :3].T @ offset)
    return float(np.linalg.norm(np.array(places) - places[0], axis=1).max())
