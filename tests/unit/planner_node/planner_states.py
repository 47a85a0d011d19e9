# SPDX-License-Identifier: Apache-2.0
"""Oracles that share no code with the planner: all states, and distances, by brute force."""

from __future__ import annotations

import itertools
import random
from collections.abc import Callable, Iterator

from hypothesis import strategies as st

from scene_graph import Relation, Stacks

State = Stacks

NAMES = ("red_box", "green_box", "blue_box", "yellow_cylinder", "purple_box", "orange_box")


def all_states(names: tuple[str, ...], stack_count: int) -> Iterator[State]:
    """Every way to put the objects into stacks: n!·C(n + m - 1, m - 1) states."""
    for order in itertools.permutations(names):
        walls = itertools.combinations_with_replacement(range(len(names) + 1), stack_count - 1)
        for inner in walls:
            cuts = (0, *inner, len(names))
            yield tuple(order[a:b] for a, b in itertools.pairwise(cuts))


def neighbours(state: State) -> Iterator[State]:
    for p in range(len(state)):
        for q in range(len(state)):
            if p != q and state[p]:
                stacks = [list(stack) for stack in state]
                stacks[q].append(stacks[p].pop())
                yield tuple(tuple(stack) for stack in stacks)


def distance(initial: State, holds: Callable[[State], bool]) -> int | None:
    """Moves to the nearest state that fulfils a condition; None if none is reachable."""
    seen, layer, depth = {initial}, [initial], 0
    while layer:
        if any(holds(state) for state in layer):
            return depth
        layer = [item for state in layer for item in set(neighbours(state)) if item not in seen]
        layer = list(dict.fromkeys(layer))
        seen.update(layer)
        depth += 1
    return None


def random_state(names: tuple[str, ...], stack_count: int, rng: random.Random) -> State:
    stacks: list[list[str]] = [[] for _ in range(stack_count)]
    for name in rng.sample(names, len(names)):
        rng.choice(stacks).append(name)
    return tuple(tuple(stack) for stack in stacks)


def relation_holds(state: State, relation: Relation) -> bool:
    """The meaning of a relation, told by walking through the stacks."""
    there = {f"stack{index}" for index in range(len(state))}.union(*state)
    if not {relation.subject, relation.object} <= there:
        return False
    if relation.predicate.startswith("not_"):
        positive = Relation(relation.subject, relation.predicate[4:], relation.object)
        return not relation_holds(state, positive)
    subject, predicate, object_ = relation.subject, relation.predicate, relation.object
    for index, stack in enumerate(state):
        column = [f"stack{index}", *stack]
        if subject not in column[1:]:
            continue
        below = column[: column.index(subject)]
        if predicate == "up":
            return below[-1] == object_
        if predicate == "above":
            return object_ in below
        if predicate == "beside":
            around = [*state[index + 1 : index + 2], *(state[index - 1 : index] if index else [])]
            return any(object_ in other for other in around)
        assert predicate == "left"
        return any(object_ in other for other in state[index + 1 :])
    return False


def relations_between(
    names: tuple[str, ...], bases: tuple[str, ...]
) -> st.SearchStrategy[Relation]:
    """Any relation that a goal can ask for, possible or not."""
    blocks = st.sampled_from(names)
    on = st.sampled_from(("up", "above", "not_up", "not_above"))
    apart = st.sampled_from(("left", "beside", "not_left", "not_beside"))
    return st.one_of(
        st.builds(Relation, blocks, on, st.sampled_from((*names, *bases))),
        st.builds(Relation, blocks, apart, blocks),
    )
