# SPDX-License-Identifier: Apache-2.0
"""Damages to single messages, for :class:`faults.modes.Change`; each changes what it gets."""

from __future__ import annotations

import math
from typing import Any

import numpy as np
from tamp_runtime.messages.stamps import duration_from_seconds, nanoseconds, stamp_from_nanoseconds

from faults.modes import Damage

# Any message with a header


def stamped(shift_seconds: float) -> Damage:
    """Stamps of another clock."""

    def damage(message: Any) -> Any:
        stamp = nanoseconds(message.header.stamp) + round(shift_seconds * 1e9)
        message.header.stamp = stamp_from_nanoseconds(max(stamp, 0))
        return message

    return damage


def with_stamp(nanosecond: int) -> Damage:
    """The same stamp for all."""

    def damage(message: Any) -> Any:
        message.header.stamp = stamp_from_nanoseconds(nanosecond)
        return message

    return damage


def with_wavering_stamps() -> Damage:
    """Stamps that differ by some milliseconds from stream to stream, as of cameras without sync."""
    rng = np.random.default_rng(3)
    return lambda message: stamped(float(rng.uniform(0.001, 0.008)))(message)


# joint_trajectory


def cut_short(share: float) -> Damage:
    """Only the first part of a trajectory."""

    def damage(message: Any) -> Any:
        count = max(2, round(share * len(message.points)))
        message.points = message.points[:count]
        return message

    return damage


def stretched(factor: float) -> Damage:
    """A trajectory that takes longer by a factor."""

    def damage(message: Any) -> Any:
        for point in message.points:
            time = factor * 1e-9 * nanoseconds(point.time_from_start)
            point.time_from_start = duration_from_seconds(time)
            point.velocities = [value / factor for value in point.velocities]
        return message

    return damage


def nan_in_the_middle(message: Any) -> Any:
    """A position that is no number."""
    if message.points:
        point = message.points[len(message.points) // 2]
        point.positions = [math.nan, *point.positions[1:]]
    return message


def fingers_kept_at(metres: float) -> Damage:
    """The last two joints stay where they are told here [m]."""

    def damage(message: Any) -> Any:
        for point in message.points:
            point.positions = [*point.positions[:-2], metres, metres]
            point.velocities = [*point.velocities[:-2], 0.0, 0.0]
        return message

    return damage


# joint_states


def positions_nan(message: Any) -> Any:
    """No position is a number."""
    message.position = [math.nan] * len(message.position)
    return message


def without_last_joint(message: Any) -> Any:
    """A driver that leaves a finger out."""
    for name in ("name", "position", "velocity", "effort"):
        setattr(message, name, list(getattr(message, name))[:-1])
    return message


def joints_reversed(message: Any) -> Any:
    """The same joints in another order; nothing is wrong with that."""
    for name in ("name", "position", "velocity", "effort"):
        setattr(message, name, list(getattr(message, name))[::-1])
    return message


def shaken(radians: float) -> Damage:
    """Positions with noise."""
    rng = np.random.default_rng(5)

    def damage(message: Any) -> Any:
        grains = rng.normal(0.0, radians, len(message.position))
        message.position = (np.array(message.position) + grains).tolist()
        return message

    return damage


# motion_status, symbolic_plan, scene_graph, clock


def nonsense_state(message: Any) -> Any:
    """A state that the interface does not know."""
    message.state = 99
    return message


def nonsense_reason(message: Any) -> Any:
    """A reason that the interface does not know."""
    message.reason = 99
    return message


def of_another_plan(message: Any) -> Any:
    """A status that is about a plan of somebody else."""
    message.plan_id = "somebody-elses"
    return message


def moves_from_nowhere(message: Any) -> Any:
    """A plan for stacks that are not there."""
    for move in message.moves:
        move.source = 9
    return message


def blocks_unheard_of(message: Any) -> Any:
    """A plan for blocks that are not in its scene."""
    for move in message.moves:
        move.object_name = "golden_box"
    return message


def poses_off(metres: float) -> Damage:
    """A plan whose scene has every block beside itself."""

    def damage(message: Any) -> Any:
        for item in message.initial.objects:
            item.pose.position.y += metres
        return message

    return damage


def clock_shifted(seconds: float) -> Damage:
    """A clock that jumped."""

    def damage(message: Any) -> Any:
        shifted = nanoseconds(message.clock) + round(seconds * 1e9)
        message.clock = stamp_from_nanoseconds(max(shifted, 0))
        return message

    return damage
