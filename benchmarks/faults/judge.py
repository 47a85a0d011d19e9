# SPDX-License-Identifier: Apache-2.0
"""Judges answers by the ground truth and by what they say of the cause."""

from __future__ import annotations

from typing import Final

import numpy as np

from faults.askers import Answer
from faults.fault import Ending, Fault, names_the_cause
from planner_node.goals import parse_goal, resolve_goal
from scene_graph import UP, SceneGraph, base_name
from sim_node.ground_truth import standing_blocks

#: How far a block may be beside the middle of its place, and of the block beneath, so that nobody
#: would call the scene untidy [m].
_BESIDE_PLACE: Final = 0.035
_BESIDE_BLOCK: Final = 0.015


def ending_of(
    fault: Fault,
    goal: str,
    answer: Answer | None,
    now: SceneGraph | None,
    pictured: SceneGraph | None,
) -> tuple[Ending, str]:
    """What became of a task, and the sentence that the one who asked got.

    Args:
        now: the ground truth when the answer came.
        pictured: that of the picture which the answer rests on: a world that changes between the
            picture and the answer makes no claim wrong.
    """
    if answer is None:
        return Ending.HUNG, "no answer, and none to a cancel"
    if answer.claimed:
        true = holds(goal, now) or holds(goal, pictured)
        return (Ending.REACHED if true else Ending.FALSE_SUCCESS), answer.message
    typed = answer.status != "INTERNAL_ERROR" and (
        not fault.statuses or answer.status in fault.statuses
    )
    if typed and names_the_cause(answer.sentence, fault.words):
        return Ending.REFUSED, answer.message
    return Ending.WRONG_SENTENCE, answer.message


def holds(goal: str, truth: SceneGraph | None) -> bool:
    """Whether the true state fulfils a goal; one that lacks its blocks does not.

    A block that stands nowhere, as one that fell beside the places, counts if the goal is of it.
    """
    if truth is None:
        return False
    stacks, _ = standing_blocks(truth)
    try:
        names = [name for stack in stacks for name in stack]
        return resolve_goal(parse_goal(goal), names).holds(stacks)
    except Exception:  # a goal about blocks that are gone, or stand nowhere
        return False


def arm_untruth(answer: Answer, truth: SceneGraph | None, moves: bool) -> str:
    """What an answer says of the arm and is not so; empty if all is.

    Args:
        moves: whether the arm was seen to move just after the answer.
    """
    if answer.arm in ("home", "resting") and moves:
        return f"the answer says that the arm is {answer.arm}, and it moves"
    if answer.held and truth is not None:
        for relation in truth.relations:
            if relation.subject == answer.held and relation.predicate == "up":
                return f"the answer says that {answer.held} is held; it is on {relation.object}"
    return ""


def untidy(truth: SceneGraph) -> str:
    """The block that stands beside what it stands on, in words; empty if each is where it should.

    By the truth, a block is on a place as long as no other place is nearer.
    """
    places = {base_name(place.index): place.position_world for place in truth.places}
    blocks = {item.name: item.position_world for item in truth.objects}
    for relation in sorted(truth.relations):
        if relation.predicate != UP:
            continue
        on_place = relation.object in places
        below = places[relation.object] if on_place else blocks[relation.object]
        offset = float(np.hypot(*np.subtract(blocks[relation.subject], below)[:2]))
        if offset > (_BESIDE_PLACE if on_place else _BESIDE_BLOCK):
            return f"{relation.subject} stands {1000 * offset:.0f} mm beside {relation.object}"
    return ""
