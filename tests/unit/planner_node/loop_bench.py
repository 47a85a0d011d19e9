# SPDX-License-Identifier: Apache-2.0
"""The closed loop between a perception and a motion node made of values; no time passes."""

from __future__ import annotations

import threading
from collections.abc import Callable, Iterator, Sequence
from dataclasses import replace
from typing import Any

from tamp_runtime.motion_report import ArmPlace, MotionReason, MotionReport, MotionState

from planner_node.goals import ResolveGoal, parse_goal, resolve_goal
from planner_node.loop import (
    Clock,
    ClosedLoop,
    MotionLink,
    Outcome,
    Plan,
    Progress,
    SceneWatch,
    Sighting,
    Stage,
)
from planner_node.loop.plan_watch import PlanSight
from planner_node.settings import Settings
from scene_graph import (
    HIDDEN,
    ONE_ROW,
    GraphStatus,
    Move,
    Place,
    SceneGraph,
    SceneObject,
    Stacks,
    apply_move,
    is_hidden,
    split_object_name,
    up_relations,
)

START: Stacks = (("red_box", "blue_box"), ("green_box",), ())
GOAL = "red on green, blue on red"
REACHED: Stacks = ((), ("green_box", "red_box", "blue_box"), ())


class FakeClock(Clock):
    """Time passes only where somebody waits; then ``on_wait`` is called."""

    def __init__(self) -> None:
        self.seconds = 1000.0
        self.on_wait: Callable[[], None] = lambda: None

    def now(self) -> float:
        return self.seconds

    def wait(self, changed: threading.Condition, seconds: float) -> None:
        del changed
        self.seconds += seconds
        self.on_wait()

    def ros_now(self) -> int:
        return round(self.seconds * 1e9)


def sighting_of(stacks: Stacks, stamp: int = 0, **fields: Any) -> Sighting:
    """What perception reports of a state; ``fields`` are those of Sighting."""
    names = sorted(name for stack in stacks for name in stack)
    graph = SceneGraph(
        tuple(
            SceneObject(name, HIDDEN, "box")
            if is_hidden(name)
            else SceneObject(name, *split_object_name(name))
            for name in names
        ),
        up_relations(stacks),
        tuple(Place(index, (0.0, 0.1 * index, 0.0)) for index in range(len(stacks))),
        confidence=fields.pop("confidence", 0.9),
    )
    return Sighting(**{"graph": graph, "stamp": stamp, "frame_id": "world", **fields})


def in_doubt(sighting: Sighting, **alternatives: str) -> Sighting:
    """With other colours that blocks may have: ``red_box="orange brown"``."""
    if not alternatives:
        return sighting
    objects = tuple(
        replace(item, alternatives=tuple(alternatives.get(item.name, "").split()))
        for item in sighting.graph.objects
    )
    graph = replace(sighting.graph, objects=objects)
    return replace(sighting, graph=graph, status=GraphStatus.DOUBTFUL)


#: What a motion node does with a plan; what it yields it reports, one at a time.
Behaviour = Callable[["LoopBench", Plan], Iterator[MotionReport]]


#: What it does when it is asked for the way home.
Way = Callable[["LoopBench"], Iterator[MotionReport]]

BEAT_SECONDS = 1.0


