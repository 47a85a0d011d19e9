# SPDX-License-Identifier: Apache-2.0
"""The verdicts on a frame; numbers and meanings are those of tamp_interfaces/SceneGraph."""

from __future__ import annotations

from enum import IntEnum


class Status(IntEnum):
    """Whether a scene graph can be planned on, and if not, why."""

    CONFIDENT = 0
    LOW_CONFIDENCE = 1
    OCCLUDED = 2
    UNSTABLE = 3
    NO_OBJECTS = 4
    BAD_IMAGE = 5
