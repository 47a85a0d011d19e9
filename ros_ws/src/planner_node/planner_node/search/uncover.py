# SPDX-License-Identifier: Apache-2.0
"""Moving what is seen aside, so that what it hides can be seen: the pre-checking of 5.4.3.

The thesis moves all visible blocks to the outermost stacks. Here the fewest moves are found after
which no stack hides a place of which it is not known what stands there.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import dataclass

from scene_graph import (
    Move,
    Place,
    Stacks,
    apply_move,
    base_name,
    format_stacks,
    hidden_places,
    is_hidden,
)

from ..errors import NotConfidentError
from .limits import Limits
from .plan import SearchResult
from .possible import Exclusion
from .stability import Stability


@dataclass(frozen=True)
class Sight:
    """What hides what in one scene.

    Attributes:
        places: with the heights up to which a stack hides nothing of others.
        heights: of everything that stands there, by name [m].
    """

    places: Sequence[Place]
    heights: Mapping[str, float]

    def hiders(self, stacks: Stacks, hidden: int) -> tuple[int, ...]:
        """The places whose stacks hide something of a place."""
        return tuple(
            place.index
            for place, stack in zip(self.places, stacks)
            if place.index != hidden
            and place.clear
            and sum(self.heights[name] for name in stack) > place.clear[hidden]
        )

    def sees(self, stacks: Stacks, places: Sequence[int]) -> bool:
        """Whether nothing hides any of some places."""
        return not any(self.hiders(stacks, place) for place in places)


def uncover(
    stacks: Stacks,
    sight: Sight,
    limits: Limits,
    exclusions: Sequence[Exclusion] = (),
    stability: Stability | None = None,
    rate: Callable[[Stacks], float] = lambda _: 0.0,
) -> SearchResult:
    """The fewest moves of blocks that are seen after which all places can be seen.

    Args:
        stacks: with what stands for hidden blocks, see :mod:`scene_graph.hidden`; this is neither
            moved nor is anything put on it.
        exclusions: moves that the arm cannot make.
        stability: nothing is put where it falls, or where it is unstable if a plan avoids that.
        rate: of plans with equally few moves the one to the state with the least is taken.

    Raises:
        NotConfidentError: no moves uncover what is hidden, or nothing that is seen hides it.
        SearchLimitError, SearchCancelledError: see :class:`Limits`.
    """
    hidden = hidden_places(stacks)
    where = ", ".join(map(base_name, hidden))
    if sight.sees(stacks, hidden):
        raise NotConfidentError(
            f"what stands on {where} is hidden, though no stack is high enough to hide it; look "
            "from higher up, or tidy up by hand"
        )
    for strict in (True, False):
        moves = _fewest(stacks, sight, limits, exclusions, stability, rate, strict)
        if moves is not None:
            break
    else:
        raise NotConfidentError(
            f"what stands on {where} is hidden, and no moves of the blocks that are seen in "
            f"{format_stacks(stacks)} uncover it; look from higher up, or tidy up by hand"
        )
    states = [stacks]
    for move in moves:
        states.append(apply_move(states[-1], move))
    note = _why(stacks, sight, hidden)
    return SearchResult(moves, tuple(states), limits.expanded, limits.seconds(), note=note)


def _fewest(
    stacks: Stacks,
    sight: Sight,
    limits: Limits,
    exclusions: Sequence[Exclusion],
    stability: Stability | None,
    rate: Callable[[Stacks], float],
    strict: bool,
) -> tuple[Move, ...] | None:
    """Breadth-first; None where no moves uncover everything."""
    hidden = hidden_places(stacks)
    plans: dict[Stacks, tuple[Move, ...]] = {stacks: ()}
    front = [stacks]
    while front:
        ends = [state for state in front if sight.sees(state, hidden)]
        if ends:
            return plans[min(ends, key=rate)]
        following: list[Stacks] = []
        for state in front:
            limits.count_expansion()
            for move, after in _moves(state, stability, strict):
                if after in plans or any(item.forbids(state, move) for item in exclusions):
                    continue
                plans[after] = (*plans[state], move)
                following.append(after)
        front = following
    return None


def _moves(
    stacks: Stacks, stability: Stability | None, strict: bool
) -> Iterator[tuple[Move, Stacks]]:
    for source, stack in enumerate(stacks):
        if not stack or is_hidden(stack[-1]):
            continue
        for target, other in enumerate(stacks):
            if target == source or (other and is_hidden(other[-1])):
                continue
            if stability and other and _is_shunned(stability, stack[-1], other[-1], strict):
                continue
            move = Move(source, target)
            yield move, apply_move(stacks, move)


def _is_shunned(stability: Stability, block: str, support: str, strict: bool) -> bool:
    """Whether a block is not put on another: it falls, or (strict) is unstable there."""
    objection = stability.objection(block, support)
    return objection is not None and (objection.falls or strict or stability.require)


def _why(stacks: Stacks, sight: Sight, hidden: Sequence[int]) -> str:
    """What is hidden by what, for people."""
    before = sorted({one for place in hidden for one in sight.hiders(stacks, place)})
    blocks = ", ".join(name for place in before for name in stacks[place] if not is_hidden(name))
    where = ", ".join(map(base_name, hidden))
    return (
        f"first what hides {where} is moved aside ({blocks} on "
        f"{', '.join(map(base_name, before))}), to see what stands there"
    )
