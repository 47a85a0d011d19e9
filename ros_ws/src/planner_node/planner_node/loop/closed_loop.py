# SPDX-License-Identifier: Apache-2.0
"""The closed loop: perceive, plan, move, perceive again, until the camera confirms the goal."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace

from tamp_runtime.motion_report import MotionState

from scene_graph import format_stacks

from ..errors import (
    CancelledError,
    ConflictError,
    ImpossibleError,
    MotionSilentError,
    NeedsAnswerError,
    NoSceneGraphError,
    NotConfidentError,
    ObjectLostError,
    PlannerError,
    TooManyReplansError,
)
from ..goals.goal import Goal, ResolveGoal
from ..search import SearchResult
from ..settings import EACH_MOVE, WATCH, Settings
from .account import account_for, agree, besides, describe_difference, in_the_view, newly_seen
from .arm_home import ArmHome
from .certain_goal import Answers
from .clock import Clock
from .motion_link import MotionLink
from .plan import Plan, plan_for
from .plan_run import PlanRun
from .plan_watch import PlanWatch
from .possible_moves import PossibleMoves
from .recall import recall
from .record import Record
from .report import Outcome, Progress, Stage, Status
from .scene import Scene
from .scene_plan import decided, meaning
from .scene_watch import SceneWatch
from .teller import Teller

#: A refused picture; an arm in the view can be why.
_UNSEEN = (NoSceneGraphError, NotConfidentError, ObjectLostError)


class ClosedLoop:
    """One run of achieve_goal."""

    def __init__(
        self,
        settings: Settings,
        scenes: SceneWatch,
        motion: MotionLink,
        report: Callable[[Progress], None],
        cancelled: Callable[[], bool],
        shut_down: Callable[[], bool],
        clock: Clock | None = None,
        conflict: Callable[[], str] = lambda: "",
        answer: str = "",
    ) -> None:
        """See :class:`ClosedLoop`.

        Args:
            report: gets every progress.
            cancelled: includes ``shut_down``.
            conflict: a sentence while two nodes do the work of one; nothing is claimed then.
            answer: to what has to be asked about blocks in doubt, see :class:`.Answers`.
        """
        self._settings = settings
        self._scenes = scenes
        self._motion = motion
        self._cancelled = cancelled
        self._conflict = conflict
        self._clock = clock or Clock()
        self._teller = Teller(report, self._clock)
        self._record = Record(self._clock)
        self._arm = ArmHome(
            settings, motion, self._teller.say, self._record.because, self._check, self._stopped
        )
        self._runs = PlanRun(
            *(settings, motion, self._teller, self._record.because),
            *(cancelled, conflict, self._stopped, shut_down),
            newest=lambda: scenes.newest,
        )
        self._patience, self._remarks = 1, list[str]()
        self._possible = PossibleMoves(settings, cancelled)
        self._answers = Answers(answer, scenes.answer, self._look_again, self._possible.plan)
        self._requested = scenes.now()

    @property
    def outcome(self) -> Outcome:
        """What is noted so far; it can be given even after a defect."""
        return self._record.outcome

    def run(self, read: Callable[[], ResolveGoal], given: str = "") -> Outcome:
        """Works until the goal is confirmed or cannot be reached; every end is an outcome.

        Args:
            read: gives the function that resolves the goal in the first scene.
            given: another planner's plan, with which to begin.
        """
        self._possible.given = given.strip()
        try:
            status, message = self._achieve(read)
            if conflict := self._conflict():
                raise ConflictError(conflict)
            self._record.note(status=status, message=message)
        except PlannerError as error:
            if isinstance(error, MotionSilentError):
                self._glance()
            if isinstance(error, NeedsAnswerError):
                self._record.note(answers=error.doubt.colors)
            told = isinstance(error, CancelledError | TooManyReplansError)
            if not told and str(error) not in self._record.outcome.causes:
                self._record.because(str(error))
            self.give_up(Status[error.status], str(error), error.module)
        self._record.note(motion=self._motion.last_on(self._record.outcome.motion))
        return self._record.outcome

    def give_up(self, status: Status, message: str, module: str) -> Outcome:
        """The outcome of a run that failed; its message tells what state it leaves."""
        motion = self._motion
        self._record.note(motion=motion.last_on(self._record.outcome.motion))
        # A goal that makes no sense leaves nothing behind that its sentence had to tell.
        if self._record.outcome.moves_planned or (module != "planner" and motion.knows_arm):
            message = account_for(message, self._record.outcome, motion.newest, motion.silence)
        self._record.note(status=status, message=message, module=module)
        return self._record.outcome

    def _achieve(self, read: Callable[[], ResolveGoal]) -> tuple[Status, str]:
        self._tell(Stage.PERCEIVING, "reading the goal")
        with self._record.timed("perceive_seconds"):
            resolve = read()
        scene = self._look(Stage.PERCEIVING, "waiting for a confident scene graph")
        self._record.note(initial=scene)
        scene, goal = self._uncovered(scene, resolve)
        plans = 0
        while scene.aside or not goal.holds(scene.stacks):
            if plans and not self._possible.just_refused:
                self._count_replan(scene)
            try:
                found = self._plan(scene, goal)
            except ImpossibleError as error:
                # The poses are seen anew, which may be enough.
                if not self._possible.forget_once():
                    self._add_what_helps(error)
                    raise
                self._record.because(str(error))
                scene = self._look(Stage.PERCEIVING, "looking again", goal.names)
                continue
            if not plans:
                self._record.planned(len(found.moves))
            plans += 1
            scene = self._work_off(scene, goal, found)
            if scene.hidden:
                scene, goal = self._uncovered(scene, resolve)
        seen = format_stacks(scene.stacks)
        if not plans and not self._record.outcome.moves_planned:
            return Status.ALREADY_TRUE, f"nothing to do: '{goal}' holds in {seen}"
        told = "".join(f"; {sentence}" for sentence in dict.fromkeys(self._remarks))
        return Status.SUCCESS, f"the camera confirms '{goal}': {seen}{told}"

    def _add_what_helps(self, error: ImpossibleError) -> None:
        """To the sentence, what would make the first plan that was refused possible."""
        refused = self._possible.first_refused
        suggestion = self._runs.helpful(refused) if refused is not None else ""
        self._check()
        if suggestion:
            error.args = (f"{error}; what would help: {suggestion}",)

    def _uncovered(self, scene: Scene, resolve: ResolveGoal) -> tuple[Scene, Goal]:
        """The scene once all that matters to the goal is seen, and the goal in it (5.4.3).

        Blocks that hide others are moved aside first.
        """
        attempts = 0
        while scene.hidden:
            goal = meaning(resolve, scene)
            if goal is not None and decided(goal, scene) and goal.holds(scene.stacks):
                return scene, goal
            if attempts and not self._possible.just_refused:
                self._count_replan(scene)
            self._tell(
                Stage.PLANNING, f"searching what to move aside in {format_stacks(scene.stacks)}"
            )
            with self._record.timed("plan_seconds"):
                found = self._possible.uncover(scene, goal)
            self._tell(Stage.PLANNING, found.note)
            if not attempts:
                moves = "1 move was" if len(found.moves) == 1 else f"{len(found.moves)} moves were"
                self._remarks.append(f"{moves} made to see what stands behind others")
                self._record.planned(len(found.moves))
            attempts += 1
            plan = plan_for(scene, goal or Goal(()), found, self._scenes.now())
            scene = self._carry_out(plan, plan.goal)
        return self._answers.goal_in(scene, resolve)

    def _work_off(self, scene: Scene, goal: Goal, found: SearchResult) -> Scene:
        """Has what was found carried out, all at once or with a look after each move."""
        each = self._settings.verify == EACH_MOVE
        for part in found.move_by_move() if each else (found,):
            scene = self._carry_out(plan_for(scene, goal, part, self._scenes.now()), goal)
            if not agree(scene.stacks, part.states[-1]) or goal.holds(scene.stacks):
                break
        return scene

    def _carry_out(self, plan: Plan, goal: Goal) -> Scene:
        """Has a plan carried out, and looks what has become of it.

        The look is taken even where the motion failed for good: the goal may be reached all the
        same, and if not, the answer tells what was seen last.
        """
        self._check()
        before = len(self._record.outcome.causes)
        watch = self._watch_over(plan)
        started = self._clock.now()
        try:
            end = self._runs.carry_out(plan, watch)
        finally:
            self._record.carried_out(self._teller.progress.motion, self._clock.now() - started)
        if refused := self._possible.refused(plan, end.report):
            self._record.because(f"{refused}; another way is planned")
            return plan.scene
        failure = self._runs.judge(end)
        reason = "; ".join(self._record.outcome.causes[before:])
        try:
            message = reason or "looking whether the goal is reached"
            scene = self._look(
                Stage.CONFIRMING,
                message,
                goal.names,
                moved=True,
                recall=lambda seen: recall(seen, plan, end.report),
            )
        except _UNSEEN as error:
            if failure is None:
                raise
            self._record.because(str(error))
            raise failure from error
        if watch is not None and end.report.state == MotionState.SUCCEEDED:
            self._remarks += watch.told_of_moved
        if end.contradicted and watch is not None:
            self._remarks.append(watch.contradiction)
            if watch.is_as_predicted(scene, end.report.moves_done):
                self._patience *= 2
        if difference := describe_difference(plan, end.report, scene):
            self._record.because(difference)
        silence = end.silence
        if silence is not None and not silence.taken_up and scene.stacks == plan.scene.stacks:
            failure = silence
        if failure is not None and not goal.holds(scene.stacks):
            raise failure
        return scene

    def _watch_over(self, plan: Plan) -> PlanWatch | None:
        """What compares frames with a plan while it is carried out, where that is wanted."""
        return PlanWatch(plan, self._patience) if self._settings.verify == WATCH else None

    def _look(
        self,
        stage: Stage,
        message: str,
        needed: frozenset[str] = frozenset(),
        moved: bool = False,
        recall: Callable[[Scene], Scene] = lambda scene: scene,
    ) -> Scene:
        """The scene after the request and the last motion, with the ``needed`` objects in it.

        Blocks that others hide are put in by ``recall``.
        """
        self._tell(stage, message)
        with self._record.timed("perceive_seconds"):
            self._arm.settle(moved)
            self._check()
            if self._teller.progress.message != message:
                self._tell(stage, message)
            after = max(self._requested, self._motion.last_end)
            try:
                scene = self._scenes.wait(self._stopped, after, needed, recall)
            except CancelledError:
                self._check()
                raise
            except _UNSEEN as error:
                clauses = [str(error), in_the_view(self._motion.newest)]
                if isinstance(error, NotConfidentError):
                    clauses.append(newly_seen(self._scenes.newest, self._record.outcome.final))
                error.args = ("; ".join(filter(None, clauses)),)
                raise
        self._record.note(final=scene)
        return scene

    def _look_again(self) -> Scene:
        return self._look(Stage.PERCEIVING, "looking again")

    def _glance(self) -> None:
        """Notes the newest scene, if there is one, where nobody can be waited for any more."""
        try:
            self._record.note(final=self._scenes.latest(self._requested))
        except PlannerError:
            return

    def _count_replan(self, scene: Scene) -> None:
        replans = self._record.outcome.replans
        if replans >= self._settings.max_replans:
            raise TooManyReplansError(
                f"gave up after {replans} replans; the camera last saw "
                f"{format_stacks(scene.stacks)}",
                replans,
            )
        self._record.note(replans=replans + 1)
        self._teller.progress = replace(self._teller.progress, replans=replans + 1)

    def _plan(self, scene: Scene, goal: Goal) -> SearchResult:
        self._tell(Stage.PLANNING, f"searching from {format_stacks(scene.stacks)} to '{goal}'")
        with self._record.timed("plan_seconds"):
            found = self._possible.plan(scene, goal)
        for sentence in besides(scene):
            self._tell(Stage.PLANNING, f"{sentence}; it is fetched")
            self._remarks.append(f"{sentence}, and was fetched")
        if found.note:
            self._tell(Stage.PLANNING, found.note)
            self._remarks.append(f"the plan was {found.note}")
        return found

    def _check(self) -> None:
        """Raises CancelledError or ConflictError if the run is to end."""
        if self._cancelled():
            raise CancelledError("cancelled")
        if conflict := self._conflict():
            raise ConflictError(conflict)

    def _stopped(self) -> bool:
        """Whether the run is to end; asked in every wait, so that the feedback goes on in it."""
        self._teller.beat()
        return self._cancelled() or bool(self._conflict())

    def _tell(self, stage: Stage, message: str) -> None:
        self._teller.tell(stage, message)
