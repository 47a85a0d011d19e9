# SPDX-License-Identifier: Apache-2.0
"""A task of five blocks, disturbed at a random moment of its execution, or by nobody."""

from __future__ import annotations

import time
from dataclasses import dataclass, replace
from typing import Any, Final

import numpy as np
from tamp_interfaces.srv import Disturb
from tamp_runtime.motion_report import MotionReport, MotionState
from tasks.draw import Task, draw_task
from tasks.family import family_of

from faults.askers import Answer, ProgramAsker
from faults.catalogue import faults_named
from faults.disturbances import Disturbed
from faults.fault import Ending, Fault
from faults.judge import ending_of, holds
from faults.noticing import (
    carried_between,
    grasps_after,
    grasps_lost,
    noticed_at,
    noticed_in_time,
)
from faults.setting import Setting
from scene_graph import SceneGraph, Stacks, format_stacks
from sim_node.cli.client import DisturbClient
from sim_node.ground_truth import standing_blocks

BLOCKS: Final = 5
#: The kinds, by the names of the fault campaign's.
KINDS: Final = {
    "push": "world-block-pushed",
    "swap": "world-blocks-exchanged",
    "take_away": "world-block-taken-away",
    "add": "world-block-added",
    "slip": "world-block-slips",
    "jam": "world-gripper-jams-4s",
    "sheet": "world-sheet-before-camera-4s",
}
NOTHING: Final = "nothing"
#: Those of which a camera sees what they do to the blocks, whatever the arm does.
SEEN: Final = ("push", "swap", "take_away", "add")
#: Share of the planned trajectory at which it happens.
_SHARES: Final = (0.02, 0.95)
#: A block that was moved by less by the disturbance is where it was [m].
_MOVED: Final = 0.015
#: Until a pushed block has come to rest, in simulated time [ns].
_REST: Final = 1_000_000_000
#: Of a simulator that says that this block is in the hand, another is asked for after [s].
_AGAIN: Final = 0.1
#: An answer is overdue after, and one to a cancel then [s].
ANSWER_SECONDS: Final = 240.0
CANCEL_SECONDS: Final = 30.0
#: Until a perception_node that has just started says something, on a busy machine [s].
GRAPH_SECONDS: Final = 60.0


def fault_of(kind: str) -> Fault:
    """The fault of a kind, or one of which nothing is said."""
    return faults_named(KINDS[kind])[0]


@dataclass(frozen=True)
class Disturbance:
    """What happened.

    Attributes:
        stamp: when, in simulated time [ns].
        blocks: that it was about.
        step: what the arm did, such as "pick 3 of 8".
        effect: whether blocks that are not in the hand stand elsewhere because of it, or are gone.
    """

    stamp: int
    blocks: tuple[str, ...]
    step: str
    effect: bool = False


@dataclass(frozen=True)
class MomentResult:
    """What one task showed; the content of its file.

    Attributes:
        kind: of what happened, :data:`NOTHING` in a task that nobody disturbs.
        verify: the planner's parameter.
        happened: whether it did before the answer came.
        effect: see :class:`Disturbance`.
        ending: one of :class:`faults.fault.Ending`.
        named: whether a refusal names one of the blocks that it was about; True where none is.
        in_time: whether it was noticed before a block was taken in a grasp that began after it;
            None where neither came.
        in_time_of_any: the same, with the grasp whose fingers were closing when it happened.
        latency: from the moment until it was noticed, in simulated time [s].
        until_grasp: from the moment until the next grasp, if there was one, likewise.
        grasps_lost, replans, stops: over the task.
        simulated_seconds: from the request to the answer.
        truth: how the blocks stood when the answer came, and where those lay that stood nowhere.
    """

    kind: str
    verify: str
    trial: int
    seed: int
    goal: str
    happened: bool = False
    effect: bool = False
    step: str = ""
    blocks: tuple[str, ...] = ()
    ending: str = ""
    named: bool = True
    status: str = ""
    message: str = ""
    causes: tuple[str, ...] = ()
    in_time: bool | None = None
    in_time_of_any: bool | None = None
    latency: float | None = None
    until_grasp: float | None = None
    grasps_lost: int = 0
    replans: int = 0
    stops: int = 0
    simulated_seconds: float = 0.0
    wall_seconds: float = 0.0
    truth: str = ""


