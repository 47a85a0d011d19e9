# SPDX-License-Identifier: Apache-2.0
"""What the commands that train have in common: the bar, Ctrl-C, and how weights came about."""

from __future__ import annotations

import signal
import subprocess
from collections.abc import Mapping
from datetime import date
from pathlib import Path
from typing import Any

import torch
from tqdm import tqdm

from .run import TrainingRun


def train_to_the_end(trainer: TrainingRun[float], checkpoint: Path) -> bool:
    """Trains with a progress bar; whether all steps are done. Ctrl-C ends it after a whole step."""
    average, stopped = 0.0, False

    def stop(_signal: int, _frame: object) -> None:
        nonlocal stopped
        stopped = True

    def show(step: int, loss: float) -> bool:
        nonlocal average
        average = loss if average == 0.0 else 0.98 * average + 0.02 * loss
        progress.update(step - progress.n)
        progress.set_postfix(loss=f"{average:.4f}", refresh=False)
        return not stopped

    previous = signal.signal(signal.SIGINT, stop)
    try:
        with tqdm(total=trainer.steps, initial=trainer.step, unit="step") as progress:
            return trainer.run(show, checkpoint)
    finally:
        signal.signal(signal.SIGINT, previous)


def how_trained(
    command: str, settings: Mapping[str, Any], trainer: TrainingRun[float]
) -> dict[str, str]:
    """How weights came about, for a file's header.

    Args:
        command: without its settings.
    """
    flags = []
    for name, value in settings.items():
        flag = name.replace("_", "-")
        if isinstance(value, bool):
            flags.append(f"--{flag}" if value else f"--no-{flag}")
        else:
            flags.append(f"--{flag} {value}")
    try:
        commit = subprocess.run(
            ["git", "rev-parse", "--short", "HEAD"], capture_output=True, text=True, check=True
        ).stdout.strip()
    except (OSError, subprocess.CalledProcessError):
        commit = "unknown"
    return {
        "command": f"{command} {' '.join(flags)}",
        "commit": commit,
        "date": date.today().isoformat(),
        "training_seconds": f"{trainer.seconds:.0f}",
        "torch": str(torch.__version__),
    }
