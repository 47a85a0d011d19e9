# SPDX-License-Identifier: Apache-2.0
"""No two graphs on a host get the same DDS domain."""

from __future__ import annotations

import os
import subprocess
import sys
import threading

import pytest
from tamp_runtime.domain import NoFreeDomainError, leave_in_turn, release_domain, reserve_domain

# None that a graph, or a suite that runs at the same time, could want.
FIRST = 1000 + 10 * os.getpid()


def test_domains_differ_until_there_is_none_left() -> None:
    ids = range(FIRST, FIRST + 5)
    assert {reserve_domain(ids) for _ in ids} == set(ids)
    with pytest.raises(NoFreeDomainError, match="in use"):
        reserve_domain(ids)
    release_domain(FIRST + 3)
    assert reserve_domain(ids) == FIRST + 3
    for domain_id in ids:
        release_domain(domain_id)


def test_a_domain_that_was_given_back_comes_last_again() -> None:
    ids = range(FIRST + 5, FIRST + 8)
    order = []
    for _ in range(6):
        order.append(reserve_domain(ids))
        release_domain(order[-1])
    assert set(order[:3]) == set(order[3:]) == set(ids)


def test_a_domain_is_free_again_when_its_process_was_killed() -> None:
    ids = [FIRST + 8]
    take = f"from tamp_runtime.domain import *; print(reserve_domain({ids}), flush=True); input()"
    holder = subprocess.Popen(
        [sys.executable, "-c", take], stdin=subprocess.PIPE, stdout=subprocess.PIPE, text=True
    )
    assert holder.stdout is not None
    assert holder.stdout.readline() == f"{ids[0]}\n"
    with pytest.raises(NoFreeDomainError):
        reserve_domain(ids)
    holder.kill()
    holder.communicate(timeout=60.0)
    assert reserve_domain(ids) == ids[0]
    release_domain(ids[0])


def test_processes_leave_a_domain_one_at_a_time(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setenv("ROS_DOMAIN_ID", str(FIRST + 9))
    order: list[str] = []

    def leave() -> None:
        with leave_in_turn(60.0):
            order.append("second")

    other = threading.Thread(target=leave)
    with leave_in_turn(60.0):
        other.start()
        other.join(0.1)
        order.append("first")
    other.join(60.0)
    assert order == ["first", "second"]


def test_who_hangs_while_it_leaves_does_not_keep_the_others(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    monkeypatch.setenv("ROS_DOMAIN_ID", str(FIRST + 9))
    with leave_in_turn(60.0), leave_in_turn(0.05), leave_in_turn(0.05):
        pass
    with leave_in_turn(0.0):
        pass
