# SPDX-License-Identifier: Apache-2.0
"""Simulated time goes at the chosen share of the host's, and does not rush to catch up."""

from __future__ import annotations

import pytest

from sim_node.pacing import Pacer


class HostClock:
    def __init__(self) -> None:
        self.now = 100.0

    def __call__(self) -> float:
        return self.now


@pytest.mark.parametrize("factor", [0.01, 0.5, 1.0, 5.0])
def test_simulated_time_takes_its_share_of_the_host_s(factor: float) -> None:
    clock, simulated = HostClock(), 7.0
    pacer = Pacer(simulated, factor, clock)
    for _ in range(100):
        simulated += 0.02
        clock.now += pacer.pause(simulated)
        assert pacer.pause(simulated) == pytest.approx(0.0, abs=1e-9)
    assert clock.now - 100.0 == pytest.approx(2.0 / factor)


def test_factor_zero_never_waits() -> None:
    assert Pacer(0.0, 0.0, HostClock()).pause(1e6) == 0.0


def test_small_delays_are_caught_up_and_long_ones_are_not() -> None:
    clock = HostClock()
    pacer = Pacer(0.0, 1.0, clock)
    clock.now += 0.2
    assert pacer.pause(0.1) == 0.0
    assert pacer.pause(0.3) == pytest.approx(0.1)
    clock.now += 60.0  # the machine stood still
    assert pacer.pause(0.4) == 0.0
    assert pacer.pause(0.5) == pytest.approx(0.1)


def test_a_changed_factor_holds_from_then_on() -> None:
    clock = HostClock()
    pacer = Pacer(0.0, 0.001, clock)
    assert pacer.pause(0.3) == pytest.approx(300.0)
    pacer.change(0.3, 10.0)
    assert pacer.pause(0.3) == 0.0
    assert pacer.pause(0.4) == pytest.approx(0.01)
