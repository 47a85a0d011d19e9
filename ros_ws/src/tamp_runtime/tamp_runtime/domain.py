# SPDX-License-Identifier: Apache-2.0
"""DDS domains of one's own: graphs that run at once on one host do not hear one another."""

from __future__ import annotations

import contextlib
import os
import random
import socket
import time
from collections import Counter
from collections.abc import Iterator, Sequence
from typing import Final

#: The domains whose ports are below those that Linux gives away; 0 is everybody's.
DOMAIN_IDS: Final = range(1, 102)

_POLL_SECONDS: Final = 0.01

#: What this process holds, by domain. An abstract Unix socket can be bound once on a host, and the
#: kernel frees it however the process ends: a lock without a file.
_held: dict[int, socket.socket] = {}
_uses: Counter[int] = Counter()


class NoFreeDomainError(RuntimeError):
    """Every domain is taken by some process of this host."""


def reserve_domain(ids: Sequence[int] = DOMAIN_IDS) -> int:
    """A domain id that no other caller on this host gets, until released or the process ends.

    One that was given back comes last again: others still remember for a while who was killed
    there.

    Raises:
        NoFreeDomainError: more graphs run at once than there are domains.
    """
    chance = random.SystemRandom()
    for domain_id in sorted(ids, key=lambda domain_id: (_uses[domain_id], chance.random())):
        lock = _lock(f"tamp_domain_{domain_id}")
        if lock is None:
            continue
        _held[domain_id] = lock
        _uses[domain_id] += 1
        return domain_id
    raise NoFreeDomainError(f"all {len(ids)} DDS domains of this host are in use")


def release_domain(domain_id: int) -> None:
    """Gives back a domain that this process holds.

    Raises:
        KeyError: it does not hold it.
    """
    _held.pop(domain_id).close()


@contextlib.contextmanager
def leave_in_turn(most_seconds: float) -> Iterator[None]:
    """While a process takes leave of its domain: one at a time on this host, in no order.

    Fast DDS 2.14.5 as it is built for PyPI never gets through the deletion of a participant that is
    just then being told that somebody else's publisher is gone (``DomainParticipant::set_listener``
    waits until a time that overflows, and keeps the lock that the other thread waits for). Of the
    nodes of a graph that are stopped together, one in a hundred hung.

    Args:
        most_seconds: it goes ahead after that, should somebody who leaves hang [s].
    """
    name = f"tamp_leave_{os.environ.get('ROS_DOMAIN_ID') or 0}"
    end = time.monotonic() + most_seconds
    while (lock := _lock(name)) is None and time.monotonic() < end:
        time.sleep(_POLL_SECONDS)
    try:
        yield
    finally:
        if lock is not None:
            lock.close()


def _lock(name: str) -> socket.socket | None:
    """A name that is bound until it is closed; None while somebody else has it."""
    lock = socket.socket(socket.AF_UNIX, socket.SOCK_DGRAM)
    try:
        lock.bind(f"\0{name}")
    except OSError:  # taken
        lock.close()
        return None
    return lock
