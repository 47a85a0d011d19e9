# SPDX-License-Identifier: Apache-2.0
"""The way from a camera to its subscribers, in simulated time."""

from __future__ import annotations

from collections import deque
from typing import Final, Generic, TypeVar

import numpy as np

from .config import DeliveryConfig

Item = TypeVar("Item")

#: Sums of steps of the physics are not exact [s].
_ROUNDING: Final = 1e-6


def is_lost(probability: float, rng: np.random.Generator) -> bool:
    """Whether something that happens with a probability happens."""
    return bool(rng.random() < probability)


class Delivery(Generic[Item]):
    """What is on its way; nothing overtakes what was sent before it."""

    def __init__(self) -> None:
        self._under_way: deque[tuple[float, Item]] = deque()

    def __len__(self) -> int:
        return len(self._under_way)

    def send(
        self, item: Item, now: float, config: DeliveryConfig, rng: np.random.Generator
    ) -> None:
        """Takes something that arrives ``delay`` from now, and up to ``jitter`` later [s]."""
        arrival = now + config.delay
        if config.jitter > 0.0:
            arrival += rng.uniform(0.0, config.jitter)
        if self._under_way:
            arrival = max(arrival, self._under_way[-1][0])
        self._under_way.append((arrival, item))

    def arrived(self, now: float) -> list[Item]:
        """What has arrived by now [s], in the order in which it was sent; each is told once."""
        items = []
        while self._under_way and self._under_way[0][0] <= now + _ROUNDING:
            items.append(self._under_way.popleft()[1])
        return items

    def clear(self) -> None:
        """Loses all that is on its way."""
        self._under_way.clear()