class LoopBench:
    """A world, those who look at it and move in it, and the loop between them.

    Attributes:
        fault: fields of the sightings when something is wrong.
        alternatives: other colours that blocks may have, as far as anybody can see.
        silent: perception reports nothing.
        mute: the motion node says nothing, not even that it lives.
        deaf: it hears nothing.
        arm, held, hand: what it says of the arm while it does nothing.
        tells_arm: whether it does; older ones do not.
        homes: how it goes home, one way after the other; then all goes well.
        told: all progress so far.
        cancel_at: the goal is cancelled as soon as this is true of a progress.
        conflict: what the loop is told of two nodes that do the work of one.
        stops: the names of the plans that were to be stopped.
    """

    def __init__(self, *behaviours: Behaviour, **settings: Any) -> None:
        self.stacks: Stacks = START
        self.fault: dict[str, Any] = {}
        self.alternatives: dict[str, str] = {}
        self.silent = False
        self.mute = False
        self.deaf = False
        self.arm = ArmPlace.HOME
        self.held = ""
        self.hand = (0.0, 0.0, 0.0)
        self.tells_arm = True
        self.homes: list[Way] = []
        self.plans: list[Plan] = []
        self.stops: list[str] = []
        self.sights: list[tuple[str, PlanSight]] = []
        self.audience = 1
        self.told: list[Progress] = []
        self.cancel_at: Callable[[Progress], bool] = lambda _: False
        self.cancelled = False
        self.shut_down = False
        self.conflict = ""
        self.clock = FakeClock()
        self.clock.on_wait = self.live_on
        self.settings = Settings(**settings)
        self.scenes = SceneWatch(self.settings, self.clock.ros_now, self.clock)
        self.motion = MotionLink(self.settings, self, self.clock.ros_now, self.clock)
        self._behaviours = list(behaviours)
        self._running: tuple[str, Iterator[MotionReport]] | None = None
        self._next_beat = 0.0

    def achieve(self, goal: str = GOAL, given: str = "", answer: str = "") -> Outcome:
        return self.loop(answer).run(lambda: self.read(goal), given)

    def loop(self, answer: str = "") -> ClosedLoop:
        return ClosedLoop(
            self.settings,
            self.scenes,
            self.motion,
            self._hear,
            lambda: self.cancelled,
            lambda: self.shut_down,
            self.clock,
            lambda: self.conflict,
            answer,
        )

    def look(self) -> None:
        sighting = sighting_of(self.stacks, self.clock.ros_now(), **self.fault)
        self.scenes.receive(in_doubt(sighting, **self.alternatives))

    def report(self, report: MotionReport) -> None:
        if self.tells_arm and report.arm == ArmPlace.UNKNOWN:
            moving = report.state == MotionState.EXECUTING
            arm = ArmPlace.MOVING if moving else self.arm
            report = replace(report, arm=arm, held=self.held, hand=self.hand)
        self.motion.receive(replace(report, stamp=self.clock.ros_now()))

    def live_on(self) -> None:
        """One period of the neighbours."""
        if not self.silent:
            self.look()
        if self._running:
            plan_id, reports = self._running
            if (report := next(reports, None)) is not None:
                self._next_beat = self.clock.seconds + BEAT_SECONDS
                self.report(replace(report, plan_id=report.plan_id or plan_id))
                return
            self._running = None
        if not self.mute and self.clock.seconds >= self._next_beat:
            self._next_beat = self.clock.seconds + BEAT_SECONDS
            self.report(MotionReport())

    def stages(self) -> list[Stage]:
        return list(dict.fromkeys(item.stage for item in self.told))

    def messages(self) -> list[str]:
        return list(dict.fromkeys(item.message for item in self.told))

    @property
    def plan_ids(self) -> list[str]:
        return list(dict.fromkeys(plan.plan_id for plan in self.plans))

    def go_on_with(self, plan_id: str, reports: Iterator[MotionReport]) -> None:
        """The motion node carries out something that nobody here has asked for."""
        self._running = (plan_id, reports)

    # The motion node's side of the topic symbolic_plan.

    def publish(self, plan: Plan) -> None:
        self.plans.append(plan)
        if not self.deaf:
            behaviour = self._behaviours.pop(0) if self._behaviours else obey
            self._running = (plan.plan_id, behaviour(self, plan))

    def publish_stop(self, plan_id: str) -> None:
        self.stops.append(plan_id)
        if plan_id.startswith("home-") and not self.deaf:
            way = self.homes.pop(0) if self.homes else go_home
            self._running = (plan_id, way(self))

    def publish_sight(self, plan_id: str, sight: PlanSight) -> None:
        self.sights.append((plan_id, sight))

    def subscribers(self) -> int:
        return self.audience

    def _hear(self, progress: Progress) -> None:
        self.told.append(progress)
        self.cancelled = self.cancelled or self.cancel_at(progress)

    @staticmethod
    def read(goal: str) -> ResolveGoal:
        """What the loop gets of a goal."""
        parsed = parse_goal(goal)
        return lambda seen, rows=ONE_ROW: resolve_goal(
            parsed, [name for stack in seen for name in stack], rows=rows
        )


