# SPDX-License-Identifier: Apache-2.0
"""What the independent check objects to is solved again with more room, or refused: never sent."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import replace
from typing import Final

from .constraints import Clearances
from .dense_check import Checked, Contact
from .errors import PATH, SCENE, InfeasibleError
from .phases import Phase, PhasePath
from .timing.trajectory import Trajectory

#: A gap that is less is refined between the steps of a path, too [m].
FREE: Final = 0.003
#: So often ways are solved again.
ROUNDS: Final = 6
#: More room than what was missing, so that the next look finds none missing [m].
SPARE: Final = 0.01


def refined(
    paths: list[PhasePath],
    clear: Clearances,
    solve: Callable[[int, Clearances], PhasePath],
    time: Callable[[Sequence[PhasePath]], Trajectory],
    check: Callable[[Trajectory], Checked],
    obstacles: frozenset[str],
) -> tuple[list[PhasePath], Trajectory]:
    """Paths and a trajectory to which the check has no objection.

    Args:
        paths: one a phase.
        clear: distances that they keep at their steps.
        solve: a phase again, with other distances; raises InfeasibleError.
        time: the trajectory of paths.
        check: looks at it all along.
        obstacles: names of what is no block.

    Raises:
        InfeasibleError: with bound ``path``, where more room does not help.
    """
    own = [clear] * len(paths)
    for _ in range(ROUNDS):
        trajectory = time(paths)
        checked = check(trajectory)
        if not checked.contacts:
            return paths, trajectory
        for contact in checked.contacts:
            index = next(i for i, path in enumerate(paths) if path.phase is contact.phase)
            more = max(0.0, -contact.gap) / 2 + SPARE
            if contact.other in obstacles:
                own[index] = replace(own[index], extra=own[index].extra + more)
            else:
                own[index] = replace(own[index], margin=own[index].margin + more)
            try:
                paths[index] = solve(index, own[index])
            except InfeasibleError as error:
                raise objection(contact) from error
    raise objection(checked.contacts[0])


def objection(contact: Contact) -> InfeasibleError:
    """What the check found, as the verdict of a bound."""
    phase: Phase = contact.phase
    return InfeasibleError(
        PATH,
        f"clearance of {contact.body} to {contact.other} between the path's steps",
        object_name=phase.object_name,
        violation=max(0.0, -contact.gap),
        move=phase.move,
        phase=phase.kind,
        excludes=SCENE,
    )
