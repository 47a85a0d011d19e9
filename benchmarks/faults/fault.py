# SPDX-License-Identifier: Apache-2.0
"""A fault: what goes wrong, when, for how long, and what an answer must say about it."""

from __future__ import annotations

from dataclasses import dataclass, field
from enum import Enum
from typing import TYPE_CHECKING, Any, Final, Protocol

if TYPE_CHECKING:
    from faults.setting import Setting


class Phase(str, Enum):
    """When a fault begins."""

    PERCEIVE = "perceive"  # before the request is sent
    OPTIMISE = "optimise"  # the motion node has the plan
    EXECUTE = "execute"  # somewhere in a pick or a place
    CONFIRM = "confirm"  # the arm is on its way home after the last move, or the camera looks


class Ending(str, Enum):
    """What became of a task under a fault."""

    REACHED = "reached"  # claimed, and the ground truth agrees
    REFUSED = "refused"  # a typed status, and a sentence that names the cause
    WRONG_SENTENCE = "wrong sentence"  # refused, but the sentence does not name the cause
    FALSE_SUCCESS = "false success"  # claimed, and the ground truth disagrees
    HUNG = "hung"  # no answer, and none to a cancel
    NODE_DIED = "node died"  # a node that nobody killed


GOOD: Final = frozenset({Ending.REACHED, Ending.REFUSED})

ALL_PHASES: Final = tuple(Phase)
CAMERA_PHASES: Final = (Phase.PERCEIVE, Phase.CONFIRM)
MOVING_PHASES: Final = (Phase.OPTIMISE, Phase.EXECUTE)

#: Of each group of alternatives the sentence must hold one.
Words = tuple[tuple[str, ...], ...]
#: Parameters of nodes: node, name, value.
Parameters = tuple[tuple[str, str, Any], ...]


class Injection(Protocol):
    """How a fault is brought about, and taken away again."""

    @property
    def topics(self) -> tuple[str, ...]:
        """The topics that need a relay."""

    @property
    def needs_goal(self) -> bool:
        """Whether it makes sense only once the request was sent, as a cancel does."""

    def begin(self, setting: Setting) -> None:
        """Lets the fault begin."""

    def end(self, setting: Setting) -> None:
        """Takes it away; what it broke is whole again afterwards, as far as that can be had."""


@dataclass(frozen=True)
class Fault:
    """One kind of fault.

    Attributes:
        name: what ``ONLY=`` takes; small letters and dashes.
        what: a sentence for the dictionary.
        injection: how it comes about.
        phases: in which it begins; the trials are spread over them.
        words: what a refusal must say, in its message or among its causes.
        seconds: for how long it lasts (wall time); None: until the answer.
        statuses: with which it may be refused; empty: any but INTERNAL_ERROR.
        transient: it passes, so the goal must be reached.
        unseen: why no camera can tell, if a claim may be wrong under it.
        asker: who asks: a ``program``, or the ``command`` line client in a process of its own.
        parameters: without which it would not matter; others are as people start the graph.
    """

    name: str
    what: str
    injection: Injection
    phases: tuple[Phase, ...]
    words: Words = field(default=())
    seconds: float | None = None
    statuses: tuple[str, ...] = ()
    transient: bool = False
    unseen: str = ""
    asker: str = "program"
    parameters: Parameters = ()

    @property
    def topics(self) -> frozenset[str]:
        """The topics that need a relay."""
        return frozenset(self.injection.topics)

    def phase_of(self, trial: int) -> Phase:
        """The phase of a trial, counted from 0: they take turns."""
        return self.phases[trial % len(self.phases)]


def names_the_cause(sentence: str, words: Words) -> bool:
    """Whether a sentence holds one of each group of words, whatever their case."""
    heard = sentence.lower()
    return all(any(word.lower() in heard for word in group) for group in words)
