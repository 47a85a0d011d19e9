# SPDX-License-Identifier: Apache-2.0
"""What the parameters of planner_node set, as plain values."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any, Final

from .search import AUTO, DEFAULT_MAX_EXPANSIONS
from .search.stability import MAX_WIDTH_RATIO

#: When a plan that is carried out is compared with what the camera sees: after its last move, after
#: each, or all the time.
END: Final = "end"
EACH_MOVE: Final = "each_move"
WATCH: Final = "watch"
VERIFY: Final = (END, EACH_MOVE, WATCH)
#: What plans are made on: scene graphs, or codes of pictures.
SCENE_GRAPH: Final = "scene_graph"
LATENT: Final = "latent"
REPRESENTATIONS: Final = (SCENE_GRAPH, LATENT)

#: What stands on what: nothing unstable where a plan avoids it, nothing at all, or whatever.
AVOID: Final = "avoid"
REQUIRE: Final = "require"
IGNORE: Final = "ignore"
STABILITY: Final = (AVOID, REQUIRE, IGNORE)


@dataclass
class Settings:
    """Values of the parameters; one instance is shared, so that a change takes effect at once.

    What each means stands in :data:`planner_node.parameters.PARAMETERS`; times are in seconds.
    """

    representation: str = SCENE_GRAPH
    max_expansions: int = DEFAULT_MAX_EXPANSIONS
    search_algorithm: str = AUTO
    min_confidence: float = 0.0
    graph_max_age: float = 5.0
    perceive_timeout: float = 15.0
    view_timeout: float = 3.0
    image_service_timeout: float = 10.0
    motion_accept_timeout: float = 30.0
    motion_silence_timeout: float = 15.0
    max_replans: int = 5
    verify: str = END
    stability: str = AVOID
    max_width_ratio: float = MAX_WIDTH_RATIO

    def update(self, values: Mapping[str, Any]) -> None:
        """Takes over the values of some parameters by name."""
        for name, value in values.items():
            setattr(self, name, value)
