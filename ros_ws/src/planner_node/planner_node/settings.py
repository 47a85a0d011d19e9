# SPDX-License-Identifier: Apache-2.0
"""The parameters of planner_node: meaning, range and default in one place."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any, Final

from tamp_runtime.parameters import ParameterSpec

from .search import DEFAULT_MAX_EXPANSIONS


@dataclass
class Settings:
    """Values of the parameters; one instance is shared, so that a change takes effect at once."""

    max_expansions: int = DEFAULT_MAX_EXPANSIONS
    min_confidence: float = 0.0
    graph_max_age: float = 5.0
    perceive_timeout: float = 15.0
    image_service_timeout: float = 10.0
    motion_accept_timeout: float = 30.0
    motion_silence_timeout: float = 30.0
    max_replans: int = 5

    def update(self, values: dict[str, Any]) -> None:
        for name, value in values.items():
            setattr(self, name, value)


_DEFAULTS: Final = Settings()

PARAMETERS: Final = (
    ParameterSpec(
        "max_expansions",
        _DEFAULTS.max_expansions,
        "Bound of the search in expanded states; a million take a few seconds and 0.5 GB.",
        1,
        1_000_000_000,
    ),
    ParameterSpec(
        "min_confidence",
        _DEFAULTS.min_confidence,
        "Scene graphs below this confidence (A.2.5) are not planned on, whatever perception says.",
        0.0,
        1.0,
    ),
    ParameterSpec(
        "graph_max_age",
        _DEFAULTS.graph_max_age,
        "Scene graphs whose stamp is further than this from the node's clock are not used [s].",
        0.1,
        3600.0,
    ),
    ParameterSpec(
        "perceive_timeout",
        _DEFAULTS.perceive_timeout,
        "achieve_goal waits this long for a confident scene graph [s, wall time].",
        0.1,
        3600.0,
    ),
    ParameterSpec(
        "image_service_timeout",
        _DEFAULTS.image_service_timeout,
        "Perception has this long to interpret a goal image [s, wall time].",
        0.1,
        3600.0,
    ),
    ParameterSpec(
        "motion_accept_timeout",
        _DEFAULTS.motion_accept_timeout,
        "The motion node has this long to take up a plan [s, wall time].",
        0.1,
        3600.0,
    ),
    ParameterSpec(
        "motion_silence_timeout",
        _DEFAULTS.motion_silence_timeout,
        "A plan is given up when motion_status is silent for this long [s, wall time].",
        0.1,
        3600.0,
    ),
    ParameterSpec(
        "max_replans",
        _DEFAULTS.max_replans,
        "achieve_goal plans this often anew before it gives up.",
        0,
        1000,
    ),
)
