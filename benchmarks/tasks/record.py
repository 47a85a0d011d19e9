# SPDX-License-Identifier: Apache-2.0
"""Records: each task's own file, there from when it begins; so nothing is ever run a second time.

A file is written whole or not at all, and its being there says that the task has begun:

- no file: the task has not begun, and may be run;
- ``begun``: it runs, or whoever ran it was killed meanwhile;
- ``ended``: there is a result;
- ``interrupted``: the operator stopped it while it ran.

What was interrupted counts as failed. To leave it out, or to run it again, would let whoever
watches a campaign throw away the tasks that take suspiciously long. That a task has not begun is
proven by there being no file, since the file is written before anything of the task is done.
"""

from __future__ import annotations

import contextlib
import fcntl
import json
import os
from collections.abc import Iterable, Iterator, Mapping
from enum import Enum
from pathlib import Path
from typing import Any, Final

#: The module and the reason of a task that was stopped while it ran.
OPERATOR: Final = "operator"
INTERRUPTED: Final = "interrupted by the operator"

Content = Mapping[str, Any]


class State(str, Enum):
    """How far a task is."""

    BEGUN = "begun"
    ENDED = "ended"
    INTERRUPTED = "interrupted"


class AlreadyBegunError(RuntimeError):
    """A task has a record; it is not run again."""


class CampaignRunsError(RuntimeError):
    """Another process runs this campaign now."""


class Records:
    """The records of one campaign: ``SEED.json``, and ``SEED/`` for what belongs to a task.

    Args:
        folder: of the campaign; made if it is not there.
    """

    def __init__(self, folder: Path) -> None:
        self.folder = folder
        self.folder.mkdir(parents=True, exist_ok=True)

    def path(self, seed: int) -> Path:
        """The record of a task."""
        return self.folder / f"{seed}.json"

    def kept(self, seed: int) -> Path:
        """The folder of what is needed to run a task again, and to see what happened."""
        return self.folder / str(seed)

    @contextlib.contextmanager
    def lock(self) -> Iterator[int]:
        """Holds the campaign for this process and those that inherit the file descriptor.

        The kernel frees it when the last of them is gone, however they end.

        Raises:
            CampaignRunsError: somebody else holds it.
        """
        descriptor = os.open(self.folder / "lock", os.O_RDWR | os.O_CREAT)
        try:
            try:
                fcntl.flock(descriptor, fcntl.LOCK_EX | fcntl.LOCK_NB)
            except BlockingIOError:
                raise CampaignRunsError(
                    f"another process runs the campaign in {self.folder}; wait for its end, or "
                    "stop it"
                ) from None
            yield descriptor
        finally:
            os.close(descriptor)

    def has_begun(self, seed: int) -> bool:
        """Whether a task has a record."""
        return self.path(seed).exists()

    def begin(self, seed: int, content: Content) -> None:
        """Writes down that a task begins now, before anything of it is done.

        Raises:
            AlreadyBegunError: it has begun before, here or in another process.
        """
        new = self._write_new(seed, {**content, "seed": seed, "state": State.BEGUN.value})
        try:
            os.link(new, self.path(seed))  # fails where a file is, unlike a rename
        except FileExistsError:
            raise AlreadyBegunError(f"task {seed} has begun already: {self.path(seed)}") from None
        finally:
            new.unlink()

    def end(self, seed: int, result: Content, state: State = State.ENDED) -> None:
        """Adds a result to the record of a task that has begun."""
        content = {**self.read(seed), **result, "state": state.value}
        self._write_new(seed, content).replace(self.path(seed))

    def interrupt(self, seed: int) -> None:
        """The operator stops a task that runs; it counts as failed."""
        failure = {"module": OPERATOR, "reason": INTERRUPTED}
        self.end(seed, {"success": False, "failure": failure}, State.INTERRUPTED)

    def interrupt_all_begun(self) -> list[int]:
        """Closes the records of tasks whose process was killed; only who holds the lock may.

        Returns:
            Their seeds.
        """
        found = [seed for seed in self.seeds() if self.state(seed) is State.BEGUN]
        for seed in found:
            self.interrupt(seed)
        return found

    def seeds(self) -> list[int]:
        """Those of the tasks that have begun."""
        return sorted(int(path.stem) for path in self.folder.glob("*.json") if path.stem.isdigit())

    def state(self, seed: int) -> State:
        """How far a task that has begun is."""
        return State(self.read(seed).get("state", State.ENDED.value))

    def read(self, seed: int) -> dict[str, Any]:
        """What is written down of a task."""
        content: dict[str, Any] = json.loads(self.path(seed).read_text())
        return content

    def forget(self) -> None:
        """Removes all records; what belongs to single tasks is overwritten when they are run."""
        for path in self.folder.glob("*.json"):
            path.unlink()

    def _write_new(self, seed: int, content: Content) -> Path:
        """The content in a file beside the record, safe on the disk."""
        path = self.folder / f".{seed}.{os.getpid()}"
        with path.open("w") as file:
            file.write(json.dumps(content, indent=1, ensure_ascii=False))
            file.flush()
            os.fsync(file.fileno())
        return path


class Tally:
    """How many tasks have ended and succeeded; reads each record only once."""

    def __init__(self, records: Records) -> None:
        self._records = records
        self._known: dict[int, bool] = {}

    def count(self, seeds: Iterable[int]) -> tuple[int, int]:
        """Successes, and tasks that have ended, whoever ran them."""
        for seed in seeds:
            if seed in self._known or not self._records.has_begun(seed):
                continue
            content = self._records.read(seed)
            if content.get("state") != State.BEGUN.value:
                self._known[seed] = bool(content["success"])
        return sum(self._known.values()), len(self._known)
