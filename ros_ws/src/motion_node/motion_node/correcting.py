# SPDX-License-Identifier: Apache-2.0
"""A motion under way, corrected for a scene that has changed a little, without a stop (3.4).

The k-order problems of the phases that are left are solved once more, from the arm's state in the
future at which the correction is to begin, warm started from the solution that is being carried
out. The new trajectory sets out with the position and the velocity of the old one there.
"""

from __future__ import annotations

import time
from collections.abc import Sequence
from dataclasses import replace
from typing import Final

import numpy as np
from numpy.typing import NDArray

from scene_graph import Move, SceneGraph

from .blocks import read_scene
from .constraints import Clearances
from .dense_check import check as dense_check
from .errors import KEYFRAMES, PATH, InfeasibleError
from .expand import Choice, expand
from .motion import Motion
from .nlp import TOLERANCE
from .phases import HOME, PLACE, Phase
from .planner import MotionPlanner
from .refining import objection
from .timing.time_paths import time_paths

Array = NDArray[np.float64]

#: Between its steps, where a correction may begin, a way may be so much nearer to stacks [m].
_NEARER: Final = 0.004


def corrected(
    planner: MotionPlanner,
    motion: Motion,
    at: float,
    graph: SceneGraph,
    moves: Sequence[Move],
    to_next_switch: bool = False,
    choices: Sequence[Choice] = (),
) -> Motion:
    """The rest of a motion for a scene in which blocks or places stand a little elsewhere.

    Args:
        motion: what is being carried out; it may have been corrected before.
        at: the time of its trajectory from which on the correction counts [s].
        graph: the scene before the first of the moves, with what has not been moved yet where it
            is now.
        moves: those of the motion.
        to_next_switch: only as far as the next block is taken or put down.
        choices: how the blocks are taken and put down, one a move; none: as in the motion.

    Returns:
        A motion whose trajectory begins at ``at`` with the arm's position and velocity there.

    Raises:
        InfeasibleError: where the fingers are moving, or no correction without a stop was found.
    """
    begin = time.perf_counter()
    scene, settings = read_scene(graph), planner.settings
    interval = motion.trajectory.interval_at(at)
    index = next(i for i, phase in enumerate(motion.phases) if phase is interval.phase)
    if interval.gripping:
        raise _error(interval.phase, "time before the fingers move")
    gripper, own = planner.arm.gripper, settings.phases
    choices = choices or choices_of(motion)
    phases = expand(scene, moves, gripper, own, settings.squeeze, choices=choices)
    done = len(phases) - len(motion.phases)  # before it was corrected the last time
    stop = index + 1 if to_next_switch else len(motion.phases)
    left = [_from_here(phases[done + index]), *phases[done + index + 1 : done + stop]]
    positions, rates = motion.trajectory.sample(at)
    clear = Clearances(settings.path.margin, motion.floor)
    keyframes, problem = planner.prepare(len(scene.stacks))
    before = [path.q for path in motion.paths[index:stop]]
    moments = np.linspace(at, interval.end, len(before[0]))
    before[0] = motion.trajectory.sample(moments)[0].arm
    # P2, from the switches as they were.
    switching = [phase for phase in left if phase.kind != HOME]
    ends = [q[-1] for q, phase in zip(before, left) if phase.kind != HOME]
    if switching:
        demands = keyframes.problems.demands(switching, clear)
        near = _nearest(planner, switching, np.array(ends))
        if keyframes.problems.excess(near, demands).max() == 0.0 and _there(
            planner, switching, near
        ):
            ends = list(near)
        else:
            solution = keyframes.problems.solve(positions.arm, ends, demands)
            if not solution.feasible:
                raise keyframes.problems.error(KEYFRAMES, solution, switching)
            ends = list(solution.x[1:-1])
    configurations = [positions.arm, *ends, planner.model.home]
    # P3, from the ways as they were.
    paths = []
    for phase, old, first, last in zip(left, before, configurations, configurations[1:]):
        share = np.linspace(0.0, 1.0, len(old))[:, None]
        share = share**2 * (3 - 2 * share)
        guess = old + (1 - share) * (first - old[0]) + share * (last - old[-1])
        moving = phase is left[0] and bool(np.any(rates.arm))
        own_clear = replace(clear, margin=clear.margin - _NEARER) if moving else clear
        paths += problem.solve(
            [phase], [first, last], own_clear, [guess], old[1] if moving else None
        )
    try:
        trajectory = time_paths(
            *(paths, planner.limits, planner.timing, positions.fingers), moving=rates.arm
        )
    except ValueError as error:
        raise _error(interval.phase, str(error)) from error
    found = Motion(tuple(left), tuple(paths), trajectory, motion.floor, time.perf_counter() - begin)
    if planner.obstacles:
        contacts = dense_check(
            *(planner.model, trajectory, None, planner.obstacles), floor=motion.floor
        ).contacts
        if contacts:
            raise objection(contacts[0])
    return found


def _nearest(planner: MotionPlanner, phases: Sequence[Phase], q: Array) -> Array:
    """Configurations (k, n) with the hand at the phases' switches, the elbow where it was."""
    yaws = [planner.model.hand_at(own)[1] for own in q]
    turned = [
        phase.switch.yaw + np.pi * np.round((yaw - phase.switch.yaw) / np.pi)
        for phase, yaw in zip(phases, yaws)
        if phase.switch
    ]
    return planner.inverse.solve(_points(phases), np.array(turned), q)


def _there(planner: MotionPlanner, phases: Sequence[Phase], q: Array) -> bool:
    return bool(np.abs(planner.inverse.residual(q, _points(phases))).max() < TOLERANCE)


def _points(phases: Sequence[Phase]) -> Array:
    return np.array([phase.switch.position_world for phase in phases if phase.switch])


def _from_here(phase: Phase) -> Phase:
    """The phase, begun anywhere on its way."""
    return replace(phase, start=None)


def choices_of(motion: Motion) -> list[Choice]:
    """How the blocks of a motion are taken and put down."""
    found = []
    for phase in motion.phases:
        if phase.kind == PLACE:
            assert phase.switch is not None
            found.append(Choice(phase.choice, abs(np.sin(phase.switch.yaw)) > 0.5))
    return found


def _error(phase: Phase, constraint: str) -> InfeasibleError:
    return InfeasibleError(
        PATH, constraint, object_name=phase.object_name, move=phase.move, phase=phase.kind
    )
