# SPDX-License-Identifier: Apache-2.0
"""The arms that the motion problem knows; another one is a module and an entry in ``ARMS``."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Final

from .arm import Arm, BodySphere, Gripper
from .kuka_iiwa import KUKA_IIWA
from .panda import PANDA
from .seeding import Seeding

__all__ = ["ARMS", "KUKA_IIWA", "PANDA", "Arm", "BodySphere", "Gripper", "Seeding", "arm_named"]

#: Every known arm by the name that the parameter ``robot`` selects it with.
ARMS: Final[Mapping[str, Arm]] = {arm.name: arm for arm in (PANDA, KUKA_IIWA)}


def arm_named(name: str) -> Arm:
    """The arm of that name.

    Raises:
        ValueError: if there is none; the sentence names the known ones.
    """
    if name not in ARMS:
        raise ValueError(f"there is no robot {name!r}; there is {', '.join(sorted(ARMS))}")
    return ARMS[name]
