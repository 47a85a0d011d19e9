# SPDX-License-Identifier: Apache-2.0
"""A perception whose places are given, or found once and then kept while towers come and go."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace

from .config import PerceptionConfig
from .observation import Observation
from .pipeline import Perceived, Perception


class PlacesKept:
    """What interprets one observation after another.

    Attributes:
        perception: with the places that are known by now.
        finds: whether they are found; else they are given.
    """

    def __init__(self, perception: Perception, finds: bool, tell: Callable[[str], None]) -> None:
        """``tell`` is called with a sentence whenever places were found."""
        self.perception, self.finds = perception, finds
        self._tell = tell
        self._newest: Observation | None = None

    def __str__(self) -> str:
        spots = [f"({x:.3f}, {y:.3f})" for x, y, _ in self.perception.config.stack_positions]
        if self.finds and not spots:
            return "places to be found"
        return f"{len(spots)} places at {', '.join(spots)} m"

    def configure(self, config: PerceptionConfig) -> None:
        """From now on all is as configured, but for places that were found."""
        if self.finds:
            positions = self.perception.config.stack_positions
            config = replace(config, stack_positions=positions)
        self.perception = self.perception.configured(config)

    def perceive(self, observation: Observation) -> Perceived:
        """Interprets an observation; places that are to be found and were not yet are so in it."""
        self._newest = observation
        if self.finds and not self.perception.places.places:
            return self._find(observation)
        return self.perception.perceive(observation)

    def find_anew(self) -> tuple[bool, str]:
        """Whether other places took the place of the known ones, and which, or why not."""
        if not self.finds:
            return False, "the places are given by stack_positions; set places to found"
        if self._newest is None:
            return False, "no picture has come yet; look at scene_graph"
        before = self.perception
        perceived = self._find(self._newest)
        is_found = self.perception is not before
        return is_found, str(self) if is_found else perceived.message

    def _find(self, observation: Observation) -> Perceived:
        found, perceived = self.perception.find_places(observation)
        if found is not self.perception:
            self.perception = found
            self._tell(f"found {self}")
        return perceived
