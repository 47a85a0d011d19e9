# SPDX-License-Identifier: Apache-2.0
"""Functions of casadi, and C of this package, as machine code.

What was compiled is kept in ``~/.cache/motion_node`` (or below ``XDG_CACHE_HOME``) by its content.
Where there is no compiler, or no place to keep anything, functions of casadi stay as they are, at
four times the time, and what has C has a slower way in Python beside it.
"""

from __future__ import annotations

import contextlib
import ctypes
import hashlib
import os
import shutil
import subprocess
import tempfile
from collections.abc import Sequence
from functools import cache
from pathlib import Path
from typing import Final

import casadi as ca

#: Of generated code: more takes twice as long to compile and is not faster.
GENERATED: Final = ("-O1",)
#: Of what is written by hand; for any processor of this kind, as the folder may be shared.
WRITTEN: Final = ("-O3", "-fopenmp-simd", "-fno-math-errno", "-fno-trapping-math")
#: Of both.
FLAGS: Final = ("-fPIC", "-shared")
#: A compiler that takes longer hangs [s].
TIMEOUT: Final = 60.0


def machine_code(function: ca.Function) -> Path | None:
    """The library that has a function of casadi under its name; None where there can be none."""
    generator = ca.CodeGenerator(f"{function.name()}.c")
    generator.add(function)
    name, source = f"{function.name()}.c", generator.dump()
    return _library({name: source}, (ca.CasadiMeta.version(), *GENERATED))


def loaded(function: ca.Function, library: Path | None) -> ca.Function:
    """The same function, from a library if that can be."""
    if library is not None:
        with contextlib.suppress(RuntimeError):
            return ca.external(function.name(), str(library))
    return function


@cache
def written(*files: Path) -> ctypes.CDLL | None:
    """C files, of which the first includes the others; None where they cannot be compiled."""
    library = _library({file.name: file.read_text() for file in files}, WRITTEN)
    return opened(library)


def opened(library: Path | None) -> ctypes.CDLL | None:
    """A library to call without casadi; None where that cannot be."""
    if library is not None:
        with contextlib.suppress(OSError):
            return ctypes.CDLL(str(library))
    return None


def _library(sources: dict[str, str], flags: Sequence[str]) -> Path | None:
    compiler = shutil.which("cc") or shutil.which("gcc")
    if compiler is None:
        return None
    content = "\n".join([*flags, *FLAGS, *sources.values()])
    name = next(iter(sources))
    digest = hashlib.sha256(content.encode()).hexdigest()
    library = _folder() / f"{Path(name).stem}_{digest[:32]}.so"
    with contextlib.suppress(OSError, subprocess.SubprocessError):
        if not library.exists():
            _compile(compiler, sources, [flag for flag in flags if flag.startswith("-")], library)
        return library
    return None


def _folder() -> Path:
    cache = os.environ.get("XDG_CACHE_HOME")
    return (Path(cache) if cache else Path.home() / ".cache") / "motion_node"


def _compile(compiler: str, sources: dict[str, str], flags: Sequence[str], library: Path) -> None:
    """Makes the library, which appears when it is whole: others may make it at the same time."""
    library.parent.mkdir(mode=0o700, parents=True, exist_ok=True)
    with tempfile.TemporaryDirectory(dir=library.parent) as folder:
        for name, source in sources.items():
            (Path(folder) / name).write_text(source)
        code, made = Path(folder) / next(iter(sources)), Path(folder) / "made.so"
        subprocess.run(
            [compiler, *flags, *FLAGS, str(code), "-o", str(made), "-lm"],
            check=True,
            capture_output=True,
            timeout=TIMEOUT,
        )
        made.rename(library)
