# SPDX-License-Identifier: Apache-2.0
"""A plan for a scene as it was seen, made as the settings say."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import replace

from scene_graph import NOT, UP, Relation, Stacks, base_name

from ..errors import (
    AmbiguousObjectError,
    GivenPlanError,
    GoalImageError,
    UnknownObjectError,
)
from ..goals.contradictions import check_contradictions
from ..goals.goal import Goal, ResolveGoal
from ..search import SearchResult
from ..search.limits import Limits
from ..search.peers.given_plan import checked_plan
from ..search.possible import Exclusion
from ..search.stability import Stability, stability_of
from ..search.stable import make_stable_plan
from ..search.uncover import Sight, uncover
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
        cleared_up(goal, scene),
        stability_in(scene, settings),
        (*exclusions, *not_places(scene)),
        settings.max_expansions,
        cancelled,
        settings.search_algorithm,
    )


def cleared_up(goal: Goal, scene: Scene) -> Goal:
    """The goal, with all blocks on places."""
    away = [
        Relation(name, NOT + UP, base_name(place.index))
        for stack, place in zip(scene.stacks, scene.graph.places)
        if place.aside
        for name in stack
    ]
    return replace(goal, relations=(*goal.relations, *away)) if away else goal


def not_places(scene: Scene) -> list[Exclusion]:
    """That nothing is put where blocks stand beside the places."""
    beside = [
        (stack, place)
        for stack, place in zip(scene.stacks, scene.graph.places)
        if place.aside and stack
    ]
    return [
        Exclusion(name, target=place.index, onto=onto, told=False)
        for stack, place in beside
        for onto in ((), stack)
        for names in scene.stacks
        for name in names
    ]


def given_plan_in(scene: Scene, text: str, goal: Goal, settings: Settings) -> SearchResult:
    """Another planner's plan, held to the same.

    Raises:
        GivenPlanError: it does not hold; the message names the step.
    """
    found = checked_plan(text, scene.stacks, cleared_up(goal, scene), stability_in(scene, settings))
    for step, move in enumerate(found.moves):
        if scene.graph.places[move.target].aside:
            where = base_name(move.target)
            raise GivenPlanError(
                f"step {step + 1} of the plan puts a block on {where}, which is no place: just "
                f"where {scene.stacks[move.target][0]} stands beside the places",
                step,
            )
    return found


def uncover_in(
    scene: Scene,
    goal: Goal | None,
    settings: Settings,
    cancelled: Callable[[], bool],
    exclusions: Sequence[Exclusion] = (),
) -> SearchResult:
    """The fewest moves after which all that is hidden can be seen; its note says why (5.4.3).

    Args:
        goal: as far as it is known what it means; of equally short ways the one is taken that
            leaves the fewest of its relations open.

    Raises:
        PlannerError: as :func:`uncover`.
    """

    def rate(stacks: Stacks) -> float:
        return -len(goal.fulfilled_by(stacks)) if goal else 0.0

    heights = {item.name: item.size[2] for item in scene.graph.objects}
    limits = Limits(scene.stacks, goal or Goal(()), settings.max_expansions, cancelled)
    sight, stability = Sight(scene.graph.places, heights), stability_in(scene, settings)
    return uncover(scene.stacks, sight, limits, exclusions, stability, rate)


def meaning(resolve: ResolveGoal, scene: Scene) -> Goal | None:
    """What a goal means where some blocks are hidden; None if it may be of these.

    Raises:
        PlannerError: it makes no sense, whatever is hidden.
    """
    try:
        goal = resolve(scene.seen_stacks, scene.rows)
    except (UnknownObjectError, AmbiguousObjectError, GoalImageError):
        return None
    check_contradictions(Goal(goal.relations, rows=goal.rows), len(scene.stacks))
    return goal


def decided(goal: Goal, scene: Scene) -> bool:
    """Whether hidden blocks have no say in whether a goal holds: it is of blocks that are seen."""
    positive = all(not item.predicate.startswith(NOT) for item in goal.relations)
    return not goal.counts and positive and goal.names <= set(scene.names)


def stability_in(scene: Scene, settings: Settings) -> Stability | None:
    """What may stand on what; None: the settings do not ask."""
    if settings.stability == IGNORE:
        return None
    required = settings.stability == REQUIRE
    return stability_of(scene.graph.objects, required, settings.max_width_ratio)
