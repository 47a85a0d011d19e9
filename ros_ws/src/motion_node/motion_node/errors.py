# SPDX-License-Identifier: Apache-2.0
"""The errors of motion optimisation; each carries what failed."""

from __future__ import annotations

from typing import Final

#: The bounds of multi-bound tree search (3.4), as MotionStatus spells them.
POSE: Final = "pose"
KEYFRAMES: Final = "keyframes"
PATH: Final = "path"

#: What of a move cannot be, as MotionStatus spells it: taking the block from where it stands,
#: putting it there, both in one move, each wherever the others are, or the move in this scene.
TAKING: Final = "taking"
PUTTING: Final = "putting"
MOVING: Final = "moving"
SCENE: Final = "scene"


class MotionError(Exception):
    """Base class of everything that can go wrong between a plan and a trajectory."""


class RobotDescriptionError(MotionError):
    """The robot description cannot be used; ``element`` names the link or joint, if it is one."""

    def __init__(self, message: str, element: str = "") -> None:
        super().__init__(message)
        self.element = element


class InvalidPlanError(MotionError):
    """The plan does not fit its scene; ``move`` is the index of the move, or -1."""

    def __init__(self, message: str, move: int = -1, object_name: str = "") -> None:
        super().__init__(message)
        self.move = move
        self.object_name = object_name


class InfeasibleError(MotionError):
    """A bound has no solution (3.4).

    Attributes:
        bound: ``pose`` (P1), ``keyframes`` (P2) or ``path`` (P3).
        object_name: the block that the phase moves; empty for the way home.
        constraint: the violated constraint in words, e.g. ``clearance of hand to stack1``.
        violation: by how much [m or rad].
        move: index of the move; the number of moves for the way home.
        phase: ``pick``, ``place`` or ``home``.
        excludes: ``taking``, ``putting``, ``moving`` or ``scene``; empty: nobody has found out.
        suggestion: the smallest change with which it can be, checked; empty: nobody was asked, or
            none was found.
    """

    def __init__(
        self,
        bound: str,
        constraint: str,
        *,
        object_name: str = "",
        violation: float = 0.0,
        move: int = 0,
        phase: str = "",
        excludes: str = "",
    ) -> None:
        self.bound = bound
        self.excludes = excludes
        self.object_name = object_name
        self.constraint = constraint
        self.violation = violation
        self.move = move
        self.phase = phase
        self.suggestion = ""
        what = f"{phase} of {object_name}" if object_name else f"way {phase or 'home'}"
        super().__init__(
            f"the {bound} problem of the {what} (move {move}) has no solution: "
            f"{constraint} is violated by {violation:.3g}"
        )

    def add(self, circumstance: str) -> None:
        """Adds to the sentence what may be why."""
        self.args = (f"{self}; {circumstance}, which may be why",)


class CancelledError(MotionError):
    """The optimisation was stopped on request."""


class JointStateError(MotionError):
    """A joint state that does not tell where the arm is; the sentence says what it lacks."""
