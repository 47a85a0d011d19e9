# SPDX-License-Identifier: Apache-2.0
"""Those who ask for a goal and wait for the answer: a program, or a person at the command line."""

from __future__ import annotations

import os
import signal
import subprocess
import threading
import time
from contextlib import suppress
from dataclasses import dataclass
from pathlib import Path
from typing import Final, Protocol

from tamp_interfaces.action import AchieveGoal
from tamp_interfaces.msg import MotionStatus
from tamp_runtime.messages.stamps import nanoseconds

from planner_node.cli.client import PlannerClient
from planner_node.cli.unavailable import PlannerUnavailableError

CLAIMS: Final = ("SUCCESS", "ALREADY_TRUE")
#: What the client says without an answer of the planner.
UNAVAILABLE: Final = "UNAVAILABLE"
_STATUSES: Final = {
    getattr(AchieveGoal.Result, name): name
    for name in dir(AchieveGoal.Result)
    if name.isupper() and isinstance(getattr(AchieveGoal.Result, name), int)
}
_ARMS: Final = {
    MotionStatus.ARM_UNKNOWN: "unknown",
    MotionStatus.ARM_HOME: "home",
    MotionStatus.ARM_RESTING: "resting",
    MotionStatus.ARM_MOVING: "moving",
}


@dataclass(frozen=True)
class Answer:
    """What the one who asked was told.

    Attributes:
        status: the name of a constant of AchieveGoal; UNAVAILABLE where the client itself says
            that no answer comes; EXIT_n for a program that ended with the exit code n.
        causes: why plans were given up, in order.
        arm, held: what the answer says of the arm: home, resting, moving or unknown.
        seen: when the last picture was taken that the answer rests on [ns]; 0: not known.
    """

    status: str
    message: str
    causes: tuple[str, ...] = ()
    arm: str = "unknown"
    held: str = ""
    seen: int = 0
    moves: int = 0
    replans: int = 0

    @property
    def claimed(self) -> bool:
        """Whether the goal is said to hold."""
        return self.status in CLAIMS

    @property
    def sentence(self) -> str:
        """All that is said in words."""
        return " | ".join((self.message, *self.causes))


class Asker(Protocol):
    """Somebody who asks once."""

    def start(self, goal: str) -> None:
        """Sends the request; returns at once."""

    def answer(self) -> Answer | None:
        """The answer as soon as it is there."""

    def cancel(self) -> None:
        """Asks to stop; returns at once."""

    def close(self) -> None:
        """Waits for nothing any more."""


class ProgramAsker:
    """Asks by PlannerClient.

    Args:
        patience: for how long it asks again while the planner is busy or not there [s].
    """

    def __init__(self, planner: PlannerClient, patience: float = 0.0) -> None:
        self._planner, self._patience = planner, patience
        self._answer: Answer | None = None
        self._closed = threading.Event()
        self._cancelled = threading.Event()
        self._thread: threading.Thread | None = None

    def start(self, goal: str) -> None:
        """See :class:`Asker`."""
        self._thread = threading.Thread(target=self._run, args=[goal], name="asker", daemon=True)
        self._thread.start()

    def answer(self) -> Answer | None:
        """See :class:`Asker`."""
        return self._answer

    def cancel(self) -> None:
        """See :class:`Asker`."""
        self._cancelled.set()

    def close(self) -> None:
        """See :class:`Asker`."""
        self._closed.set()
        if self._thread:
            self._thread.join(15.0)

    @property
    def closed(self) -> bool:
        """Whether nobody waits for the answer any more."""
        return self._closed.is_set()

    def _run(self, goal: str) -> None:
        deadline = time.monotonic() + self._patience
        while True:
            answer = self._ask(goal)
            waits = answer is not None and answer.status in ("BUSY", UNAVAILABLE)
            if not waits or time.monotonic() > deadline or self._closed.wait(0.5):
                break
        self._answer = answer

    def _ask(self, goal: str) -> Answer | None:
        planner = self._planner
        try:
            planner.start(goal)
            told = False
            while not planner.is_done():
                if self._closed.wait(0.02):
                    return None
                if self._cancelled.is_set() and not told:
                    told = True
                    planner.cancel(timeout=10.0)
            return answer_from_result(planner.result(timeout=5.0))
        except (PlannerUnavailableError, TimeoutError) as error:
            return Answer(UNAVAILABLE, str(error))


class CommandAsker:
    """Asks by ``ros2 run planner_node achieve_goal``.

    Args:
        log: receives what it prints.
    """

    def __init__(self, log: Path) -> None:
        self._log = log
        self._process: subprocess.Popen[bytes] | None = None

    def start(self, goal: str) -> None:
        """See :class:`Asker`."""
        with self._log.open("wb") as log:
            self._process = subprocess.Popen(
                ["ros2", "run", "planner_node", "achieve_goal", goal],
                stdin=subprocess.DEVNULL,
                stdout=log,
                stderr=subprocess.STDOUT,
                start_new_session=True,
                preexec_fn=_heed_interrupts,
            )

    def answer(self) -> Answer | None:
        """See :class:`Asker`."""
        code = self._process.poll() if self._process else None
        if code is None:
            return None
        lines = [line for line in self._log.read_text(errors="replace").splitlines() if line]
        status = {0: "SUCCESS", 130: "CANCELLED"}.get(code, f"EXIT_{code}")
        return Answer(status, " / ".join(lines[-4:]))

    def cancel(self) -> None:
        """See :class:`Asker`."""
        self.signal(signal.SIGINT)

    def close(self) -> None:
        """See :class:`Asker`."""
        self.signal(signal.SIGKILL)
        if self._process:
            self._process.wait(10.0)

    def signal(self, number: signal.Signals) -> None:
        """Sends a signal to the program."""
        if self._process and self._process.poll() is None:
            with suppress(ProcessLookupError):
                os.killpg(self._process.pid, number)


def answer_from_result(result: AchieveGoal.Result) -> Answer:
    """What the planner answered."""
    return Answer(
        _STATUSES.get(result.status, f"STATUS_{result.status}"),
        result.message,
        tuple(result.causes),
        _ARMS.get(result.motion.arm, "unknown"),
        result.motion.held,
        nanoseconds(result.final.header.stamp),
        result.moves_executed,
        result.replans,
    )


def _heed_interrupts() -> None:
    signal.signal(signal.SIGINT, signal.SIG_DFL)
