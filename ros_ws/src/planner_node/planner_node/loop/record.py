# SPDX-License-Identifier: Apache-2.0
"""What is noted of one run of achieve_goal: times, moves, and why plans were given up."""

from __future__ import annotations

from collections.abc import Iterator
from contextlib import contextmanager
from dataclasses import replace
from typing import Any

from tamp_runtime.motion_report import MotionReport

from .clock import Clock
from .report import Outcome


class Record:
    """The outcome of a run, while it goes on.

    Attributes:
        outcome: kept up to date, so that it can be given even after a defect.
    """

    def __init__(self, clock: Clock) -> None:
        self.outcome = Outcome()
        self._clock = clock

    def note(self, **changes: Any) -> None:
        """Changes fields of the outcome."""
        self.outcome = replace(self.outcome, **changes)

    def because(self, cause: str) -> None:
        """Notes why a plan was given up, failed or is made anew."""
        self.note(causes=(*self.outcome.causes, cause))

    def planned(self, moves: int) -> None:
        """Notes so many moves more of a plan."""
        self.note(moves_planned=self.outcome.moves_planned + moves)

    def carried_out(self, last: MotionReport, elapsed: float) -> None:
        """Notes what became of a plan; ``elapsed`` [s] is motion optimisation and execution."""
        outcome = self.outcome
        execution = max(0.0, elapsed - last.optimisation_seconds)
        self.note(
            motion=last,
            moves_executed=outcome.moves_executed + last.moves_done,
            motion_seconds=outcome.motion_seconds + last.optimisation_seconds,
            execute_seconds=outcome.execute_seconds + execution,
        )

    @contextmanager
    def timed(self, field: str) -> Iterator[None]:
        """Adds the wall time that passes inside to a field of the outcome."""
        started = self._clock.now()
        try:
            yield
        finally:
            elapsed = self._clock.now() - started
            self.note(**{field: getattr(self.outcome, field) + elapsed})
