# SPDX-License-Identifier: Apache-2.0
"""How long a search may go on, and the errors that end one without a plan."""

from __future__ import annotations

import time
from collections.abc import Callable
from typing import Final

from scene_graph import Stacks, format_stacks

from ..errors import SearchCancelledError, SearchLimitError, UnreachableError
from ..goals.goal import Goal

DEFAULT_MAX_EXPANSIONS: Final = 1_000_000
#: Expansions between two looks at ``cancelled``; a few milliseconds.
POLL_INTERVAL: Final = 2000


class Limits:
    """Counts the expansions of one search and ends it; algorithms call it, callers read it.

    Attributes:
        expanded: number of states whose successors were generated.
        at_least: moves that every plan has, as far as the algorithm has proven it; None: it has
            told nothing, and what it finds is shortest.
    """

    def __init__(
        self,
        initial: Stacks,
        goal: Goal,
        max_expansions: int = DEFAULT_MAX_EXPANSIONS,
        cancelled: Callable[[], bool] = lambda: False,
    ) -> None:
        self.expanded = 0
        self.at_least: int | None = None
        self._initial = initial
        self._goal = goal
        self._max_expansions = max_expansions
        self._cancelled = cancelled
        self._started = time.perf_counter()

    def seconds(self) -> float:
        """Wall time since the search began [s]."""
        return time.perf_counter() - self._started

    def count_expansion(self) -> None:
        """To be called before the successors of a state are generated.

        Raises:
            SearchLimitError: as many as are allowed were expanded.
            SearchCancelledError: the caller wants no answer any more; asked now and then.
        """
        if self.expanded >= self._max_expansions:
            raise self._exhausted()
        if self.expanded % POLL_INTERVAL == 0:
            self.poll()
        self.expanded += 1

    def count_expansions(self, number: int) -> int:
        """As :meth:`count_expansion` for many states at once; how many of them may be expanded.

        To be called at least every few milliseconds: it looks at ``cancelled`` every time.
        """
        self.poll()
        if self.expanded >= self._max_expansions:
            raise self._exhausted()
        allowed = min(number, self._max_expansions - self.expanded)
        self.expanded += allowed
        return allowed

    def poll(self) -> None:
        """Raises SearchCancelledError if the caller wants no answer any more."""
        if self._cancelled():
            raise SearchCancelledError(
                f"the search was cancelled after {self.expanded} states",
                self.expanded,
                self.seconds(),
            )

    def prove_at_least(self, moves: int) -> None:
        """To be told by algorithms that know a bound: no plan has fewer moves."""
        self.at_least = max(moves, self.at_least or 0)

    def of_a_part(self, max_expansions: int | None = None) -> PartLimits:
        """For the search of a part of the problem, whose expansions count here.

        Args:
            max_expansions: of the part; it ends with PartTooLargeError. None: as many as the whole.
        """
        return PartLimits(self, max_expansions)

    def impossible(self) -> UnreachableError:
        """To be raised when no arrangement of the blocks at all is a goal."""
        return UnreachableError(
            f"no sequence of moves leads from {format_stacks(self._initial)} to '{self._goal}': "
            f"no arrangement of these blocks on {len(self._initial)} places fulfils it",
            self.expanded,
            self.seconds(),
        )

    def _exhausted(self) -> SearchLimitError:
        return SearchLimitError(
            f"'{self._goal}' was not reached within {self._max_expansions} expanded states; "
            "raise max_expansions, or ask for less",
            self.expanded,
            self.seconds(),
        )

    def unreachable(self) -> UnreachableError:
        """To be raised when every reachable state was expanded and none is a goal."""
        return UnreachableError(
            f"no sequence of moves leads from {format_stacks(self._initial)} to '{self._goal}': "
            f"all reachable states were searched ({self.expanded} expanded)",
            self.expanded,
            self.seconds(),
        )


class PartTooLargeError(Exception):
    """A part of a search is given up; its algorithm goes on without."""


class PartLimits(Limits):
    """Those of a part of a search: counts for the whole, and what is proven stays in the part."""

    def __init__(self, whole: Limits, max_expansions: int | None) -> None:
        super().__init__(whole._initial, whole._goal)
        self._whole = whole
        self._most = max_expansions

    def count_expansion(self) -> None:
        """See :class:`Limits`."""
        self._left(1)
        self._whole.count_expansion()
        self.expanded += 1

    def count_expansions(self, number: int) -> int:
        """See :class:`Limits`."""
        allowed = self._whole.count_expansions(self._left(number))
        self.expanded += allowed
        return allowed

    def poll(self) -> None:
        """See :class:`Limits`."""
        self._whole.poll()

    def _left(self, number: int) -> int:
        if self._most is None:
            return number
        if self.expanded >= self._most:
            raise PartTooLargeError(f"a part was not solved within {self._most} expanded states")
        return min(number, self._most - self.expanded)
