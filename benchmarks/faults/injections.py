# SPDX-License-Identifier: Apache-2.0
"""How faults come about: by a relay, to a process, by a client, in the world."""

from __future__ import annotations

import signal
import threading
import time
from collections.abc import Callable
from dataclasses import dataclass
from typing import Final

from faults.askers import CommandAsker, ProgramAsker
from faults.fault import Injection
from faults.relay import Mode
from faults.setting import Setting
from planner_node.cli.client import PlannerClient
from scene_graph import Stacks
from tamp_bringup.scene_observer import SimulationError

#: How long a goal may be refused as BUSY by what somebody else left behind [s].
PATIENCE: Final = 60.0


class Once:
    """What most injections have in common: no relay, and nothing to take away."""

    @property
    def topics(self) -> tuple[str, ...]:
        """See :class:`Injection`."""
        return ()

    @property
    def needs_goal(self) -> bool:
        """See :class:`Injection`."""
        return False

    def begin(self, setting: Setting) -> None:
        """See :class:`Injection`."""

    def end(self, setting: Setting) -> None:
        """See :class:`Injection`."""


@dataclass(frozen=True)
class Damaged(Once):
    """Relays of some topics do something else; the same mode for all."""

    names: tuple[str, ...]
    mode: Mode

    @property
    def topics(self) -> tuple[str, ...]:
        """The damaged ones."""
        return self.names

    def begin(self, setting: Setting) -> None:
        for topic in self.names:
            setting.relays.set(topic, self.mode)

    def end(self, setting: Setting) -> None:
        setting.relays.clear()


@dataclass(frozen=True)
class All(Once):
    """Several at once, in order."""

    parts: tuple[Injection, ...]

    @property
    def topics(self) -> tuple[str, ...]:
        """Those of all parts."""
        return tuple(topic for part in self.parts for topic in part.topics)

    @property
    def needs_goal(self) -> bool:
        """Whether one of them needs it."""
        return any(part.needs_goal for part in self.parts)

    def begin(self, setting: Setting) -> None:
        for part in self.parts:
            part.begin(setting)

    def end(self, setting: Setting) -> None:
        for part in self.parts:
            part.end(setting)


# Processes


@dataclass(frozen=True)
class Killed(Once):
    """A node dies; it is started again when the fault ends."""

    node: str

    def begin(self, setting: Setting) -> None:
        setting.processes.kill(self.node)

    def end(self, setting: Setting) -> None:
        setting.processes.start(self.node)


@dataclass(frozen=True)
class Restarted(Once):
    """A node dies, and is started again at once."""

    node: str

    def begin(self, setting: Setting) -> None:
        setting.processes.kill(self.node)
        setting.processes.start(self.node)


@dataclass(frozen=True)
class Stopped(Once):
    """A node ends as on Ctrl-C; it is started again when the fault ends."""

    node: str

    def begin(self, setting: Setting) -> None:
        setting.processes.stop(self.node)

    def end(self, setting: Setting) -> None:
        setting.processes.start(self.node)


@dataclass(frozen=True)
class Paused(Once):
    """Nodes stand still, as on a machine that swaps."""

    nodes: tuple[str, ...]

    def begin(self, setting: Setting) -> None:
        for node in self.nodes:
            setting.processes.signal(node, signal.SIGSTOP)

    def end(self, setting: Setting) -> None:
        for node in self.nodes:
            setting.processes.signal(node, signal.SIGCONT)


@dataclass(frozen=True)
class StartedTwice(Once):
    """Nodes that are there a second time, in the same domain and namespace."""

    nodes: tuple[str, ...]

    def begin(self, setting: Setting) -> None:
        setting.start_beside(*self.nodes)

    def end(self, setting: Setting) -> None:
        setting.stop_others()
        time.sleep(4.0)  # until their signs of life are forgotten


# Clients


@dataclass(frozen=True)
class Cancelled(Once):
    """The one who asked changes his mind."""

    needs_goal = True

    def begin(self, setting: Setting) -> None:
        assert setting.asker is not None
        setting.asker.cancel()


@dataclass(frozen=True)
class ClientSignalled(Once):
    """The command-line client gets a signal; after SIGKILL somebody else asks for the same."""

    number: signal.Signals
    needs_goal = True

    def begin(self, setting: Setting) -> None:
        asker = setting.asker
        assert isinstance(asker, CommandAsker)
        asker.signal(self.number)
        if self.number == signal.SIGKILL:
            setting.asker = ProgramAsker(setting.planner, PATIENCE)
            setting.asker.start(setting.goal)


@dataclass(frozen=True)
class OthersAsk(Once):
    """Further clients ask for goals at the same time, each once; each must get an answer.

    Args:
        goals: what they ask for; empty: the same goal as the trial's.
    """

    goals: tuple[str, ...]
    together: bool = True
    needs_goal = True

    def begin(self, setting: Setting) -> None:
        clients = [PlannerClient() for _ in self.goals] if self.together else [PlannerClient()]
        asked = [
            (ProgramAsker(clients[number % len(clients)]), goal or setting.goal)
            for number, goal in enumerate(self.goals)
        ]
        setting.others.append(_Crowd(clients, [asker for asker, _ in asked]))
        if self.together:
            for asker, goal in asked:
                asker.start(goal)
            return

        def one_after_the_other() -> None:
            for asker, goal in asked:
                asker.start(goal)
                while asker.answer() is None and not asker.closed:
                    time.sleep(0.05)

        threading.Thread(target=one_after_the_other, daemon=True).start()

    def end(self, setting: Setting) -> None:
        setting.stop_others()


class CrowdHungError(RuntimeError):
    """One of those who asked besides gets no answer."""


class _Crowd:
    """Those who asked besides; leaving waits for their answers."""

    def __init__(self, clients: list[PlannerClient], askers: list[ProgramAsker]) -> None:
        self._clients, self._askers = clients, askers

    def __exit__(self, *_error: object) -> None:
        deadline = time.monotonic() + PATIENCE
        waiting = list(self._askers)
        while waiting and time.monotonic() < deadline:
            waiting = [asker for asker in waiting if asker.answer() is None]
            time.sleep(0.05)
        for asker in self._askers:
            asker.close()
        for client in self._clients:
            client.close()
        if waiting:
            raise CrowdHungError(
                f"{len(waiting)} of {len(self._askers)} further clients got no answer within "
                f"{PATIENCE:g} s"
            )


# The world


@dataclass(frozen=True)
class Rearranged(Once):
    """``sim/reset`` puts the blocks elsewhere, and the arm home.

    Args:
        layout: makes the new one of the one at the beginning and the trial's seed.
    """

    layout: Callable[[Stacks, int], Stacks]

    def begin(self, setting: Setting) -> None:
        try:
            setting.eyes.reset(self.layout(setting.initial, setting.seed))
        except SimulationError as error:
            raise RuntimeError(f"the world could not be changed: {error}") from error
