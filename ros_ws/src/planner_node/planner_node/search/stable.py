# SPDX-License-Identifier: Apache-2.0
"""Shortest plans after which everything stands, and what is to be said of them (5.4.2).

The shortest plan of all is looked for first. Where it puts nothing where it is unstable it is the
shortest stable one too, so that blocks of one size are planned for as if nothing were known of
them. Otherwise the search is made again, without placements after which a block falls, and with as
few as possible after which it stands badly.
"""

from __future__ import annotations

import time
from collections.abc import Callable, Sequence
from dataclasses import replace
from typing import Final

from scene_graph import ABOVE, UP, Stacks, format_stacks, spots_of

from ..errors import ImpossibleError, SearchLimitError, UnreachableError, UnstableError
from ..goals.goal import Goal
from ..validator import validate_stability
from .algorithms import AUTO
from .limits import DEFAULT_MAX_EXPANSIONS
from .plan import SearchResult, make_plan
from .possible import Exclusion, plan_avoiding
from .stability import Stability, Unstable

#: So many placements are named in a sentence.
_NAMED: Final = 3
_OTHERWISE: Final = "stability:=ignore plans it all the same"


def make_stable_plan(
    initial: Stacks,
    goal: Goal,
    stability: Stability | None,
    exclusions: Sequence[Exclusion] = (),
    max_expansions: int = DEFAULT_MAX_EXPANSIONS,
    cancelled: Callable[[], bool] = lambda: False,
    algorithm: str = AUTO,
) -> SearchResult:
    """A plan that was checked: a shortest one of those with the fewest unstable placements.

    Args:
        stability: None: what stands on what does not matter.
        exclusions: moves that the arm cannot make.
        algorithm: of the search among all plans; among the stable ones :mod:`possible` searches.

    Raises:
        UnstableError: proven: every plan puts a block where it cannot stand, or, where stability is
            required, where it is unstable.
        PlannerError: see :func:`make_plan` and :func:`plan_avoiding`.
    """
    started = time.perf_counter()
    if exclusions:
        shortest = plan_avoiding(initial, goal, exclusions, max_expansions, cancelled)
    else:
        shortest = make_plan(initial, goal, max_expansions, cancelled, algorithm)
    if stability is None:
        return shortest
    shaky = stability.unstable(initial, shortest.moves)
    if not shaky:
        validate_stability(initial, shortest.moves, stability, ())
        return shortest
    _check_goal(initial, goal, stability, shortest)
    try:
        found = plan_avoiding(initial, goal, exclusions, max_expansions, cancelled, stability)
    except ImpossibleError as error:
        error.args = (f"{error}; and without {_named(shaky)}",)
        raise
    except SearchLimitError as error:
        if stability.require or any(item.falls for item in shaky):
            error.args = (f"{error}; the shortest plan puts {_named(shaky)}; {_OTHERWISE}",)
            raise
        note = f"unstable: {_named(shaky)}; whether another plan avoids it was not found out"
        found, unstable, expanded = shortest, shaky, error.expanded
    except UnreachableError as error:
        raise UnstableError(
            f"no sequence of moves leads from {format_stacks(initial)} to '{goal}' without "
            f"something like {_named(shaky)}: all others were searched; {_OTHERWISE}",
            shortest.expanded + error.expanded,
            time.perf_counter() - started,
            shaky,
        ) from error
    else:
        unstable, expanded = stability.unstable(initial, found.moves), found.expanded
        note = _note(found, unstable, shortest, shaky)
    validate_stability(initial, found.moves, stability, unstable)
    return replace(
        found,
        unstable=unstable,
        note=note,
        expanded=shortest.expanded + expanded,
        seconds=time.perf_counter() - started,
    )


def _check_goal(initial: Stacks, goal: Goal, stability: Stability, shortest: SearchResult) -> None:
    """Raises UnstableError where the goal itself asks for what cannot stand."""
    spots = spots_of(initial, goal.rows.spot)
    for relation in goal.relations:
        if relation.predicate not in (UP, ABOVE) or relation.holds(spots):
            continue
        objection = stability.objection(relation.subject, relation.object)
        if objection is None:
            continue
        if objection.falls or (stability.require and relation.predicate == UP):
            raise UnstableError(
                f"'{relation.words}' is not possible: {relation.subject} cannot stand on "
                f"{relation.object}, {objection.reason}; {_OTHERWISE}",
                shortest.expanded,
                shortest.seconds,
                [objection],
            )


def _note(
    found: SearchResult,
    unstable: Sequence[Unstable],
    shortest: SearchResult,
    shaky: Sequence[Unstable],
) -> str:
    """Why a plan is longer than the shortest, and what it cannot avoid."""
    clauses = []
    longer = len(found.moves) - len(shortest.moves)
    if longer > 0:
        moves = "1 move" if longer == 1 else f"{longer} moves"
        other = "the shortest plan, which" if shortest.bound == 1.0 else "a plan that"
        clauses.append(f"{moves} longer than {other} puts {_named(shaky)}")
    if unstable:
        clauses.append(f"unstable, but no plan avoids it: {_named(unstable)}")
    return "; ".join(clauses)


def _named(placements: Sequence[Unstable]) -> str:
    texts = list(dict.fromkeys(map(str, placements)))
    more = f" and {len(texts) - _NAMED} more" if len(texts) > _NAMED else ""
    return ", ".join(texts[:_NAMED]) + more
