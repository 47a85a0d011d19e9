# SPDX-License-Identifier: Apache-2.0
"""One trial: a small task, a fault in the middle of it, the answer, and a plain task afterwards."""

from __future__ import annotations

import time
from dataclasses import dataclass, field, replace
from typing import Any, Final

import numpy as np

from faults.askers import Answer, CommandAsker, ProgramAsker
from faults.fault import Ending, Fault, Phase
from faults.injections import PATIENCE, CrowdHungError
from faults.judge import arm_untruth, ending_of, untidy
from faults.setting import Setting
from faults.small_tasks import first_layout, some_moves_away
from tamp_bringup.processes import NODES, NodeDiedError
from tamp_bringup.scene_observer import SimulationError, true_stacks
from tamp_bringup.task import goal_text

#: After which an answer is overdue, and how long one to a cancel may take then [s].
ANSWER_SECONDS: Final = 60.0
CANCEL_SECONDS: Final = 10.0
#: Between a fault of PERCEIVE and the request: pictures may still be on their way [s].
_SETTLE: Final = 0.3
#: Until a restarted perception_node says something, on a busy machine [s].
GRAPH_SECONDS: Final = 40.0
#: A fault of EXECUTE begins up to this much after its pick or place [s].
_INTO_PHASE: Final = 0.4


@dataclass(frozen=True)
class TrialResult:
    """What one trial showed; the content of its file.

    Attributes:
        injected: whether the task came as far as the fault's phase.
        ending: one of :class:`faults.fault.Ending`.
        untrue: what the answer says of the arm and is not so; empty if all is.
        stuck: why a plain task failed afterwards though the scene was tidy, or that the arm was
            not home; empty if neither.
        poisoned: why a plain task failed even after ``sim/reset``; empty if it succeeded.
        seconds: from the fault's begin to the answer, wall time.
        logs: the last lines of the nodes' logs, where the ending is bad.
    """

    fault: str
    phase: str
    trial: int
    seed: int
    goal: str
    injected: bool = False
    ending: str = ""
    status: str = ""
    message: str = ""
    causes: tuple[str, ...] = ()
    replans: int = 0
    untrue: str = ""
    stuck: str = ""
    poisoned: str = ""
    seconds: float = 0.0
    trial_seconds: float = 0.0
    logs: dict[str, list[str]] = field(default_factory=dict)


@dataclass
class _Course:
    """How far a trial is."""

    begun: float | None = None
    ended: bool = False


def run_trial(setting: Setting, fault: Fault, phase: Phase, trial: int, seed: int) -> TrialResult:
    """Runs one trial; the graph is whole again afterwards unless ``poisoned`` says otherwise.

    Raises:
        SimulationError: the trial could not even begin.
    """
    started = time.monotonic()
    initial = first_layout(seed)
    setting.processes.check()
    setting.remember_layout(initial)
    setting.eyes.reset(initial)
    if setting.eyes.arm_is_home() is False:
        setting.eyes.remember_home()
    setting.eyes.forget_motion()
    goal = some_moves_away(initial, 2, seed)
    setting.goal, setting.initial, setting.phase, setting.seed = (
        goal_text(goal), initial, phase, seed
    )  # fmt: skip
    result = TrialResult(fault.name, phase.value, trial, seed, setting.goal)
    try:
        result = _under_fault(setting, fault, result)
    finally:
        asker, setting.asker = setting.asker, None
        if asker is not None:
            asker.close()
    result = _afterwards(setting, result)
    return replace(result, trial_seconds=round(time.monotonic() - started, 2))


def _under_fault(setting: Setting, fault: Fault, result: TrialResult) -> TrialResult:
    course = _Course()
    died = ""
    answer: Answer | None = None
    injection = fault.injection
    if setting.phase is Phase.PERCEIVE and not injection.needs_goal:
        _begin(setting, fault, course)
        time.sleep(_SETTLE)
    setting.asker = (
        CommandAsker(setting.folder / "command.log")
        if fault.asker == "command"
        else ProgramAsker(setting.planner)
    )
    setting.asker.start(setting.goal)
    try:
        answer = _wait(setting, fault, course)
        asked = time.monotonic()
        while answer is None and time.monotonic() < asked + CANCEL_SECONDS:
            setting.asker.cancel()
            time.sleep(0.1)
            answer = setting.asker.answer()
    except NodeDiedError as error:
        died = str(error)
    seconds = time.monotonic() - (course.begun or time.monotonic())
    truth = setting.eyes.truth()
    moves = setting.eyes.arm_moves()
    pictured = setting.eyes.truth_at(answer.seen) if answer else None
    hung = ""
    if course.begun is not None and not course.ended:
        try:
            injection.end(setting)
        except CrowdHungError as error:
            hung = str(error)
    ending, message = ending_of(fault, setting.goal, answer, truth, pictured)
    if hung:
        ending, message = Ending.HUNG, hung
    if died:
        ending, message = Ending.NODE_DIED, died
    return replace(
        result,
        injected=course.begun is not None,
        ending=ending.value,
        status=answer.status if answer else "",
        message=message,
        causes=answer.causes if answer else (),
        replans=answer.replans if answer else 0,
        untrue=arm_untruth(answer, truth, moves) if answer else "",
        seconds=round(seconds, 2),
    )


