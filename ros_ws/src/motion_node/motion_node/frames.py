# SPDX-License-Identifier: Apache-2.0
"""The frame that plans are in, and that of the arm."""

from __future__ import annotations

from .errors import InvalidPlanError


def check_frame(frame: str, root: str, world_frame: str) -> None:
    """Poses are taken as they are, so they must be in the frame that the arm is planned in.

    Args:
        frame: the plan's; empty: it does not say, and is taken for the arm's.
        root: the root link of the robot description.
        world_frame: another name of the same frame.

    Raises:
        InvalidPlanError: if the frame is a third one; the sentence names all.
    """
    if frame.lstrip("/") not in ("", root, world_frame):
        raise InvalidPlanError(
            f"the plan's poses are in frame {frame!r}, and the arm's robot_description is rooted "
            f"in {root!r}, which stands in the origin of {world_frame!r}; have perception_node "
            "tell poses in one of the two (its world_frame), or name the plan's frame as "
            "world_frame of motion_node if it is the same place"
        )
