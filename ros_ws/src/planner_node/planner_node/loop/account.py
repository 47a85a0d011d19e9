# SPDX-License-Identifier: Apache-2.0
"""What an answer tells of the state it leaves: done, seen, held, where the arm is, and why."""

from __future__ import annotations

import math
from itertools import zip_longest
from typing import Final

from tamp_runtime.motion_report import SOMETHING, ArmPlace, MotionReport, MotionState

from scene_graph import Stacks, base_name, format_stacks, is_hidden

from .execution import STALE_SECONDS
from .plan import Plan
from .report import Outcome
from .scene import Scene, Sighting

_DOING: Final = {"pick": "picking", "place": "placing", "home": "going home"}


def describe_step(report: MotionReport) -> str:
    """What the arm is doing, such as "picking red_box, move 1 of 3"."""
    doing = f"{_DOING.get(report.phase, 'moving')} {report.object_name}".rstrip()
    what = report.message or doing
    if report.phase == "home" or not report.moves_total:
        return what
    return f"{what}, move {min(report.move + 1, report.moves_total)} of {report.moves_total}"


def describe_arm(report: MotionReport, silence: float | None = 0.0) -> str:
    """Where the arm is and what it holds, as a clause.

    Args:
        report: the newest of the motion node.
        silence: for how long it has said nothing [s]; None if it never has said anything.
    """
    if silence is None:
        return "nothing has been heard from the motion node, so where the arm is is not known"
    holds = {"": "its hand is empty", SOMETHING: "it holds something"}.get(
        report.held, f"it holds {report.held}"
    )
    x, y, z = report.hand
    point = f"({x:.2f}, {y:.2f}, {z:.2f}) m"
    if report.arm == ArmPlace.HOME:
        return f"the arm rests at home, {holds}"
    if report.arm == ArmPlace.RESTING:
        return f"the arm rests away from home with its hand at {point}, {holds}"
    if report.arm == ArmPlace.MOVING:
        return f"the arm still moves with its hand at {point}, {holds}"
    since = (
        f" (nothing heard from the motion node for {silence:.0f} s)"
        if silence > STALE_SECONDS
        else ""
    )
    held = f"; when last heard of, {holds}" if report.held else ""
    return f"where the arm is is not known, it may still move{since}{held}"


def in_the_view(report: MotionReport) -> str:
    """A clause for a refused picture, if the arm is not at home; otherwise an empty string."""
    if report.arm not in (ArmPlace.RESTING, ArmPlace.MOVING):
        return ""
    return f"the robot's own arm is in the view: {describe_arm(report)}"


def newly_seen(sighting: Sighting | None, known: Scene | None) -> str:
    """A clause about blocks in a picture that is refused which were not there before, or nothing.

    Args:
        known: the last scene that was not refused.
    """
    if sighting is None or known is None:
        return ""
    names = {item.name for item in sighting.graph.objects if not is_hidden(item.name)}
    new = sorted(names.difference(known.names, known.lying))
    return f"{', '.join(new)} {'seems' if len(new) == 1 else 'seem'} to be new" if new else ""


def describe_difference(plan: Plan, end: MotionReport, seen: Scene) -> str:
    """What the camera saw after a plan, if that is not what the plan predicted; else empty.

    A motion that ended early may have finished the move under way, or not.
    """
    done = min(end.moves_done, len(plan.moves))
    complete = end.state == MotionState.SUCCEEDED
    expected = [plan.states[-1]] if complete else list(plan.states[done : done + 2])
    if any(agree(seen.stacks, stacks) for stacks in expected):
        return ""
    told = (
        "the motion node reports every move carried out"
        if complete
        else f"the motion node reports {done} of {len(plan.moves)} moves carried out"
    )
    return (
        f"{told}, but the camera sees {format_stacks(seen.stacks)} where "
        f"{format_stacks(expected[0])} was predicted{_aside(seen.stacks, expected[0])}"
    )


def agree(seen: Stacks, expected: Stacks) -> bool:
    """Whether all is as expected; of what was hidden before nothing was."""
    return all(
        here == there or any(map(is_hidden, there))
        for here, there in zip_longest(seen, expected, fillvalue=())
    )


def besides(scene: Scene) -> list[str]:
    """A sentence about each block that stands beside the places."""
    places = [place for place in scene.graph.places if not place.aside]
    sentences = []
    for name in scene.aside:
        here = scene.graph.object(name).position_world[:2]
        away, base = min((math.dist(here, place.position_world[:2]), base_name(place.index))
                         for place in places)  # fmt: skip
        sentences.append(f"{name} stood {1000 * away:.0f} mm beside the centre of {base}")
    return sentences


def _aside(seen: Stacks, predicted: Stacks) -> str:
    """A hint where all stacks are seen, all as far aside; otherwise an empty string."""
    count = len(predicted)
    for by in range(1 - count, count):
        places = [place - by for place in range(count)]
        moved = tuple(predicted[place] if 0 <= place < count else () for place in places)
        if by and seen == moved and sum(map(len, moved)) == sum(map(len, predicted)):
            return "; all of it is seen aside, is the camera calibrated (extrinsics)?"
    return ""


def account_for(message: str, outcome: Outcome, newest: MotionReport, silence: float | None) -> str:
    """The message of an answer that is no success, with what its reader has to know beside it.

    What the message says already is not repeated.
    """
    clauses = []
    causes = list(dict.fromkeys(outcome.causes))
    for kind, cause in zip(("first cause", "last cause"), (causes[:1], causes[1:][-1:])):
        clauses += [f"{kind}: {text}" for text in cause if text not in message]
    if outcome.final is not None:
        seen = format_stacks(outcome.final.stacks)
        if seen not in message:
            clauses.append(f"seen last: {seen}")
    if outcome.moves_planned:
        moves = outcome.moves_executed
        clauses.append(f"{moves} {'move was' if moves == 1 else 'moves were'} carried out")
    arm = describe_arm(newest, silence)
    if arm not in message:
        clauses.append(arm)
    if not clauses:
        return message
    told = "; ".join(clauses)
    end = "" if message.endswith((".", "?", "!")) else "."
    return f"{message}{end} {told[0].upper()}{told[1:]}"
