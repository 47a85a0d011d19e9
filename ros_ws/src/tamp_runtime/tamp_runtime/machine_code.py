# SPDX-License-Identifier: Apache-2.0
"""C as machine code, compiled where it runs.

What was compiled is kept in ``~/.cache/tamp_runtime`` (or below ``XDG_CACHE_HOME``) by its content.
Where there is no compiler, or no place to keep anything, there is no library, and what has C has a
slower way in Python beside it.
"""

from __future__ import annotations

import atexit
import contextlib
import ctypes
import hashlib
import os
import shutil
import subprocess
import tempfile
import threading
from collections.abc import Callable, Iterator, Sequence
from functools import cache
from pathlib import Path
from typing import Any, Final

from numpy.typing import NDArray

#: Of what is written by hand; for any processor of this kind, as the folder may be shared.
WRITTEN: Final = ("-O3", "-fopenmp-simd", "-fno-math-errno", "-fno-trapping-math")
#: Of all code.
FLAGS: Final = ("-fPIC", "-shared")
#: Of what can be written to.
_first_byte: Final[Callable[[Any], ctypes.c_char]] = ctypes.c_char.from_buffer
#: A compiler that takes longer hangs [s].
TIMEOUT: Final = 60.0


class _Compilers:
    """Compilers that run; a process that ends takes them with it."""

    def __init__(self) -> None:
        self._lock, self._ended = threading.Lock(), False
        self._all: set[subprocess.Popen[bytes]] = set()
        atexit.register(self._end)

    @contextlib.contextmanager
    def started(self, command: Sequence[str]) -> Iterator[subprocess.Popen[bytes]]:
        """Starts one, which does not outlive the block."""
        silent = subprocess.DEVNULL
        with self._lock:
            if self._ended:
                raise subprocess.SubprocessError("this process ends")
            running = subprocess.Popen(command, stdout=silent, stderr=silent)
            self._all.add(running)
        try:
            with running:
                try:
                    yield running
                finally:
                    running.kill()
        finally:
            with self._lock:
                self._all.discard(running)

    def _end(self) -> None:
        with self._lock:
            self._ended = True
            for running in self._all:
                running.kill()


_RUNNING: Final = _Compilers()


@cache
def written(*files: Path) -> ctypes.CDLL | None:
    """C files, of which the first includes the others; None where they cannot be compiled."""
    library = compiled({file.name: file.read_text() for file in files}, WRITTEN)
    return opened(library)


def written_below(folder: Path) -> None:
    """Compiles every C file below a folder, none of which includes another: before it is needed."""
    for file in sorted(folder.rglob("*.c")):
        written(file)


def address(array: NDArray[Any]) -> Any:
    """Where the values of an array begin, for C; the array lives as long as this does."""
    # What ``array.ctypes.data_as`` does, in a tenth of the time.
    try:
        return ctypes.byref(_first_byte(array))
    except (TypeError, ValueError):  # nobody may write to it, or it has gaps or no values
        pointer: Any = ctypes.c_void_p(array.ctypes.data)
        pointer.array = array
        return pointer


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
    found, library = compiler(), place(sources, flags)
    if found is None:
        return None
    with contextlib.suppress(OSError, subprocess.SubprocessError):
        if not library.exists():
            _compile(found, sources, [flag for flag in flags if flag.startswith("-")], library)
        return library
    return None


def compiler() -> str | None:
    """The C compiler of this machine."""
    return shutil.which("cc") or shutil.which("gcc")


def place(sources: dict[str, str], flags: Sequence[str]) -> Path:
    """Where the library of C texts is once they have been compiled, see :func:`compiled`."""
    content = "\n".join([*flags, *FLAGS, *sources.values()])
    digest = hashlib.sha256(content.encode()).hexdigest()
    cached = os.environ.get("XDG_CACHE_HOME")
    folder = (Path(cached) if cached else Path.home() / ".cache") / "tamp_runtime"
    return folder / f"{Path(next(iter(sources))).stem}_{digest[:32]}.so"


def _compile(compiler: str, sources: dict[str, str], flags: Sequence[str], library: Path) -> None:
    """Makes the library, which appears when it is whole: others may make it at the same time."""
    library.parent.mkdir(mode=0o700, parents=True, exist_ok=True)
    with tempfile.TemporaryDirectory(dir=library.parent) as folder:
        for name, source in sources.items():
            (Path(folder) / name).write_text(source)
        code, made = Path(folder) / next(iter(sources)), Path(folder) / "made.so"
        command = [compiler, *flags, *FLAGS, str(code), "-o", str(made), "-lm"]
        with _RUNNING.started(command) as running:
            if running.wait(TIMEOUT) != 0:
                raise subprocess.CalledProcessError(running.returncode, command)
        made.rename(library)
