# SPDX-License-Identifier: Apache-2.0
"""Functions of casadi as machine code, which takes a quarter of the time of its interpreter.

What was compiled is kept in ``~/.cache/motion_node`` (or below ``XDG_CACHE_HOME``) by its content.
Where there is no compiler, or no place to keep anything, functions stay as they are.
"""

from __future__ import annotations

import contextlib
import hashlib
import os
import shutil
import subprocess
import tempfile
from pathlib import Path
from typing import Final

import casadi as ca

#: More takes twice as long to compile and is not faster.
FLAGS: Final = ("-O1", "-fPIC", "-shared")
#: A compiler that takes longer hangs [s].
TIMEOUT: Final = 60.0
#: With fewer numbers in its results a function is quick enough.
SMALL: Final = 300


def compiled(function: ca.Function) -> ca.Function:
    """The same function, compiled if that is worth it and can be done."""
    compiler = shutil.which("cc") or shutil.which("gcc")
    if compiler is None or function.nnz_out() < SMALL:
        return function
    generator = ca.CodeGenerator(f"{function.name()}.c")
    generator.add(function)
    source = generator.dump()
    digest = hashlib.sha256(
        "\n".join([ca.CasadiMeta.version(), *FLAGS, source]).encode()
    ).hexdigest()
    library = _folder() / f"{function.name()}_{digest[:32]}.so"
    with contextlib.suppress(OSError, subprocess.SubprocessError, RuntimeError):
        if not library.exists():
            _compile(compiler, source, library)
        return ca.external(function.name(), str(library))
    return function


def _folder() -> Path:
    cache = os.environ.get("XDG_CACHE_HOME")
    return (Path(cache) if cache else Path.home() / ".cache") / "motion_node"


def _compile(compiler: str, source: str, library: Path) -> None:
    """Makes the library, which appears when it is whole: others may make it at the same time."""
    library.parent.mkdir(mode=0o700, parents=True, exist_ok=True)
    with tempfile.TemporaryDirectory(dir=library.parent) as folder:
        code, made = Path(folder) / "function.c", Path(folder) / "function.so"
        code.write_text(source)
        subprocess.run(
            [compiler, *FLAGS, str(code), "-o", str(made), "-lm"],
            check=True,
            capture_output=True,
            timeout=TIMEOUT,
        )
        made.rename(library)
