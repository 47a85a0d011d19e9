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
    """

    def __init__(
        self,
        initial: Stacks,
        goal: Goal,
        max_expansions: int = DEFAULT_MAX_EXPANSIONS,
        cancelled: Callable[[], bool] = lambda: False,
    ) -> None:
        self.expanded = 0
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
            raise SearchLimitError(
                f"'{self._goal}' was not reached within {self._max_expansions} expanded states; "
                "raise max_expansions, or ask for less",
                self.expanded,
                self.seconds(),
            )
        if self.expanded % POLL_INTERVAL == 0 and self._cancelled():
            raise SearchCancelledError(
                f"the search was cancelled after {self.expanded} states",
                self.expanded,
                self.seconds(),
            )
        self.expanded += 1

    def unreachable(self) -> UnreachableError:
        """To be raised when every reachable state was expanded and none is a goal."""
        return UnreachableError(
            f"no sequence of moves leads from {format_stacks(self._initial)} to '{self._goal}': "
            f"all reachable states were searched ({self.expanded} expanded)",
            self.expanded,
            self.seconds(),
        )
