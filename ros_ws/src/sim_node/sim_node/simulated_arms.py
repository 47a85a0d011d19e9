# SPDX-License-Identifier: Apache-2.0
"""The arms that can be simulated: what a URDF does not say of them."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, replace
from pathlib import Path
from typing import Final

import numpy as np
import pybullet_data
from numpy.typing import NDArray

from .mounted_hand import MountedHand, with_hand
from .scene import ArmConfig, SceneError


@dataclass(frozen=True)
class SimulatedArm:
    """An arm with a parallel gripper.

    Values of all joints at once are in the order of :attr:`joints`.

    Attributes:
        name: what the parameter ``robot`` calls it.
        description: its URDF; meshes in it are relative to its folder.
        arm_joints: names of the arm's joints from the base.
        finger_joints: names of the fingers' two joints, which move by the same distance.
        home: position of the arm after a reset: hand up and back, no block hidden [rad].
        fingers_open: position of each finger after a reset [m].
        arm_gain, finger_gain: share of a position's error that the motors remove in a time step.
        arm_start_tolerance, finger_start_tolerance: how far a trajectory's first point may be
            from the present state [rad, m]; fingers that hold a block are away from their target
            by the squeeze.
        hand: what is screwed to it; None: the URDF has it.
    """

    name: str
    description: Path
    arm_joints: tuple[str, ...]
    finger_joints: tuple[str, str]
    home: tuple[float, ...]
    fingers_open: float
    arm_gain: float
    finger_gain: float
    arm_start_tolerance: float
    finger_start_tolerance: float
    hand: MountedHand | None = None

    @property
    def urdf(self) -> Path:
        """The URDF of arm and hand; raises OSError if it cannot be read or made."""
        return with_hand(self.description, self.hand) if self.hand else self.description

    @property
    def joints(self) -> tuple[str, ...]:
        """Names of all joints that move: the arm's, then the fingers'; n of them."""
        return self.arm_joints + self.finger_joints

    @property
    def home_positions(self) -> NDArray[np.float64]:
        """Positions of all joints after a reset, shape (n,) [rad, m]."""
        return np.concatenate([self.home, self._of_fingers(self.fingers_open)])

    @property
    def gains(self) -> NDArray[np.float64]:
        """Position gains of all joints, shape (n,)."""
        return self._of_all(self.arm_gain, self.finger_gain)

    @property
    def start_tolerance(self) -> NDArray[np.float64]:
        """Start tolerances of all joints, shape (n,) [rad, m]."""
        return self._of_all(self.arm_start_tolerance, self.finger_start_tolerance)

    def _of_all(self, arm: float, finger: float) -> NDArray[np.float64]:
        return np.concatenate([np.full(len(self.arm_joints), arm), self._of_fingers(finger)])

    def _of_fingers(self, value: float) -> NDArray[np.float64]:
        return np.full(len(self.finger_joints), value)


_DATA: Final = Path(pybullet_data.getDataPath())

#: Franka Emika Panda with its hand, as pybullet ships it.
PANDA: Final = SimulatedArm(
    name="panda",
    description=_DATA / "franka_panda" / "panda.urdf",
    arm_joints=tuple(f"panda_joint{number}" for number in range(1, 8)),
    finger_joints=("panda_finger_joint1", "panda_finger_joint2"),
    home=(0.0, -0.785, 0.0, -2.356, 0.0, 1.571, 0.785),
    fingers_open=0.04,
    arm_gain=0.4,
    finger_gain=0.2,
    arm_start_tolerance=0.1,
    finger_start_tolerance=0.05,
)

#: KUKA LBR iiwa 7 with Franka's hand; the speeds are KUKA's, those of pybullet's URDF are not.
KUKA_IIWA: Final = SimulatedArm(
    name="kuka_iiwa",
    description=_DATA / "kuka_iiwa" / "model.urdf",
    arm_joints=tuple(f"lbr_iiwa_joint_{number}" for number in range(1, 8)),
    finger_joints=PANDA.finger_joints,
    home=(0.0, 0.0, 0.0, -1.571, 0.0, 1.571, 0.0),
    fingers_open=0.04,
    arm_gain=0.4,
    finger_gain=0.2,
    arm_start_tolerance=0.1,
    finger_start_tolerance=0.05,
    hand=MountedHand(
        PANDA.description,
        root="panda_hand",
        flange="lbr_iiwa_link_7",
        distance=0.045,
        velocities=tuple(
            (f"lbr_iiwa_joint_{number}", speed)
            for number, speed in enumerate((1.71, 1.71, 1.74, 2.26, 2.44, 3.14, 3.14), start=1)
        ),
    ),
)

#: By the name that the parameter ``robot`` takes; an arm is added here.
SIMULATED_ARMS: Final[Mapping[str, SimulatedArm]] = {
    model.name: model for model in (PANDA, KUKA_IIWA)
}


def arm_of_scene(config: ArmConfig, otherwise: SimulatedArm) -> SimulatedArm:
    """The arm that a scene has.

    Args:
        otherwise: the one where the scene names none.

    Raises:
        SceneError: it is not known, or has another number of joints than its home.
    """
    if config.robot and config.robot not in SIMULATED_ARMS:
        known = ", ".join(SIMULATED_ARMS)
        raise SceneError("arm.robot", f"= {config.robot!r} is unknown; known: {known}")
    arm = SIMULATED_ARMS[config.robot] if config.robot else otherwise
    if not config.home:
        return arm
    if len(config.home) != len(arm.arm_joints):
        raise SceneError(
            "arm.home",
            f"has {len(config.home)} positions; {arm.name} has {len(arm.arm_joints)} joints",
        )
    return replace(arm, home=config.home)
