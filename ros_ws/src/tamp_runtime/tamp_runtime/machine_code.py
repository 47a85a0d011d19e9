# SPDX-License-Identifier: Apache-2.0
"""C as machine code, compiled where it runs.

What was compiled is kept in ``~/.cache/tamp_runtime`` (or below ``XDG_CACHE_HOME``) by its content.
Where there is no compiler, or no place to keep anything, there is no library, and what has C has a
slower way in Python beside it.
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

#: Of what is written by hand; for any processor of this kind, as the folder may be shared.
WRITTEN: Final = ("-O3", "-fopenmp-simd", "-fno-math-errno", "-fno-trapping-math")
#: Of all code.
FLAGS: Final = ("-fPIC", "-shared")
#: A compiler that takes longer hangs [s].
TIMEOUT: Final = 60.0


@cache
def written(*files: Path) -> ctypes.CDLL | None:
    """C files, of which the first includes the others; None where they cannot be compiled."""
    library = compiled({file.name: file.read_text() for file in files}, WRITTEN)
    return opened(library)


def opened(library: Path | None) -> ctypes.CDLL | None:
    """A library to call without casadi; None where that cannot be."""
    if library is not None:
        with contextlib.suppress(OSError):
            return ctypes.CDLL(str(library))
    return None


def compiled(sources: dict[str, str], flags: Sequence[str]) -> Path | None:
    """The library of C texts by name, of which the first includes the others.

    Args:
        flags: of the compiler; what does not begin with a dash only tells libraries apart.
    """
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
    return (Path(cache) if cache else Path.home() / ".cache") / "tamp_runtime"


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
