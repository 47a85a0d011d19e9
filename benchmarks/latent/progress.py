# SPDX-License-Identifier: Apache-2.0
"""A progress bar of a training that Ctrl-C ends after a whole step, with a log beside it."""

from __future__ import annotations

import signal
from collections.abc import Iterator, Mapping
from contextlib import contextmanager
from pathlib import Path
from typing import Final

from tqdm import tqdm

_EVERY: Final = 50


class Progress:
    """Shows and logs the losses of steps; ``stopped`` once Ctrl-C was pressed."""

    def __init__(self, bar: tqdm, log: Path) -> None:
        self.stopped = False
        self._bar, self._log = bar, log

    def show(self, step: int, losses: Mapping[str, float]) -> bool:
        """To be called after each step; whether to go on."""
        self._bar.update(step - self._bar.n)
        if step % _EVERY == 0:
            text = "  ".join(f"{name} {value:.5f}" for name, value in losses.items())
            self._bar.set_postfix_str(text, refresh=False)
            with self._log.open("a") as file:
                file.write(f"{step}  {text}\n")
        return not self.stopped


@contextmanager
def progress(title: str, steps: int, done: int, log: Path) -> Iterator[Progress]:
    """Until the training of some steps ends; SIGINT is kept from everything else meanwhile."""
    log.parent.mkdir(parents=True, exist_ok=True)
    with tqdm(total=steps, initial=done, desc=title, unit="step", mininterval=2.0) as bar:
        shown = Progress(bar, log)

        def stop(_signal: int, _frame: object) -> None:
            shown.stopped = True

        previous = signal.signal(signal.SIGINT, stop)
        try:
            yield shown
        finally:
            signal.signal(signal.SIGINT, previous)
