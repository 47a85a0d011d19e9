# SPDX-License-Identifier: Apache-2.0
"""All kinds of faults; a new one is a line in one of these modules."""

from __future__ import annotations

from typing import Final

from faults.fault import Fault

from . import arm, camera, clients, messages, processes, world

CATALOGUE: Final[tuple[Fault, ...]] = (
    *camera.FAULTS,
    *arm.FAULTS,
    *messages.FAULTS,
    *processes.FAULTS,
    *clients.FAULTS,
    *world.FAULTS,
)


class UnknownFaultError(ValueError):
    """No fault has this name."""


def faults_named(part: str) -> tuple[Fault, ...]:
    """The fault of this name, or all in whose names it occurs; all for an empty string.

    Raises:
        UnknownFaultError: there is none; lists what there is.
    """
    exact = tuple(fault for fault in CATALOGUE if fault.name == part)
    found = exact or tuple(fault for fault in CATALOGUE if part in fault.name)
    if not found:
        names = ", ".join(fault.name for fault in CATALOGUE)
        raise UnknownFaultError(f"no fault is called {part!r}; there are {names}")
    return found
