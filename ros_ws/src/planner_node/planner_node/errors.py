# SPDX-License-Identifier: Apache-2.0
"""Why a goal cannot be planned for; every error carries what failed and a status."""

from __future__ import annotations

from collections.abc import Iterable, Mapping, Sequence
from typing import TYPE_CHECKING, ClassVar

if TYPE_CHECKING:
    from .loop.readings import Doubt


class PlannerError(Exception):
    """Base class; the message is a sentence that a person can act on.

    Attributes:
        status: name of the constant of PlanToGoal and AchieveGoal that reports this error.
        module: the part of the system that could not go on: perception, planner, motion or "".
    """

    status: ClassVar[str] = "INTERNAL_ERROR"
    module: ClassVar[str] = "planner"


class InvalidGoalError(PlannerError):
    """The goal cannot be understood; ``text`` stands at ``offset``, counted from 0."""

    status = "INVALID_GOAL"

    def __init__(self, problem: str, offset: int = 0, text: str = "") -> None:
        where = f"at offset {offset} ('{text}'): " if text else f"at offset {offset}: "
        super().__init__(where + problem)
        self.offset = offset
        self.text = text


class UnknownObjectError(PlannerError):
    """The goal names something that is not among the ``known`` objects."""

    status = "UNKNOWN_OBJECT"

    def __init__(self, name: str, known: Sequence[str], problem: str) -> None:
        super().__init__(problem)
        self.name = name
        self.known = tuple(known)


class AmbiguousObjectError(PlannerError):
    """A name fits several ``candidates``."""

    status = "AMBIGUOUS_OBJECT"

    def __init__(self, name: str, candidates: Sequence[str], problem: str) -> None:
        super().__init__(problem)
        self.name = name
        self.candidates = tuple(candidates)


class ObjectLostError(UnknownObjectError):
    """Objects of a goal that was understood before are no longer seen, or lie before the places.

    Args:
        lying: where blocks lie before the places, by name [m].
    """

    module = "perception"

    def __init__(
        self,
        missing: Sequence[str],
        known: Sequence[str],
        lying: Mapping[str, tuple[float, float, float]] | None = None,
    ) -> None:
        there = lying or {}
        gone = [name for name in missing if name not in there]
        told = [
            f"{name} lies before the places, at ({x:.2f}, {y:.2f}) m: put it on a place by hand, "
            "and ask again"
            for name, (x, y, _) in sorted(there.items())
            if name in missing
        ]
        if gone:
            told.insert(0, f"{', '.join(gone)} cannot be seen any more")
        super().__init__(missing[0], known, f"{'; '.join(told)}; the scene has {', '.join(known)}")


class ContradictoryGoalError(PlannerError):
    """No arrangement of the blocks fulfils all ``relations``, given as text."""

    status = "CONTRADICTORY_GOAL"

    def __init__(self, relations: Iterable[object], problem: str) -> None:
        self.relations = tuple(str(relation) for relation in relations)
        super().__init__(f"{problem} (from: {', '.join(self.relations)})")


class SearchError(PlannerError):
    """The search ended without a plan after ``expanded`` states and ``seconds``."""

    def __init__(self, problem: str, expanded: int, seconds: float) -> None:
        super().__init__(problem)
        self.expanded = expanded
        self.seconds = seconds


class UnreachableError(SearchError):
    """Proven: every reachable state was searched and none fulfils the goal."""

    status = "UNREACHABLE"


class UnstableError(UnreachableError):
    """Proven: every plan would put a block where it cannot stand; ``placements`` are examples."""

    def __init__(
        self, problem: str, expanded: int, seconds: float, placements: Sequence[object] = ()
    ) -> None:
        super().__init__(problem, expanded, seconds)
        self.placements = tuple(str(item) for item in placements)


