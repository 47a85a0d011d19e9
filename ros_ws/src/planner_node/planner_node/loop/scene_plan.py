# SPDX-License-Identifier: Apache-2.0
"""A plan for a scene as it was seen, made as the settings say."""

from __future__ import annotations

from collections.abc import Callable, Sequence

from ..goals.goal import Goal
from ..search import SearchResult
from ..search.possible import Exclusion
from ..search.stability import stability_of
from ..search.stable import make_stable_plan
from ..settings import IGNORE, REQUIRE, Settings
from .scene import Scene


def plan_in(
    scene: Scene,
    goal: Goal,
    settings: Settings,
    cancelled: Callable[[], bool],
    exclusions: Sequence[Exclusion] = (),
) -> SearchResult:
    """A shortest plan among those that the settings allow.

    Args:
        exclusions: moves that the arm cannot make.

    Raises:
        PlannerError: as :func:`make_stable_plan`.
    """
    stability = None
    if settings.stability != IGNORE:
        required = settings.stability == REQUIRE
        stability = stability_of(scene.graph.objects, required, settings.max_width_ratio)
    return make_stable_plan(
        scene.stacks,
        goal,
        stability,
        exclusions,
        settings.max_expansions,
        cancelled,
        settings.search_algorithm,
    )
