# SPDX-License-Identifier: Apache-2.0
"""Which grasp and which direction of the hand each move takes, found by the bounds' verdicts.

The preferred choices come first. Where a bound refuses a move, the move's next choice is tried;
when all are refused, the move is, with the reason of the choice that misses least.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from typing import TypeVar

from scene_graph import Move

from .blocks import Scene
from .errors import MOVING, PATH, PUTTING, SCENE, TAKING, InfeasibleError
from .expand import Choice
from .phases import PICK, Phase

Found = TypeVar("Found")


def solve_choosing(
    scene: Scene,
    moves: Sequence[Move],
    phases_for: Callable[[Scene, Sequence[Move], Sequence[Choice]], Sequence[Phase]],
    solve: Callable[[Sequence[Phase], Scene, bool], Found],
    only_for: Callable[[int], Scene],
) -> Found:
    """What ``solve`` gives for the first choices that no bound refuses.

    Args:
        phases_for: the phases that choices, one a move, lead to in a scene.
        solve: phases in a scene, from where the arm is or (True) from home.
        only_for: the scene before a move with no other stacks than the move's two.

    Raises:
        InfeasibleError: a move that is refused with all choices; ``excludes`` tells how widely.
    """

    def attempt(own: Scene, some: Sequence[Move], at_home: bool) -> Found:
        return first_possible(
            len(some),
            lambda choices: phases_for(own, some, choices),
            lambda phases: solve(phases, own, at_home),
        )

    try:
        return attempt(scene, moves, False)
    except InfeasibleError as error:
        if error.bound == PATH and error.move < len(moves):
            try:
                attempt(only_for(error.move), [moves[error.move]], True)
            except InfeasibleError:
                error.excludes = MOVING
        raise


def first_possible(
    moves: int,
    phases_for: Callable[[Sequence[Choice]], Sequence[Phase]],
    solve: Callable[[Sequence[Phase]], Found],
) -> Found:
    """What ``solve`` gives for the first choices that no bound refuses.

    Args:
        moves: how many there are.
        phases_for: the phases that choices, one a move, lead to.
        solve: raises InfeasibleError.

    Raises:
        InfeasibleError: a move that is refused with all choices; ``excludes`` tells how widely.
    """
    choices = [Choice()] * moves
    refused: list[list[InfeasibleError]] = [[] for _ in choices]
    while True:
        phases = phases_for(choices)
        try:
            return solve(phases)
        except InfeasibleError as error:
            move = min(error.move, moves - 1)
            if move < 0:
                raise
            error.excludes = error.excludes or SCENE
            refused[move].append(error)
            grasps = max(phase.grasps for phase in phases if phase.move == move)
            following = _after(choices[move], grasps, error)
            if following is None:
                raise _verdict(refused[move]) from error
            choices[move:] = [following] + [Choice()] * (moves - move - 1)
            refused[move + 1 :] = [[] for _ in refused[move + 1 :]]


def _after(choice: Choice, grasps: int, error: InfeasibleError) -> Choice | None:
    """The next choice: other grasps first, then the same put down across."""
    order = [Choice(grasp, across) for across in (False, True) for grasp in range(grasps)]
    later = order[order.index(choice) + 1 :]
    if error.excludes == TAKING or error.phase == PICK:
        # Putting the block down in another way does not help to take it.
        later = [other for other in later if other.grasp != choice.grasp]
    return later[0] if later else None


def _verdict(refused: Sequence[InfeasibleError]) -> InfeasibleError:
    """Of a move's refusals that of the choice that got farthest, and what they exclude together.

    Of equals the one that misses least.
    """

    def rank(error: InfeasibleError) -> tuple[bool, bool, float]:
        return error.bound != PATH, error.phase == PICK, error.violation

    told = min(refused, key=rank)
    kinds = {error.excludes for error in refused}
    if len(kinds) == 1:
        told.excludes = kinds.pop()
    else:
        told.excludes = MOVING if kinds <= {TAKING, PUTTING, MOVING} else SCENE
    return told
