# SPDX-License-Identifier: Apache-2.0
"""The frame that plans are in, and that of the arm."""

from __future__ import annotations

from .errors import InvalidPlanError


def check_frame(frame: str, root: str, world_frame: str, whose: str = "the plan's poses") -> None:
    """Poses are taken as they are, so they must be in the frame that the arm is planned in.

    Args:
        frame: theirs; empty: it does not say, and is taken for the arm's.
        root: the root link of the robot description.
        world_frame: another name of the same frame.
        whose: poses, in words.

    Raises:
        InvalidPlanError: if the frame is a third one; the sentence names all.
    """
    if frame.lstrip("/") not in ("", root, world_frame):
        raise InvalidPlanError(
            f"{whose} are in frame {frame!r}, and the arm's robot_description is rooted "
            f"in {root!r}, which stands in the origin of {world_frame!r}; have poses told in "
            "one of the two (perception_node's world_frame), or name their frame as world_frame of "
            "motion_node if it is the same place"
        )
