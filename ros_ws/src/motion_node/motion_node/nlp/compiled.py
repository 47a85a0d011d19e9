# SPDX-License-Identifier: Apache-2.0
"""Functions of casadi, and C of this package, as machine code.

What was compiled is kept in ``~/.cache/motion_node`` (or below ``XDG_CACHE_HOME``) by its content.
Where there is no compiler, or no place to keep anything, functions of casadi stay as they are, at
four times the time, and what has C has a slower way in Python beside it. So it is with large ones
until their machine code has come: nobody waits for a compiler.
"""

from __future__ import annotations

import atexit
import contextlib
import ctypes
import hashlib
import os
import queue
import shutil
import subprocess
import tempfile
import threading
from collections.abc import Iterator, Sequence
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
            self._all.discard(running)

    def _end(self) -> None:
        with self._lock:
            self._ended = True
            for running in self._all:
                running.kill()


_RUNNING: Final = _Compilers()


def machine_code(function: ca.Function) -> Path | None:
    """The library that has a function of casadi under its name; None where there can be none."""
    coming = MachineCode(function)
    coming.ready.wait()
    return coming.library


class MachineCode:
    """Machine code of a function of casadi, which is there at once if it was compiled before.

    Else it is compiled in the background, after what was asked for earlier.

    Attributes:
        ready: set when it has come, or when it is clear that there will be none.
        library: has the function under its name; None before, and where there can be none.
    """

    def __init__(self, function: ca.Function) -> None:
        generator = ca.CodeGenerator(f"{function.name()}.c")
        generator.add(function)
        self._sources = {f"{function.name()}.c": generator.dump()}
        self._flags = (ca.CasadiMeta.version(), *GENERATED)
        self.ready = threading.Event()
        self.library: Path | None = None
        library = _place(self._sources, self._flags)
        if library.exists() or _compiler() is None:
            self.come()
        else:
            self.compile_later()

    def compile_later(self) -> None:
        """Has it compiled in the background."""
        compilations().put(self)

    def come(self) -> None:
        """Compiles it now, if that has not been done."""
        self.library = _library(self._sources, self._flags)
        self.ready.set()


def finish() -> None:
    """Waits until all machine code has come that was asked for."""
    compilations().join()


@cache
def compilations() -> queue.Queue[MachineCode]:
    """What is still to compile, and the thread that does, which ends with the process."""
    waiting: queue.Queue[MachineCode] = queue.Queue()

    def work() -> None:
        while True:
            waiting.get().come()
            waiting.task_done()

    threading.Thread(target=work, name="compiler", daemon=True).start()
    return waiting


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
    compiler, library = _compiler(), _place(sources, flags)
    if compiler is None:
        return None
    with contextlib.suppress(OSError, subprocess.SubprocessError):
        if not library.exists():
            _compile(compiler, sources, [flag for flag in flags if flag.startswith("-")], library)
        return library
    return None


def _compiler() -> str | None:
    return shutil.which("cc") or shutil.which("gcc")


def _place(sources: dict[str, str], flags: Sequence[str]) -> Path:
    content = "\n".join([*flags, *FLAGS, *sources.values()])
    digest = hashlib.sha256(content.encode()).hexdigest()
    cache = os.environ.get("XDG_CACHE_HOME")
    folder = (Path(cache) if cache else Path.home() / ".cache") / "motion_node"
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
