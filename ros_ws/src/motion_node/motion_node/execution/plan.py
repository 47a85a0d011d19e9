# SPDX-License-Identifier: Apache-2.0
"""A symbolic plan as the executive needs it, and what plans its motion."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from typing import Protocol

from scene_graph import Move, SceneGraph

from ..planner import Motion
from .recovery import WaysHome


@dataclass(frozen=True)
class Plan:
    """A symbolic plan as the executive needs it.

    Attributes:
        frame: the frame of all its poses; empty: it does not say.
        explain: nothing is to move; it is only asked whether it could, and if not, what would help.
        watched: fingers close only on what was seen where they take it, see :mod:`.last_look`.
    """

    plan_id: str
    graph: SceneGraph
    moves: tuple[Move, ...]
    object_names: tuple[str, ...]
    frame: str = ""
    explain: bool = False
    watched: bool = False


class Planner(WaysHome, Protocol):
    """What plans motions; see :class:`motion_node.planner.MotionPlanner`."""

    @property
    def solve(self) -> Callable[..., Motion]:
        """Plans the motion that carries out moves in a scene, and goes home."""
