# SPDX-License-Identifier: Apache-2.0
"""Brings an arm home that is somewhere: what it holds is put down first, if that can be."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, replace
from typing import Final, Protocol

import numpy as np
from numpy.typing import NDArray
from tamp_runtime.motion_report import SOMETHING, MotionReason

from scene_graph import base_name

from ..errors import InfeasibleError
from ..phases import HOME, PLACE
from ..planner import Motion
from .arm_state import ArmState
from .condition import Condition
from .errors import ExecutionError
from .follow import Follower

Array = NDArray[np.float64]

#: How often a way home is looked for, from wherever the arm is by then.
ATTEMPTS: Final = 5
#: Of these, how often a block in the hand is tried to be put down.
PUT_DOWN_ATTEMPTS: Final = 2
#: An arm that was sent to stand still rests if it does so for this long, by its own clock [s].
_REST_SECONDS: Final = 0.3


class WaysHome(Protocol):
    """Plans ways home; see :class:`motion_node.planner.MotionPlanner`."""

    def solve_way_home(self, motion: Motion, moves_done: int, arm: Array, fingers: Array) -> Motion:
        """The way home of an empty hand in the middle of a plan."""

    def solve_put_down(self, motion: Motion, move: int, arm: Array) -> Motion:
        """The rest of a move whose block is in the hand, and the way home."""

    def solve_rise_home(
        self, motion: Motion | None, arm: Array, fingers: Array, held: str = ""
    ) -> Motion:
        """Straight up, and home, with what is held."""


@dataclass(frozen=True)
class Recovered:
    """The arm is home.

    Attributes:
        sentence: what was done.
        held: what is still in the hand; empty: nothing.
    """

    sentence: str
    held: str = ""


class Recovery:
    """One way home, in as many attempts as it takes.

    Args:
        motion: what the arm was doing; None: nobody knows.
        moves_done: how many of its moves have been carried out.
        in_order: whether the blocks stand as the motion predicts; else the arm rises above them.
        tell: told what is being done: a sentence, the kind of the phase, its block.

    Attributes:
        moves_done: grows when a block is put down.
    """

    def __init__(
        self,
        follower: Follower,
        planner: WaysHome,
        condition: Condition,
        motion: Motion | None,
        moves_done: int,
        in_order: bool,
        tell: Callable[[str, str, str], None],
    ) -> None:
        self._follower, self._planner, self._condition = follower, planner, condition
        self._motion, self.moves_done, self._in_order = motion, moves_done, in_order
        self._tell = tell
        self._put_downs = 0
        self._done: list[str] = []

    def bring_home(self) -> Recovered:
        """Puts down what is held and goes home.

        Raises:
            ExecutionError: if the arm cannot be brought home; says where it is with what.
            ClosedError: if the node ends.
        """
        failure: Exception | None = None
        grip = self._follower.grip
        if self._follower.settings.in_step and grip.held == SOMETHING:
            # What resisted may have been a gripper that did not hear; it may hear by now.
            self._follower.grip = replace(grip, held="")
        for _ in range(ATTEMPTS):
            try:
                state = self._follower.wait_for_rest(seconds=_REST_SECONDS)
                assert state is not None
                held = self._held(state)
                home = self._condition.near_home(state)
                if home and not (held and self._can_put_down(held)):
                    return self._recovered(held, failure)
                self._go(state, held)
            except (ExecutionError, InfeasibleError) as error:
                failure = error
                if isinstance(error, ExecutionError) and not error.recoverable:
                    break
        state = self._follower.wait_for_rest(seconds=_REST_SECONDS) if _seen(failure) else None
        if state is not None and self._condition.near_home(state):
            return self._recovered(self._held(state), failure)
        raise self._stuck(failure)

    def _held(self, state: ArmState) -> str:
        """What is in the hand; fingers that merely stand half open are found out."""
        held = self._condition.held(state)
        grip = self._follower.grip
        if grip.held and not held:
            self._done.append(f"{_named(grip.held)} is not in the hand any more")
            self._follower.grip = replace(grip, held="", move=-1)
        if held == SOMETHING and grip.held != SOMETHING:
            self._tell("feeling whether the hand holds something", HOME, "")
            held = SOMETHING if self._follower.feel(state) else ""
            self._follower.grip = replace(self._follower.grip, held=held, move=-1)
        return held

    def _can_put_down(self, held: str) -> bool:
        if held == SOMETHING or self._put_downs >= PUT_DOWN_ATTEMPTS:
            return False
        return self._motion is not None and self._follower.grip.move >= 0

    def _go(self, state: ArmState, held: str) -> None:
        """One attempt."""
        arm, fingers = state.positions.arm, state.positions.fingers
        if held and self._can_put_down(held):
            self._put_downs += 1
            self._put_down(arm, held)
            return
        if not held and self._motion is not None and self._in_order:
            self._in_order = False  # where that does not lead home, a way that knows less may
            self._tell("going home", HOME, "")
            way = self._planner.solve_way_home(self._motion, self.moves_done, arm, fingers)
        else:
            self._tell(f"going home{f' with {_named(held)}' if held else ''}", HOME, "")
            way = self._planner.solve_rise_home(self._motion, arm, fingers, held)
        self._follower.follow(way.trajectory)

    def _put_down(self, arm: Array, held: str) -> None:
        """Where the move was to put it."""
        assert self._motion is not None
        move = self._follower.grip.move
        try:
            way = self._planner.solve_put_down(self._motion, move, arm)
        except InfeasibleError:
            self._put_downs = PUT_DOWN_ATTEMPTS  # from elsewhere it would not be there either
            raise
        stacks = [
            base_name(phase.switch.stack)
            for phase in self._motion.phases
            if phase.kind == PLACE and phase.move == move and phase.switch
        ]
        where = f"on {stacks[0]}" if stacks else "where it was to go"
        self._tell(f"putting {held} down {where}", PLACE, held)
        follower = self._follower
        try:
            follower.follow(way.trajectory)
        except ExecutionError as error:
            if error.reason is MotionReason.GRASP_LOST and not follower.grip.held:
                self._done.append(f"{held} was lost on the way")
            raise
        finally:
            if follower.let_go_of == held:
                self.moves_done = move + 1
                self._done.append(f"{held} was put down {where}")

    def _recovered(self, held: str, failure: Exception | None) -> Recovered:
        end = "the arm is home"
        if held == SOMETHING:
            end += (
                " and holds something that this node did not pick; take it out by hand, or open "
                "the gripper"
            )
        elif held:
            why = f" ({failure})" if failure else ""
            end += f" and holds {held}, which could not be put down{why}; take it out by hand"
        return Recovered(_joined([*self._done, end]), held)

    def _stuck(self, failure: Exception | None) -> ExecutionError:
        """The arm is not home; says where it is."""
        x, y, z = self._condition.hand
        held = self._condition.held()
        with_what = f" holding {_named(held)}" if held else ""
        where = f"its hand is at ({x:.2f}, {y:.2f}, {z:.2f}) m{with_what}"
        reason = failure.reason if isinstance(failure, ExecutionError) else MotionReason.INFEASIBLE
        sentence = _joined([*self._done, f"the arm could not go home: {failure}; {where}"])
        return ExecutionError(reason, sentence)


def _seen(failure: Exception | None) -> bool:
    """Whether the arm is still heard of after that."""
    return not isinstance(failure, ExecutionError) or failure.recoverable


def _named(held: str) -> str:
    return "something" if held == SOMETHING else held


def _joined(parts: list[str]) -> str:
    """Parts of a sentence, the last two joined by "and"."""
    return " and ".join([", ".join(parts[:-1]), parts[-1]]) if len(parts) > 1 else parts[0]