def _wait(setting: Setting, fault: Fault, course: _Course) -> Answer | None:
    """Waits for the answer, lets the fault begin and end meanwhile; None: there is none."""
    rng = np.random.default_rng([setting.seed, 3])
    kind, into = ("pick", "place")[setting.seed % 2], float(rng.uniform(0.0, _INTO_PHASE))
    reached: float | None = None
    since = time.monotonic()
    while True:
        assert setting.asker is not None
        answer = setting.asker.answer()
        now = time.monotonic()
        if answer is not None:
            return answer
        if reached is None and setting.eyes.phase_reached(setting.phase, kind):
            reached = now
        waits = into if setting.phase is Phase.EXECUTE else 0.0
        if course.begun is None and reached is not None and now >= reached + waits:
            _begin(setting, fault, course)
            since = time.monotonic()
        if _is_over(fault, course, now):
            fault.injection.end(setting)
            course.ended = True
            since = time.monotonic()
        if now > since + ANSWER_SECONDS:
            return None
        setting.processes.check()
        time.sleep(0.02)


def _is_over(fault: Fault, course: _Course, now: float) -> bool:
    """Whether a fault that passes has to end now."""
    if course.begun is None or fault.seconds is None or course.ended:
        return False
    return now >= course.begun + fault.seconds


def _begin(setting: Setting, fault: Fault, course: _Course) -> None:
    fault.injection.begin(setting)
    course.begun = time.monotonic()


# Afterwards


def _afterwards(setting: Setting, result: TrialResult) -> TrialResult:
    """A plain task must succeed: in the scene as it is if that is tidy, else after a reset."""
    # What was killed has been started again; a person would wait until it is there, too.
    setting.wait_for_nodes(*NODES)
    setting.eyes.wait_for_graph(GRAPH_SECONDS)
    try:
        failure, tidy = _plain_task(setting, result.seed)
        if not failure:
            return result
        stuck = failure if tidy else ""
        if not tidy and not setting.eyes.wait_for(setting.eyes.arm_is_home, 5.0):
            stuck = f"the arm is not home; {failure}"
        setting.eyes.reset(first_layout(result.seed + 1))
        poisoned, _ = _plain_task(setting, result.seed)
    except SimulationError as error:
        stuck, poisoned = "", str(error)
    except NodeDiedError as error:
        stuck, poisoned = "", str(error)
    return replace(result, stuck=stuck, poisoned=poisoned)


def _plain_task(setting: Setting, seed: int) -> tuple[str, bool]:
    """Why one move could not be done, empty if it was; and whether the scene was tidy before.

    It is asked for again while the planner is busy with what is left of the trial, or starts.
    """
    truth = setting.eyes.fresh_truth(timeout=30.0)
    stacks = true_stacks(truth)
    if stacks is None:
        # A block may just be on its way down.
        time.sleep(1.0)
        truth = setting.eyes.fresh_truth()
        stacks = true_stacks(truth)
    if not stacks:
        return "a block stands on nothing", False
    if messy := untidy(truth):
        return messy, False
    goal = some_moves_away(stacks, 1, seed)
    asker = ProgramAsker(setting.planner, PATIENCE)
    deadline = time.monotonic() + PATIENCE + ANSWER_SECONDS
    try:
        asker.start(goal_text(goal))
        while (answer := asker.answer()) is None and time.monotonic() < deadline:
            setting.processes.check()
            time.sleep(0.05)
    finally:
        asker.close()
    if answer is None:
        return "no answer to a plain task", True
    if not answer.claimed:
        return f"{answer.status}: {answer.sentence}", True
    after = true_stacks(setting.eyes.fresh_truth())
    return ("" if after == goal else f"{answer.status}, but the truth is {after}"), True


def last_lines(setting: Setting, count: int = 12) -> dict[str, list[str]]:
    """The ends of the nodes' logs."""
    lines: dict[str, list[str]] = {}
    for log in sorted((setting.folder / "logs").glob("*.log")):
        lines[log.stem] = log.read_text(errors="replace").splitlines()[-count:]
    return lines


def to_json(result: TrialResult) -> dict[str, Any]:
    """The content of the trial's file."""
    return {**vars(result), "causes": list(result.causes)}
