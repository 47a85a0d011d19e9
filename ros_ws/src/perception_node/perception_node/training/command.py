# SPDX-License-Identifier: Apache-2.0
"""What the commands that train have in common: options, the bar, Ctrl-C, how weights came about."""

from __future__ import annotations

import argparse
import shutil
import signal
import subprocess
from collections.abc import Mapping, Sequence
from datetime import date
from pathlib import Path
from typing import Any, Final

import torch
from tqdm import tqdm

from .run import TrainingRun

CHECKPOINT: Final = "checkpoint.pt"


def parse_options(
    arguments: Sequence[str] | None,
    name: str,
    description: str,
    folders: tuple[str, str],
    settings: Mapping[str, Any],
    choices: Mapping[str, Sequence[str]] | None = None,
) -> argparse.Namespace:
    """The options of a command: its folders, and a flag for every setting.

    Args:
        name: of the command.
        folders: of the data, and of the run.
        settings: names and defaults.
        choices: of the settings that have some.
    """
    parser = argparse.ArgumentParser(
        prog=name,
        description=description,
        formatter_class=argparse.ArgumentDefaultsHelpFormatter,
    )
    data, run = map(Path, folders)
    parser.add_argument("--data", type=Path, default=data, help="folder of shards")
    parser.add_argument("--run", type=Path, default=run, help="folder to write")
    parser.add_argument("--threads", type=int, default=2, help="processor threads")
    parser.add_argument(
        "--install", action="store_true", help="make the result the package's default weights"
    )
    for setting, default in settings.items():
        flag = f"--{setting.replace('_', '-')}"
        if isinstance(default, bool):
            action = argparse.BooleanOptionalAction
            parser.add_argument(flag, action=action, default=default, help=setting)
        else:
            some = (choices or {}).get(setting)
            parser.add_argument(
                flag, type=type(default), default=default, choices=some, help=setting
            )
    return parser.parse_args(arguments)


def go_on(trainer: TrainingRun[float], checkpoint: Path) -> None:
    """Takes up what was trained before, if anything was."""
    if checkpoint.exists():
        trainer.resume(checkpoint)
        print(f"going on from step {trainer.step} of {trainer.steps} ({checkpoint})")


def install(weights: Path, default: Path) -> None:
    """Makes weights the package's own."""
    shutil.copyfile(weights, default)
    print(f"installed as the package's default: {default}")


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
        elif value != "":
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
