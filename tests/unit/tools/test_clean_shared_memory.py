# SPDX-License-Identifier: Apache-2.0
"""Shared memory of dead participants goes; that of the living, of ports and of others stays."""

from __future__ import annotations

import fcntl
import os
import subprocess
import time
from pathlib import Path

ROOT = Path(__file__).parents[3]
_TOOL = ROOT / "tools" / "clean_shared_memory"
_AN_HOUR = 3600.0


def leave(folder: Path, name: str, age: float = _AN_HOUR) -> set[str]:
    """The two files of a participant, and their names."""
    names = {name, f"{name}_el"}
    for item in names:
        (folder / item).write_bytes(b"x")
        os.utime(folder / item, times=(time.time() - age,) * 2)
    return names


def test_fault_15_only_the_memory_of_the_dead_is_removed(tmp_path: Path) -> None:
    leave(tmp_path, "fastrtps_0123456789abcdef")
    kept = leave(tmp_path, "fastrtps_living") | leave(tmp_path, "fastrtps_port7410")
    kept |= leave(tmp_path, "fastrtps_young", age=0.0) | leave(tmp_path, "somebody_else")
    with (tmp_path / "fastrtps_living_el").open() as lock:
        fcntl.flock(lock, fcntl.LOCK_EX)
        subprocess.run([_TOOL, tmp_path], check=True)
    assert {path.name for path in tmp_path.iterdir()} == kept


def test_fault_15_ci_removes_nothing_else_that_is_shared() -> None:
    script = (ROOT / ".ci" / "run").read_text()
    assert "tools/clean_shared_memory" in script
    assert "rm " not in script
