# SPDX-License-Identifier: Apache-2.0
"""All kinds of faults; a new one is a line in one of these modules."""

from __future__ import annotations

from typing import Final

from faults.fault import Fault

from . import arm, camera, clients, disturbances, messages, processes, world

CATALOGUE: Final[tuple[Fault, ...]] = (
    *camera.FAULTS,
    *arm.FAULTS,
    *messages.FAULTS,
    *processes.FAULTS,
    *clients.FAULTS,
    *world.FAULTS,
    *disturbances.FAULTS,
)


class UnknownFaultError(ValueError):
    """No fault has this name."""


def faults_named(names: str) -> tuple[Fault, ...]:
    """The faults of these names, separated by commas; a part of a name stands for all that hold it.

    Returns:
        All for an empty string; in the catalogue's order.

    Raises:
        UnknownFaultError: there is none; lists what there is.
    """
    found: set[str] = set()
    for part in names.split(","):
        exact = {fault.name for fault in CATALOGUE if fault.name == part}
        alike = exact or {fault.name for fault in CATALOGUE if part in fault.name}
        if not alike:
            known = ", ".join(fault.name for fault in CATALOGUE)
            raise UnknownFaultError(f"no fault is called {part!r}; there are {known}")
        found |= alike
    return tuple(fault for fault in CATALOGUE if fault.name in found)
