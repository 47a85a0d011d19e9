# SPDX-License-Identifier: Apache-2.0
"""A plan for a scene as it was seen, made as the settings say."""

from __future__ import annotations

from collections.abc import Callable, Sequence

from ..goals.goal import Goal
from ..search import SearchResult
from ..search.peers.given_plan import checked_plan
from ..search.possible import Exclusion
from ..search.stability import Stability, stability_of
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
    return make_stable_plan(
        scene.stacks,
        goal,
        stability_in(scene, settings),
        exclusions,
        settings.max_expansions,
        cancelled,
        settings.search_algorithm,
    )


def given_plan_in(scene: Scene, text: str, goal: Goal, settings: Settings) -> SearchResult:
    """Another planner's plan, held to the same.

    Raises:
        GivenPlanError: it does not hold; the message names the step.
    """
    return checked_plan(text, scene.stacks, goal, stability_in(scene, settings))


def stability_in(scene: Scene, settings: Settings) -> Stability | None:
    """What may stand on what; None: the settings do not ask."""
    if settings.stability == IGNORE:
        return None
    required = settings.stability == REQUIRE
    return stability_of(scene.graph.objects, required, settings.max_width_ratio)
