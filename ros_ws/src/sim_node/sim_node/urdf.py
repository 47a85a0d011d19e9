# SPDX-License-Identifier: Apache-2.0
"""The robot's URDF, as nodes on this machine and on others can use it."""

from __future__ import annotations

import re
from typing import Final

from .arm_shapes import with_boxes
from .simulated_arms import PANDA, SimulatedArm

#: Boxes in place of meshes: what every machine can show.
BOXES: Final = "boxes"
#: The meshes' files on this machine.
FILES: Final = "files"

_FILENAME: Final = re.compile(r'filename="(?:package://)?([^"]*)')


def mesh_uris_problem(value: str) -> str:
    """boxes, files, or the beginning of a URI"""
    if value in (BOXES, FILES) or re.fullmatch(r"[a-z]+://\S+", value):
        return ""
    return (
        f"mesh_uris = {value!r} is neither {BOXES!r}, {FILES!r} nor the beginning of a URI such as "
        "'package://my_description'"
    )


def robot_description(arm: SimulatedArm = PANDA, mesh_uris: str = BOXES) -> str:
    """URDF text; joints, limits and inertias are the same for every choice of meshes.

    Args:
        arm: whose.
        mesh_uris: ``boxes``: boxes around the meshes, and no file is named; ``files``: ``file://``
            URIs of this machine; else what the meshes' paths in the arm's folder are put behind,
            such as ``package://my_description`` for ``package://my_description/meshes/…``.

    Raises:
        OSError: if the arm's URDF or, for boxes, its meshes cannot be read.
        ValueError: if ``mesh_uris`` is none of these.
    """
    if problem := mesh_uris_problem(mesh_uris):
        raise ValueError(problem)
    text = arm.urdf.read_text(encoding="utf-8")
    if mesh_uris == BOXES:
        return with_boxes(text, lambda name: arm.urdf.parent / name.removeprefix("package://"))
    prefix = f"file://{arm.urdf.parent}" if mesh_uris == FILES else mesh_uris.rstrip("/")
    return _FILENAME.sub(lambda found: f'filename="{prefix}/{found[1]}', text)
