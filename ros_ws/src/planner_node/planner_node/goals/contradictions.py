# SPDX-License-Identifier: Apache-2.0
"""Goals whose relations exclude one another, found before the search and named in a sentence.

The rules are sound: what they refuse, no arrangement of blocks fulfils, whatever the scene. They
are not complete; what they let pass and is impossible all the same, the search proves unreachable.
They know ``up``, ``above``, ``left``, ``front``, ``beside`` and their negations; of other
predicates they say nothing.
"""

from __future__ import annotations

from collections.abc import Callable, Iterable, Mapping, Sequence
from functools import partial
from typing import Final

from scene_graph import (
    ABOVE,
    BESIDE,
    FRONT,
    LEFT,
    NOT,
    ONE_ROW,
    PREDICATES,
    UP,
    Relation,
    Rows,
    base_index,
    base_name,
)

from ..errors import ContradictoryGoalError
from .goal import Count, Goal

_KNOWN: Final = (UP, ABOVE, LEFT, BESIDE, FRONT)


def check_contradictions(goal: Goal, stack_count: int) -> None:
    """Raises ContradictoryGoalError with a smallest set of relations that exclude one another."""
    relations, find = list(goal.relations), partial(find_contradiction, rows=goal.rows)
    if find(relations, stack_count) is not None:
        relations = _fewest(relations, lambda some: find(some, stack_count))
        problem = find(relations, stack_count)
        assert problem is not None
        raise ContradictoryGoalError([item.words for item in relations], problem)
    for count in goal.counts:
        if _uncountable(count, relations, stack_count, goal.rows):
            problem_of = partial(_uncountable, count, stack_count=stack_count, rows=goal.rows)
            relations = _fewest(relations, problem_of)
            problem = problem_of(relations)
            assert problem is not None
            raise ContradictoryGoalError([*(item.words for item in relations), str(count)], problem)


def _fewest(
    relations: Sequence[Relation], problem_of: Callable[[Sequence[Relation]], str | None]
) -> list[Relation]:
    """A part of the relations that has a problem too, and none without any one of them."""
    left = list(relations)
    for relation in relations:
        fewer = [item for item in left if item != relation]
        if problem_of(fewer) is not None:
            left = fewer
    return left


def _uncountable(
    count: Count, relations: Sequence[Relation], stack_count: int, rows: Rows
) -> str | None:
    """Why too few of a count's relations go with the others, each by itself."""
    fitting = [
        item
        for item in count.relations
        if find_contradiction([*relations, item], stack_count, rows) is None
    ]
    if len(fitting) >= count.least:
        return None
    return f"'{count}' cannot be: {_number_that_could_hold(fitting)}"


def _number_that_could_hold(fitting: Sequence[Relation]) -> str:
    if not fitting:
        return "none of the blocks it speaks of can be there"
    return f"only {', '.join(item.words for item in fitting)} can be"


def find_contradiction(
    relations: Iterable[Relation], stack_count: int, rows: Rows = ONE_ROW
) -> str | None:
    """Why no state of ``stack_count`` stacks fulfils all relations; None if no reason is found.

    Args:
        rows: how their places lie.
    """
    relations = tuple(relations)
    for relation in relations:
        if problem := _impossible_alone(relation, stack_count, rows):
            return problem
    never = {
        (item.subject, item.predicate.removeprefix(NOT), item.object)
        for item in relations
        if item.predicate.startswith(NOT)
    }
    relations = tuple(item for item in relations if item.predicate in _KNOWN)
    return (
        _denied(relations, never)
        or _two_at_one_place(relations)
        or _impossible_columns(relations, stack_count, rows)
        or _impossible_order(relations, never)
    )


def _denied(relations: Iterable[Relation], never: set[tuple[str, str, str]]) -> str | None:
    for item in relations:
        if (item.subject, item.predicate, item.object) in never:
            return f"{item.words} cannot be and not be"
    return None


def _impossible_alone(relation: Relation, stack_count: int, rows: Rows) -> str | None:
    names = (relation.subject, relation.object)
    for name in names:
        index = base_index(name)
        if index is not None and index >= stack_count:
            known = ", ".join(base_name(item) for item in range(stack_count))
            return f"{name} does not exist; there are {known}"
    if base_index(relation.subject) is not None and relation.predicate in (UP, ABOVE):
        return f"{relation.subject} is a place, it cannot be moved"
    if relation.subject == relation.object and relation.predicate in _KNOWN:
        return f"{relation.subject} cannot be {PREDICATES[relation.predicate].words} itself"
    if relation.predicate == FRONT and rows.count == 1:
        return (
            f"{relation.subject} cannot be in front of {relation.object}: all places lie in one row"
        )
    return None