def run_at_random_moment(
    setting: Setting, kind: str, verify: str, trial: int, seed: int
) -> MomentResult:
    """Runs one task.

    Raises:
        SimulationError: it could not even begin.
        NodeDiedError: a node ended by itself.
    """
    task, eyes = draw_task(family_of(BLOCKS), seed), setting.eyes
    setting.processes.check()
    eyes.reset(task.layout)
    eyes.wait_for_graph(GRAPH_SECONDS)
    eyes.set_parameter("planner_node", "verify", verify)
    eyes.forget_motion()
    setting.goal, setting.initial, setting.seed = task.goal, task.layout, seed
    result = MomentResult(kind, verify, trial, seed, task.goal)
    started, begun = time.monotonic(), eyes.fresh_truth_stamp()
    asker = setting.asker = ProgramAsker(setting.planner)
    asker.start(task.goal)
    # Made before, so that what is asked for happens at once.
    with DisturbClient() as simulator:
        try:
            answer, disturbance = _wait(setting, kind, asker, simulator)
        finally:
            setting.asker = None
            asker.close()
            if kind != NOTHING:
                simulator.disturb(Disturb.Request(kind=Disturb.Request.CALM), timeout=30.0)
    result = replace(
        result,
        simulated_seconds=round((eyes.truth_stamp() - begun) / 1e9, 2),
        wall_seconds=round(time.monotonic() - started, 2),
    )
    return _judged(setting, result, task, answer, disturbance)


def _wait(
    setting: Setting, kind: str, asker: ProgramAsker, simulator: DisturbClient
) -> tuple[Answer | None, Disturbance | None]:
    """Waits for the answer; lets it happen at its moment."""
    rng = np.random.default_rng([setting.seed, 21])
    share, moment = float(rng.uniform(*_SHARES)), None
    disturbance: Disturbance | None = None
    deadline, attempts, again = time.monotonic() + ANSWER_SECONDS, 0, 0.0
    while (answer := asker.answer()) is None:
        now = time.monotonic()
        if now > deadline:
            asker.cancel()
            if now > deadline + CANCEL_SECONDS:
                return None, disturbance
        setting.processes.check()
        if moment is None and (first := _setting_out(setting.eyes.reports())) is not None:
            moment = first.stamp + int(share * first.duration * 1e9)
        due = moment is not None and setting.eyes.joints_stamp() >= moment
        if kind != NOTHING and disturbance is None and due and now >= again:
            disturbance = _disturb(setting, kind, attempts, simulator)
            attempts, again = attempts + 1, time.monotonic() + _AGAIN
        time.sleep(0.01)
    return answer, disturbance


def _setting_out(reports: list[MotionReport]) -> MotionReport | None:
    """The first report on a motion under way, which says how long it takes."""
    return next((item for item in reports
                 if item.state is MotionState.EXECUTING and item.duration > 0.0), None)  # fmt: skip