def go_home(bench: LoopBench) -> Iterator[MotionReport]:
    """The way home, without what was held."""
    yield MotionReport(state=MotionState.EXECUTING, phase="home")
    bench.arm, bench.held = ArmPlace.HOME, ""
    yield MotionReport(state=MotionState.CANCELLED, message="at home")


def stay(reason: MotionReason, message: str) -> Way:
    """There is no way home."""

    def way(_bench: LoopBench) -> Iterator[MotionReport]:
        yield MotionReport(state=MotionState.FAILED, reason=reason, message=message)

    return way


def carry_out(bench: LoopBench, moves: Sequence[Move]) -> Iterator[MotionReport]:
    yield MotionReport(state=MotionState.OPTIMISING, message="optimising")
    for index, move in enumerate(moves):
        bench.stacks = apply_move(bench.stacks, move)
        yield MotionReport(state=MotionState.EXECUTING, move=index, moves_done=index + 1)


def obey(bench: LoopBench, plan: Plan) -> Iterator[MotionReport]:
    """Everything goes well."""
    if plan.explain:
        yield MotionReport(state=MotionState.CANCELLED, message="it could be carried out")
        return
    yield from carry_out(bench, plan.moves)
    yield MotionReport(
        state=MotionState.SUCCEEDED, moves_done=len(plan.moves), optimisation_seconds=0.01
    )


def obey_blindly(bench: LoopBench, plan: Plan) -> Iterator[MotionReport]:
    """Everything goes well, but the camera shows nothing any more."""
    bench.silent = True
    yield from obey(bench, plan)


def fail(reason: MotionReason, message: str, after: int = 0) -> Behaviour:
    """Fails for a reason after some moves."""

    def behaviour(bench: LoopBench, plan: Plan) -> Iterator[MotionReport]:
        yield from carry_out(bench, plan.moves[:after])
        yield MotionReport(
            state=MotionState.FAILED, reason=reason, message=message, moves_done=after
        )

    return behaviour


def knock(stacks: Stacks) -> Behaviour:
    """Succeeds, but afterwards the world is another one."""

    def behaviour(bench: LoopBench, plan: Plan) -> Iterator[MotionReport]:
        yield from carry_out(bench, plan.moves)
        bench.stacks = stacks
        yield MotionReport(state=MotionState.SUCCEEDED, moves_done=len(plan.moves))

    return behaviour


def ignore(bench: LoopBench, _plan: Plan) -> Iterator[MotionReport]:
    """Does not answer at all."""
    bench.mute = True
    return iter(())


def take_up_and_die(bench: LoopBench, _plan: Plan) -> Iterator[MotionReport]:
    bench.mute = True
    yield MotionReport(state=MotionState.EXECUTING)


def restart(_bench: LoopBench, _plan: Plan) -> Iterator[MotionReport]:
    """Takes the plan up and knows nothing of it any more."""
    yield MotionReport(state=MotionState.EXECUTING)


def run_until_stopped(bench: LoopBench, plan: Plan) -> Iterator[MotionReport]:
    """Moves on and on; puts down what it holds when it is stopped."""
    while not bench.stops:
        yield MotionReport(state=MotionState.EXECUTING)
    bench.stacks = apply_move(bench.stacks, plan.moves[0])
    yield MotionReport(state=MotionState.CANCELLED, moves_done=1, message="put red_box down first")
