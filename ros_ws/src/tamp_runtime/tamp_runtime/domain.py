# SPDX-License-Identifier: Apache-2.0
"""DDS domains of one's own: graphs that run at once on one host do not hear one another."""

from __future__ import annotations

import random
import socket
from collections import Counter
from collections.abc import Sequence
from typing import Final

#: The domains whose ports are below those that Linux gives away; 0 is everybody's.
DOMAIN_IDS: Final = range(1, 102)

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
        lock = socket.socket(socket.AF_UNIX, socket.SOCK_DGRAM)
        try:
            lock.bind(f"\0tamp_domain_{domain_id}")
        except OSError:  # taken
            lock.close()
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