def _disturb(
    setting: Setting, kind: str, attempt: int, simulator: DisturbClient
) -> Disturbance | None:
    """Lets it happen now; None if the simulator refuses, such as of a block in the hand."""
    eyes, injection = setting.eyes, fault_of(kind).injection
    assert isinstance(injection, Disturbed)
    reports = eyes.reports()
    last = reports[-1] if reports else MotionReport()
    before = eyes.truth()
    if before is None:
        return None
    stacks = _standing(before, last.held, setting.initial)
    request = injection.request(stacks, 1000 * setting.seed + attempt)
    answer = simulator.disturb(request, timeout=30.0)
    if not answer.success:
        return None
    # Ground truth comes as seldom as pictures: by its time it happened up to one of them before.
    stamp = eyes.joints_stamp()
    step = f"{last.phase or 'begin'} {min(last.move + 1, last.moves_total)} of {last.moves_total}"
    happened = Disturbance(stamp, tuple(request.blocks), step)
    if kind not in SEEN:
        return happened
    eyes.wait_for(lambda: eyes.truth_stamp() > stamp + _REST, 30.0)
    after = eyes.truth_at_or_before(stamp + _REST)
    carried = carried_between(eyes.reports(), stamp - _REST // 2, stamp + _REST)
    told = tuple(name for name in request.blocks if name not in carried)
    return replace(happened, effect=_differs(before, after, told))


def _standing(truth: SceneGraph, held: str, initial: Stacks) -> Stacks:
    """The stacks without what is in the hand."""
    try:
        stacks = truth.stacks()
    except Exception:  # a block is in the air: what stands on what is asked of the layout
        stacks = initial
    return tuple(tuple(name for name in stack if name != held) for stack in stacks)


def _differs(before: SceneGraph, after: SceneGraph | None, blocks: tuple[str, ...]) -> bool:
    """Whether these blocks are elsewhere, gone or new."""
    if after is None:
        return True
    for name in blocks:
        if (name in before.names) != (name in after.names):
            return True
        here, there = (graph.object(name).position_world for graph in (before, after))
        if float(np.linalg.norm(np.subtract(here, there))) > _MOVED:
            return True
    return False


def _described(truth: SceneGraph) -> str:
    stacks, lying = standing_blocks(truth)
    spots = {name: truth.object(name).position_world for name in lying}
    told = [f"{name} at ({x:.2f}, {y:.2f}, {z:.2f}) m" for name, (x, y, z) in spots.items()]
    return "; ".join([format_stacks(stacks), *told])


def _judged(
    setting: Setting,
    result: MomentResult,
    task: Task,
    answer: Answer | None,
    disturbance: Disturbance | None,
) -> MomentResult:
    eyes = setting.eyes
    truth, pictured = eyes.truth(), eyes.truth_at(answer.seen) if answer else None
    if result.kind == NOTHING:
        reached = answer is not None and answer.claimed and holds(task.goal, truth)
        claimed = answer is not None and answer.claimed
        ending = Ending.REACHED if reached else Ending.REFUSED
        ending = Ending.FALSE_SUCCESS if claimed and not reached else ending
    else:
        ending, _ = ending_of(fault_of(result.kind), task.goal, answer, truth, pictured)
    reports, stops = eyes.reports(), eyes.stops()
    result = replace(
        result,
        ending=(Ending.HUNG if answer is None else ending).value,
        status=answer.status if answer else "",
        message=answer.message if answer else "no answer",
        causes=answer.causes if answer else (),
        replans=answer.replans if answer else 0,
        grasps_lost=grasps_lost(reports),
        stops=len(stops),
        truth=_described(truth) if truth else "",
    )
    if disturbance is None:
        return result
    passed = 1 if result.kind in ("slip", "jam") else 0  # they spoil a grasp themselves
    at = noticed_at(reports, stops, disturbance.stamp)
    later = grasps_after(reports, disturbance.stamp, passed)
    refused = result.ending in (Ending.REFUSED.value, Ending.WRONG_SENTENCE.value)
    sentence = answer.sentence if answer else ""
    named = not refused or not disturbance.blocks or any(
        name in sentence or f"the {name.split('_')[0]} block" in sentence
        for name in disturbance.blocks
    )  # fmt: skip
    return replace(
        result,
        happened=True,
        effect=disturbance.effect,
        step=disturbance.step,
        blocks=disturbance.blocks,
        named=named,
        in_time=noticed_in_time(reports, stops, disturbance.stamp, passed),
        in_time_of_any=noticed_in_time(reports, stops, disturbance.stamp, passed, under_way=True),
        latency=None if at is None else round((at - disturbance.stamp) / 1e9, 2),
        until_grasp=round((later[0] - disturbance.stamp) / 1e9, 2) if later else None,
    )


def to_json(result: MomentResult) -> dict[str, Any]:
    """The content of a task's file."""
    return {**vars(result), "causes": list(result.causes), "blocks": list(result.blocks)}
