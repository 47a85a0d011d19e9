# SPDX-License-Identifier: Apache-2.0
"""The environment holds what is used, and nothing of CUDA that PyTorch can be imported without."""

from __future__ import annotations

import os
import re
import subprocess
import sys
from importlib.metadata import distributions
from pathlib import Path

ROOT = Path(__file__).parents[3]
_SETUP = ROOT / "tools" / "setup"


def _names(text: str) -> set[str]:
    """The names that the lines of a requirements file start with."""
    return set(re.findall(r"^([a-z][\w-]*)", text, re.M))


def test_fault_16_what_is_left_out_of_the_lock_stays_out() -> None:
    overrides = (ROOT / "requirements-overrides.txt").read_text()
    left_out = _names("\n".join(re.findall(r'^.*python_version < "0"$', overrides, re.M)))
    assert "triton" in left_out
    assert not left_out & _names((ROOT / "requirements.lock").read_text())
    assert not left_out & {found.metadata["Name"] for found in distributions()}


def test_fault_16_torch_loads_something_of_every_cuda_package_that_is_installed() -> None:
    maps = subprocess.run(
        [sys.executable, "-c", "import torch; print(open('/proc/self/maps').read())"],
        capture_output=True,
        text=True,
        check=True,
    ).stdout
    loaded = {line.split()[-1].rsplit("/", 1)[-1] for line in maps.splitlines() if "/" in line}
    unused = {
        found.metadata["Name"]
        for found in distributions()
        if found.metadata["Name"].startswith("nvidia-")
        and not loaded & {path.name for path in found.files or ()}
    }
    assert not unused


def test_an_unknown_source_of_torch_is_refused_before_anything_is_touched() -> None:
    result = subprocess.run(
        [_SETUP, sys.executable],
        env=os.environ | {"TORCH_BACKEND": "gpu"},
        capture_output=True,
        text=True,
        check=False,
    )
    assert result.returncode == 1
    assert result.stderr.count("\n") == 1
    assert "TORCH_BACKEND=gpu is not known; cpu takes" in result.stderr
