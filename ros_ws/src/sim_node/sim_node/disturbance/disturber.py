# SPDX-License-Identifier: Apache-2.0
"""Disturbances that are pending or under way, step by step."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, replace
from typing import Final

from ..controller import CommandsMotors
from ..world import World
from .disturbance import Disturbance, Stage, check_there
from .events import EventWatch, describe_moment, watch_of
from .hand import touched_block
from .kinds import KINDS
from .request import EVENTS, NOW, DisturbanceError, Request, check_request

#: What is asked for to have everything over.
CALM: Final = "calm"
#: How many can be pending and under way at a time.
MOST: Final = 100


@dataclass(frozen=True)
class Promise:
    """What a request comes to: a number, and a sentence that says what happens and when."""

    number: int
    sentence: str


@dataclass
class _Pending:
    number: int
    disturbance: Disturbance
    watch: EventWatch | None
    delay: int
    begins: int | None  # the step, once it is known
    block: str = ""


@dataclass
class _Active:
    number: int
    disturbance: Disturbance
    ends: int


class Disturber:
    """Brings disturbances about, in the thread that owns the physics.

    What happens depends on steps of the physics and contacts alone, so the same requests at the
    same steps give the same physics bit by bit. As long as nothing is asked for, nothing is done.

    Args:
        tell: told in a sentence what begins, what ends and what cannot happen.
    """

    def __init__(
        self, world: World, arm: CommandsMotors, tell: Callable[[str], None] = lambda _text: None
    ) -> None:
        self._stage = Stage(world, arm)
        self._tell = tell
        self._number = 0
        self._pending: list[_Pending] = []
        self._active: list[_Active] = []

    @property
    def pending(self) -> int:
        """How many wait for their moment."""
        return len(self._pending)

    @property
    def active(self) -> int:
        """How many are under way."""
        return len(self._active)

    def request(self, request: Request) -> Promise:
        """Has something happen, now or later.

        Raises:
            DisturbanceError: it cannot; the world is as it was.
        """
        if request.kind == CALM:
            return self._calm(request)
        if request.kind not in KINDS:
            known = ", ".join((*KINDS, CALM))
            raise DisturbanceError(f"kind is {request.kind!r}; there are {known}")
        world = self._stage.world
        kind = KINDS[request.kind]
        check_request(request, kind.uses, request.kind)
        if request.of:
            check_there(self._stage, request.of)
        disturbance = kind(request)
        disturbance.check(self._stage)
        if request.step is not None and request.step < world.steps:
            late = (world.steps - request.step) * world.timestep
            raise DisturbanceError(f"the time asked for was {late:.3g} s ago")
        if len(self._pending) + len(self._active) >= MOST:
            raise DisturbanceError(f"{MOST} disturbances are pending or under way already")
        delay = round(request.delay / world.timestep)
        number = self._number + 1
        if request.when not in EVENTS and request.step is None and delay == 0:
            self._begin(number, disturbance, "")
        else:
            watch = watch_of(request, world)
            moment = world.steps if request.step is None else request.step
            begins = None if watch else moment + delay
            self._pending.append(_Pending(number, disturbance, watch, delay, begins))
            self._tell(f"disturbance {number} is pending: {disturbance.sentence}, "
                       f"{describe_moment(request)}")  # fmt: skip
        self._number = number
        return Promise(number, f"{disturbance.sentence}, {describe_moment(request)}")

    def update(self) -> None:
        """Before each step of the physics, after the arm's own command."""
        if not self._pending and not self._active:
            return
        self._begin_what_is_due()
        now = self._stage.world.steps
        for item in list(self._active):
            if now >= item.ends:
                self._active.remove(item)
                item.disturbance.end(self._stage)
                self._tell(f"disturbance {item.number} is over")
        for item in self._active:
            item.disturbance.act(self._stage)

    def reset(self) -> int:
        """After the world's reset, which undoes all: forgets what was; returns how many."""
        count = len(self._pending) + len(self._active)
        self._pending, self._active = [], []
        return count

    def _calm(self, request: Request) -> Promise:
        """Drops what is pending and ends what is under way, without a reset."""
        check_request(request, (), CALM)
        if request.when != NOW or request.delay:
            raise DisturbanceError("calm is for now; it waits for nothing")
        for item in self._active:
            item.disturbance.end(self._stage)
        self._number += 1
        promise = Promise(self._number, f"disturbances dropped or ended: {self.reset()}")
        self._tell(promise.sentence)
        return promise

    def _begin_what_is_due(self) -> None:
        world = self._stage.world
        watching = any(item.watch for item in self._pending)
        touched = touched_block(world) if watching else ""
        due = []
        for item in self._pending:
            if item.watch and (block := item.watch.observe(touched)):
                item.watch, item.block, item.begins = None, block, world.steps + item.delay
            if item.begins is not None and world.steps >= item.begins:
                due.append(item)
        for item in due:
            self._pending.remove(item)
            try:
                self._begin(item.number, item.disturbance, item.block)
            except DisturbanceError as error:
                self._tell(f"disturbance {item.number} cannot happen: {error}")

    def _begin(self, number: int, disturbance: Disturbance, block: str) -> None:
        kind = type(disturbance)
        for item in self._active:
            if kind.alone and isinstance(item.disturbance, kind):
                raise DisturbanceError(
                    f"disturbance {item.number} of the same kind is still under way"
                )
        world = self._stage.world
        disturbance.begin(replace(self._stage, block=block))
        self._tell(f"disturbance {number} at {world.time:.3f} s: {disturbance.sentence}")
        if disturbance.seconds:
            steps = max(1, round(disturbance.seconds / world.timestep))
            self._active.append(_Active(number, disturbance, world.steps + steps))
