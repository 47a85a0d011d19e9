# SPDX-License-Identifier: Apache-2.0
"""What one camera shows of the blocks, on the way to a graph: what joined views are made of."""

from __future__ import annotations

from dataclasses import dataclass

from .covered import Seen
from .names import Names
from .observation import Observation
from .places.occlusion import Occlusion


@dataclass(frozen=True)
class View:
    """The blocks that a camera sees, as measured by themselves.

    Attributes:
        observation: of the moment, checked.
        seen: the N blocks, and what is only glimpsed.
        occlusion: what hides the places that is no block.
        names: of the N blocks, as they are in the graph of this view; None of none.
        fallen: whether one lies or leans.
    """

    observation: Observation
    seen: Seen
    occlusion: Occlusion
    names: Names | None = None
    fallen: bool = False
