# SPDX-License-Identifier: Apache-2.0
"""What an execution is held to."""

from __future__ import annotations

from dataclasses import dataclass, field

from .monitor import MonitorSettings


@dataclass(frozen=True)
class StepSettings:
    """What an arm and a gripper are held to that have a controller each.

    Attributes:
        lead: how far ahead a trajectory is stamped, so that both have it in time [s, wall time].
        apart: how far either may be from its trajectory's time [s].
        arm_tolerance: deviation of an arm joint from where it may be [rad].
        finger_tolerance: the same of a finger [m].
        seconds: for how long it may be exceeded, by the joint states' stamps [s].
    """

    lead: float = 0.2
    apart: float = 0.25
    arm_tolerance: float = 0.04
    finger_tolerance: float = 0.003
    seconds: float = 0.1


@dataclass(frozen=True)
class ExecutionSettings:
    """Time limits, in wall time that this process lives through unless said otherwise [s].

    Attributes:
        joint_state_timeout: silence of the joint states that is taken for their end, and how long
            their stamps may stand still.
        description_timeout: for the robot description to arrive.
        rest_timeout: for the arm to come to rest before a plan is taken up.
        rest_seconds: standing still for this long counts as rest, by the joint states' stamps.
        execution_factor: of the trajectory's duration, plus 30 s, as the limit of an execution.
        brake_seconds: in which a moving arm comes to rest.
        in_step: what arm and gripper are held to that have a controller each; None: one has both.
    """

    joint_state_timeout: float = 15.0
    description_timeout: float = 10.0
    rest_timeout: float = 30.0
    rest_seconds: float = 0.8
    execution_factor: float = 20.0
    brake_seconds: float = 0.4
    monitor: MonitorSettings = field(default_factory=MonitorSettings)
    in_step: StepSettings | None = None
