# SPDX-License-Identifier: Apache-2.0
"""What is on its way arrives when it should, once, and in the order in which it was sent."""

from __future__ import annotations

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from sim_node import DeliveryConfig
from sim_node.sensor import Delivery, is_lost

PERIOD = 0.1
TIMES = st.floats(0.0, 0.5)


def arrivals(config: DeliveryConfig, count: int, seed: int = 0) -> dict[int, float]:
    """When each of the pictures sent every 0.1 s arrives, looked at 60 times a second."""
    delivery: Delivery[int] = Delivery()
    rng = np.random.default_rng(seed)
    arrived: dict[int, float] = {}
    for turn in range(6 * (count + 12)):
        now = turn / 60.0
        arrived |= dict.fromkeys(delivery.arrived(now), now)
        if turn % 6 == 0 and turn < 6 * count:
            delivery.send(turn // 6, now, config, rng)
            arrived |= dict.fromkeys(delivery.arrived(now), now)
    assert len(delivery) == 0
    return arrived


def test_without_delay_it_is_there_at_once() -> None:
    assert arrivals(DeliveryConfig(), 3) == {0: 0.0, 1: 0.1, 2: 0.2}


@given(TIMES, TIMES, st.integers(0, 1000))
def test_each_arrives_once_in_order_and_within_its_time(
    delay: float, jitter: float, seed: int
) -> None:
    found = arrivals(DeliveryConfig(delay=delay, jitter=jitter), 20, seed)
    assert list(found) == list(range(20))
    late = np.array([time - index * PERIOD for index, time in found.items()])
    assert late.min() > delay - 1e-5
    assert late.max() < delay + jitter + 1.0 / 60.0 + 1e-5
    if jitter == 0.0:
        assert np.ptp(late) < 1.0 / 60.0 + 1e-5


def test_jitter_is_spread_over_its_range_and_the_same_for_the_same_seed() -> None:
    config = DeliveryConfig(delay=0.05, jitter=0.1)
    late = [time - index * PERIOD for index, time in arrivals(config, 300).items()]
    assert min(late) < 0.05 + 0.02 and max(late) > 0.15 - 0.01
    assert arrivals(config, 300) == arrivals(config, 300)
    assert arrivals(config, 300) != arrivals(config, 300, seed=1)


def test_what_is_on_its_way_can_be_lost() -> None:
    delivery: Delivery[str] = Delivery()
    delivery.send("picture", 0.0, DeliveryConfig(delay=1.0), np.random.default_rng())
    delivery.clear()
    assert delivery.arrived(100.0) == []


@pytest.mark.parametrize("probability", [0.0, 0.3, 1.0])
def test_so_many_are_lost(probability: float) -> None:
    rng = np.random.default_rng(5)
    lost = np.mean([is_lost(probability, rng) for _ in range(10_000)])
    assert lost == pytest.approx(probability, abs=0.02 if 0.0 < probability < 1.0 else 0.0)
