# SPDX-License-Identifier: Apache-2.0
"""What a relay can do to its topic."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from typing import Any

from faults.relay import Handler, Outlet, read, write

#: Damages a message; None: it is lost.
Damage = Callable[[Any], Any]


@dataclass(frozen=True)
class Drop:
    """Nothing passes; with ``keep`` every so-manieth message still does."""

    keep: int = 0

    def begin(self, outlet: Outlet) -> Handler:
        """See :class:`faults.relay.Mode`."""
        count = 0

        def handle(message: bytes) -> None:
            nonlocal count
            count += 1
            if self.keep and count % self.keep == 0:
                outlet.emit(message)

        return handle


@dataclass(frozen=True)
class Delay:
    """Everything arrives later [s]."""

    seconds: float

    def begin(self, outlet: Outlet) -> Handler:
        """See :class:`faults.relay.Mode`."""
        return lambda message: outlet.emit_later(message, self.seconds)


@dataclass(frozen=True)
class Repeat:
    """Every message arrives several times; with ``after`` the copies come later [s]."""

    times: int = 2
    after: float = 0.0

    def begin(self, outlet: Outlet) -> Handler:
        """See :class:`faults.relay.Mode`."""

        def handle(message: bytes) -> None:
            outlet.emit(message)
            for copy in range(1, self.times):
                if self.after:
                    outlet.emit_later(message, copy * self.after)
                else:
                    outlet.emit(message)

        return handle


@dataclass(frozen=True)
class Swap:
    """Messages arrive in pairs, the second one first."""

    def begin(self, outlet: Outlet) -> Handler:
        """See :class:`faults.relay.Mode`."""
        kept: list[bytes] = []

        def handle(message: bytes) -> None:
            if kept:
                outlet.emit(message)
                outlet.emit(kept.pop())
            else:
                kept.append(message)

        return handle


@dataclass(frozen=True)
class Freeze:
    """The last message again and again, stamp and all."""

    def begin(self, outlet: Outlet) -> Handler:
        """See :class:`faults.relay.Mode`."""
        frozen = outlet.last

        def handle(message: bytes) -> None:
            outlet.emit(frozen or message)

        return handle


@dataclass(frozen=True)
class FreezeContent:
    """The last message again and again, with the stamps of the new ones."""

    def begin(self, outlet: Outlet) -> Handler:
        """See :class:`faults.relay.Mode`."""
        frozen = read(outlet, outlet.last) if outlet.last else None

        def handle(message: bytes) -> None:
            nonlocal frozen
            now = read(outlet, message)
            frozen = frozen or now
            frozen.header = now.header
            outlet.emit(write(frozen))

        return handle


@dataclass(frozen=True)
class Change:
    """Every message is damaged by a function; ``first``: only so many, then it passes on."""

    damage: Damage
    first: int = 0

    def begin(self, outlet: Outlet) -> Handler:
        """See :class:`faults.relay.Mode`."""
        count = 0

        def handle(message: bytes) -> None:
            nonlocal count
            count += 1
            if self.first and count > self.first:
                outlet.emit(message)
                return
            damaged = self.damage(read(outlet, message))
            if damaged is not None:
                outlet.emit(write(damaged))

        return handle