def _two_at_one_place(relations: tuple[Relation, ...]) -> str | None:
    below: dict[str, str] = {}
    above: dict[str, str] = {}
    for relation in relations:
        if relation.predicate != UP:
            continue
        other = below.setdefault(relation.subject, relation.object)
        if other != relation.object:
            return f"{relation.subject} cannot stand directly on both {other} and {relation.object}"
        other = above.setdefault(relation.object, relation.subject)
        if other != relation.subject:
            return f"{other} and {relation.subject} cannot both stand directly on {relation.object}"
    return None


def _impossible_order(
    relations: tuple[Relation, ...], never: set[tuple[str, str, str]]
) -> str | None:
    """Closes "is somewhere above" and looks for something above itself, or where it may not be."""
    on = {(item.subject, item.object) for item in relations if item.predicate == UP}
    above = on | {(item.subject, item.object) for item in relations if item.predicate == ABOVE}
    stack_of = _stacks_of(relations)
    while True:
        derived = _joined(above)
        for upper, lower in on:
            # Nothing fits in between: what is above the lower one is above the upper one too,
            # and what the upper one is above, the lower one is above too.
            derived |= {(a, upper) for a, b in above if b == lower and a != upper}
            derived |= {(lower, d) for c, d in above if c == upper and d != lower}
            if base_index(lower) is not None:
                derived |= {
                    (name, upper)
                    for name, stack in stack_of.items()
                    if stack == stack_of[upper] and name != upper and base_index(name) is None
                }
        if derived <= above:
            break
        above |= derived
    for upper, lower in sorted(above):
        if base_index(upper) is not None:
            return f"{lower} would have to be below {upper}, the lowest place of its stack"
    for upper, lower in sorted(above):
        if upper == lower:
            return f"{upper} would have to be above itself"
        if (upper, ABOVE, lower) in never:
            return f"{upper} would have to be above {lower}"
    return None


def _impossible_columns(
    relations: tuple[Relation, ...], stack_count: int, rows: Rows
) -> str | None:
    """What cannot be of the stacks' places, one beside the other or one in front of the other."""
    stack_of = _stacks_of(relations)
    base_of: dict[str, str] = {}
    for name, stack in stack_of.items():
        index = base_index(name)
        if index is None:
            continue
        if stack in base_of:
            return f"{base_of[stack]} and {name} would have to be one stack"
        base_of[stack] = name
    for predicate in (LEFT, FRONT, BESIDE):
        for item in relations:
            if item.predicate == predicate and stack_of[item.subject] == stack_of[item.object]:
                return f"{item.subject} and {item.object} would have to be in one stack and apart"
    columns = rows.columns or tuple(range(stack_count))
    among = "stacks" if rows.count == 1 else "columns of stacks"
    return _impossible_axis(LEFT, among, relations, stack_of, base_of, columns) or _impossible_axis(
        FRONT, "rows", relations, stack_of, base_of, rows.rows
    )


def _impossible_axis(
    predicate: str,
    among: str,
    relations: tuple[Relation, ...],
    stack_of: Mapping[str, str],
    base_of: Mapping[str, str],
    ranks: Sequence[int],
) -> str | None:
    """Bounds the rank of every stack along an axis; a left-of, or front-of, moves them by one.

    Args:
        stack_of, base_of: which stack a name is in, and the base of a stack where it is known.
        ranks: of the places.
    """
    lefts = [item for item in relations if item.predicate == predicate]
    if not lefts:
        return None
    words, count = PREDICATES[predicate].words, max(ranks) + 1
    low = dict.fromkeys(stack_of.values(), 0)
    high = dict.fromkeys(stack_of.values(), count - 1)
    for stack, name in base_of.items():
        index = base_index(name)
        assert index is not None
        low[stack] = high[stack] = ranks[index]
    order = {(stack_of[item.subject], stack_of[item.object]) for item in lefts}
    while not (more := _joined(order)) <= order:
        order |= more
    for item in lefts:
        if (stack_of[item.subject], stack_of[item.subject]) in order:
            return f"{item.subject} would have to be {words} itself"
    # Along the longest chain every round settles the bounds of one more stack.
    for _ in low:
        for item in lefts:
            left, right = stack_of[item.subject], stack_of[item.object]
            low[right] = max(low[right], low[left] + 1)
            high[left] = min(high[left], high[right] - 1)
            if low[right] > high[right] or low[left] > high[left]:
                return (
                    f"{item.subject} cannot be {words} {item.object} as well: "
                    f"there are only {count} {among}"
                )
    return None


def _joined(pairs: set[tuple[str, str]]) -> set[tuple[str, str]]:
    """All (a, d) with (a, b) and (b, d) among the pairs."""
    return {(a, d) for a, b in pairs for c, d in pairs if b == c}


def _stacks_of(relations: tuple[Relation, ...]) -> dict[str, str]:
    """For every object and base, a representative of those that must share its stack."""
    stack_of = {name: name for item in relations for name in (item.subject, item.object)}
    for item in relations:
        if item.predicate in (UP, ABOVE):
            kept, merged = stack_of[item.subject], stack_of[item.object]
            stack_of = {
                name: kept if stack == merged else stack for name, stack in stack_of.items()
            }
    return stack_of
