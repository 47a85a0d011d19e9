# SPDX-License-Identifier: Apache-2.0
"""Search on any action model, from one state to another: breadth first, A*, and from both ends.

It knows nothing of what a state is. The searches beside it are for stacks, and much faster there.
"""

from __future__ import annotations

import heapq
from collections.abc import Callable, Hashable
from dataclasses import dataclass
from typing import Final, Generic, TypeVar

from scene_graph import Move

from ..action_models.interface import ActionModel

State = TypeVar("State", bound=Hashable)
_Reached = dict[State, "tuple[Move, State] | None"]

DEFAULT_MAX_STATES: Final = 20_000


class NoModelPlanError(Exception):
    """No plan was found: ``exhausted`` tells whether everything that the model reaches was seen."""

    def __init__(self, message: str, exhausted: bool) -> None:
        super().__init__(message)
        self.exhausted = exhausted


@dataclass(frozen=True)
class ModelPlan(Generic[State]):
    """Moves, and the states before, between and after them.

    Attributes:
        expanded: number of states that the model was asked about.
    """

    moves: tuple[Move, ...]
    states: tuple[State, ...]
    expanded: int


#: From a model, a start, a goal and a bound on states to a shortest plan as the model has it.
ModelSearch = Callable[[ActionModel[State], State, State, int], ModelPlan[State]]


def breadth_first_on(
    model: ActionModel[State], start: State, goal: State, max_states: int = DEFAULT_MAX_STATES
) -> ModelPlan[State]:
    """Layer by layer from the start, each in one question to the model (Algorithm A.1).

    Raises:
        NoModelPlanError: all that can be reached was searched, or ``max_states`` were found.
    """
    reached: _Reached[State] = {start: None}
    layer, expanded = [start], 0
    while goal not in reached:
        _check(layer, reached, max_states)
        expanded += len(layer)
        layer = _next_layer(model, layer, reached)
    moves, states = _way(goal, reached)
    return ModelPlan(moves, states, expanded)


def both_ends_on(
    model: ActionModel[State], start: State, goal: State, max_states: int = DEFAULT_MAX_STATES
) -> ModelPlan[State]:
    """Layers from the start and from the goal until they meet.

    Every move (p, q) is undone by (q, p), so that the model serves for both directions.

    Raises:
        NoModelPlanError: see :func:`breadth_first_on`.
    """
    sides: list[_Reached[State]] = [{start: None}, {goal: None}]
    layers, expanded = [[start], [goal]], 0
    while not (met := [state for state in layers[0] if state in sides[1]]) and not (
        met := [state for state in layers[1] if state in sides[0]]
    ):
        side = 0 if len(layers[0]) <= len(layers[1]) else 1
        _check(layers[side], sides[side], max_states)
        expanded += len(layers[side])
        layers[side] = _next_layer(model, layers[side], sides[side])
    there, states = _way(met[0], sides[0])
    back, after = _way(met[0], sides[1])
    undone = tuple(Move(move.target, move.source) for move in reversed(back))
    return ModelPlan((*there, *undone), (*states, *after[-2::-1]), expanded)


def a_star_on(
    model: ActionModel[State],
    start: State,
    goal: State,
    max_states: int = DEFAULT_MAX_STATES,
    moves_left: Callable[[State], int] = lambda _state: 0,
) -> ModelPlan[State]:
    """The states of least depth + ``moves_left`` first, all of them in one question.

    The plan is a shortest one where ``moves_left`` is never more than what is left.

    Raises:
        NoModelPlanError: see :func:`breadth_first_on`.
    """
    reached: _Reached[State] = {start: None}
    depths, expanded = {start: 0}, set[State]()
    order = 0
    queue: list[tuple[int, int, int, State]] = [(moves_left(start), 0, order, start)]
    while queue:
        least = queue[0][0]
        chosen: list[State] = []
        while queue and queue[0][0] == least:
            state = heapq.heappop(queue)[3]
            if state == goal:
                moves, states = _way(goal, reached)
                return ModelPlan(moves, states, len(expanded))
            if state not in expanded:
                expanded.add(state)
                chosen.append(state)
        _check(chosen or [start], reached, max_states)
        for state, options in zip(chosen, model.successors(chosen)):
            depth = depths[state] + 1
            for move, after in options:
                if depth < depths.get(after, depth + 1):
                    depths[after], reached[after] = depth, (move, state)
                    expanded.discard(after)
                    order += 1
                    heapq.heappush(queue, (depth + moves_left(after), -depth, order, after))
    raise _unreachable(reached)


def _next_layer(
    model: ActionModel[State], layer: list[State], reached: _Reached[State]
) -> list[State]:
    found = []
    for state, options in zip(layer, model.successors(layer)):
        for move, after in options:
            if after not in reached:
                reached[after] = (move, state)
                found.append(after)
    return found


def _way(end: State, reached: _Reached[State]) -> tuple[tuple[Move, ...], tuple[State, ...]]:
    moves, states = [], [end]
    while (step := reached[states[-1]]) is not None:
        moves.append(step[0])
        states.append(step[1])
    return tuple(reversed(moves)), tuple(reversed(states))


def _check(layer: list[State], reached: _Reached[State], max_states: int) -> None:
    if not layer:
        raise _unreachable(reached)
    if len(reached) > max_states:
        raise NoModelPlanError(
            f"the goal was not found among {len(reached)} states; allow more, or check that the "
            "goal is of the same blocks",
            exhausted=False,
        )


def _unreachable(reached: _Reached[State]) -> NoModelPlanError:
    return NoModelPlanError(
        f"the action model reaches {len(reached)} states, and the goal is none of them",
        exhausted=True,
    )
