# SPDX-License-Identifier: Apache-2.0
"""A process that is told so keeps the memory that it frees: the kernel gives it no pages anew."""

from __future__ import annotations

import ctypes
import subprocess
import sys

import pytest

#: Twenty times the arrays of a picture, let go of together; prints how many pages were new.
PICTURES = """
import resource, sys
from tamp_runtime.memory import keep_freed_memory
if sys.argv[1] == "kept":
    keep_freed_memory()
blocks = [bytearray(2_000_000) for _ in range(10)]
del blocks
before = resource.getrusage(resource.RUSAGE_SELF).ru_minflt
for _ in range(20):
    blocks = [bytes(2_000_000 + n) + b"x" for n in range(10)]
    del blocks
print(resource.getrusage(resource.RUSAGE_SELF).ru_minflt - before)
"""


def new_pages(how: str) -> int:
    command = [sys.executable, "-c", PICTURES, how]
    return int(subprocess.run(command, capture_output=True, text=True, check=True).stdout)


@pytest.mark.skipif(not hasattr(ctypes.CDLL(None), "mallopt"), reason="no glibc")
def test_what_is_freed_is_used_again() -> None:
    assert 4 * new_pages("kept") < new_pages("not")
