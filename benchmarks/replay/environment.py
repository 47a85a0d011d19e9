# SPDX-License-Identifier: Apache-2.0
"""MuJoCo for this benchmark alone: in a folder of its own, which only its process looks into."""

from __future__ import annotations

import hashlib
import importlib.util
import os
import shutil
import subprocess
import sys
import tempfile
from pathlib import Path
from typing import Final

LOCK: Final = Path(__file__).resolve().parent.parent / "requirements-replay.lock"
#: Beside the product's packages, so that ``make clean`` and a new lock remove it with them.
FOLDER: Final = Path(sys.prefix) / "replay"


class EnvironmentProblem(RuntimeError):
    """MuJoCo cannot be had; the sentence says what to do."""


def provide_mujoco(folder: Path = FOLDER, lock: Path = LOCK) -> None:
    """Makes ``import mujoco`` work in this process, and installs it first where it is absent.

    What the product itself has, such as NumPy, is taken from there: the lock leaves it out.

    Raises:
        EnvironmentProblem: it cannot be installed.
    """
    wanted = hashlib.sha256(lock.read_bytes()).hexdigest()
    stamp = folder / ".stamp"
    if not stamp.is_file() or stamp.read_text() != wanted:
        print("replay: installing MuJoCo beside the environment (90 MB) …", file=sys.stderr)
        _install(folder, lock, wanted)
    if str(folder) not in sys.path:
        sys.path.append(str(folder))
    if importlib.util.find_spec("mujoco") is None:
        raise EnvironmentProblem(f"{folder} has no mujoco; remove that folder and try again")


def _install(folder: Path, lock: Path, stamp: str) -> None:
    """All or nothing: an interrupted installation is not taken for one."""
    folder.parent.mkdir(parents=True, exist_ok=True)
    part = Path(tempfile.mkdtemp(prefix=f"{folder.name}.", dir=folder.parent))
    uv = Path(sys.executable).parent / "uv"
    try:
        done = subprocess.run(
            [str(uv), "pip", "install", "--quiet", "--python", sys.executable, "--target",
             str(part), "--require-hashes", "--no-deps", "--requirements", str(lock)],
            env={**os.environ, "UV_PYTHON_DOWNLOADS": "never"},
            capture_output=True, text=True, check=False,
        )  # fmt: skip
        if done.returncode:
            tail = " ".join(done.stderr.split())[-400:]
            raise EnvironmentProblem(
                f"MuJoCo could not be installed; is the package index reachable? uv says: {tail}"
            )
        (part / ".stamp").write_text(stamp)
        shutil.rmtree(folder, ignore_errors=True)
        part.rename(folder)
    except OSError as error:
        raise EnvironmentProblem(f"MuJoCo could not be installed: {error}") from error
    finally:
        shutil.rmtree(part, ignore_errors=True)