class ImpossibleError(SearchError):
    """Proven: without the moves that the arm cannot make, no sequence fulfils the goal.

    ``excluded``: these moves, each in words with its reason.
    """

    status = "MOTION_FAILED"
    module = "motion"

    def __init__(
        self, problem: str, expanded: int, seconds: float, excluded: Sequence[str] = ()
    ) -> None:
        super().__init__(problem, expanded, seconds)
        self.excluded = tuple(excluded)


class SearchLimitError(SearchError):
    """Not reached within the bound on expansions: nothing is proven."""

    status = "SEARCH_LIMIT"


class SearchCancelledError(SearchError):
    """Stopped by its caller."""

    status = "CANCELLED"
    module = ""


class GivenPlanError(PlannerError):
    """Another planner's plan is refused; ``step`` is the move that fails, from 0, or all moves."""

    status = "INVALID_PLAN"

    def __init__(self, problem: str, step: int) -> None:
        super().__init__(problem)
        self.step = step


class EngineError(SearchError):
    """Another planner's engine is not installed, failed, or gave a plan that is none."""

    status = "ENGINE_FAILED"


class NoSceneGraphError(PlannerError):
    """No scene graph has arrived."""

    status = "NO_SCENE_GRAPH"
    module = "perception"


class NotConfidentError(PlannerError):
    """The newest scene graph cannot be trusted."""

    status = "NOT_CONFIDENT"
    module = "perception"


class NeedsAnswerError(PlannerError):
    """What the goal means depends on ``doubt``, about which the message asks."""

    status = "NEEDS_ANSWER"
    module = "perception"

    def __init__(self, doubt: Doubt, question: str) -> None:
        super().__init__(question)
        self.doubt = doubt


class GoalImageError(PlannerError):
    """The goal image cannot be interpreted, or does not show the objects of the scene."""

    status = "GOAL_IMAGE_REJECTED"
    module = "perception"

    def __init__(
        self, problem: str, missing: Sequence[str] = (), extra: Sequence[str] = ()
    ) -> None:
        super().__init__(problem)
        self.missing = tuple(missing)
        self.extra = tuple(extra)


class BusyError(PlannerError):
    """Another plan or goal is under way; ``plan_id`` names it where it is known."""

    status = "BUSY"

    def __init__(self, problem: str, plan_id: str = "") -> None:
        super().__init__(problem)
        self.plan_id = plan_id


class CancelledError(PlannerError):
    """Stopped on request; nothing is held."""

    status = "CANCELLED"
    module = ""


class MotionFailedError(PlannerError):
    """The motion node cannot carry the plan out; the message is its own."""

    status = "MOTION_FAILED"
    module = "motion"


class MotionBusyError(BusyError):
    """The motion node carries out somebody else's plan."""

    module = "motion"


class MotionSilentError(PlannerError):
    """The motion node does not answer about ``plan_id``.

    Attributes:
        taken_up: it did so before.
        speaks: it reports all the same, only not on this plan.
        untouched: nothing can have moved for this plan: nobody hears it, or the motion node was
            idle all the time.
    """

    status = "MOTION_SILENT"
    module = "motion"

    def __init__(
        self, problem: str, plan_id: str, taken_up: bool, speaks: bool, untouched: bool = False
    ) -> None:
        super().__init__(problem)
        self.plan_id = plan_id
        self.taken_up = taken_up
        self.speaks = speaks
        self.untouched = untouched


class ArmStuckError(PlannerError):
    """The arm is not at home or holds something, and cannot be brought home."""

    status = "ARM_STUCK"
    module = "motion"


class ConflictError(PlannerError):
    """Two nodes do the work of one in this domain; the message names them."""

    status = "CONFLICT"
    module = ""


class TooManyReplansError(PlannerError):
    """The scene kept differing from what was planned, ``replans`` times."""

    status = "TOO_MANY_REPLANS"

    def __init__(self, problem: str, replans: int) -> None:
        super().__init__(problem)
        self.replans = replans
