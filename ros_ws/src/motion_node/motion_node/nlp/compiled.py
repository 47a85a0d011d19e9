# SPDX-License-Identifier: Apache-2.0
"""Functions of casadi as machine code; where there is none, they take four times as long.

So it is until it has come: nobody waits for a compiler.
"""

from __future__ import annotations

import contextlib
import queue
import threading
import weakref
from functools import cache
from pathlib import Path
from typing import Final

import casadi as ca
from tamp_runtime.machine_code import compiled, compiler, place

#: Of generated code: more takes twice as long to compile and is not faster.
GENERATED: Final = ("-O1",)


def machine_code(function: ca.Function) -> Path | None:
    """The library that has a function of casadi under its name; None where there can be none."""
    return compiled(*_generated(function))


class MachineCode:
    """Machine code of a function of casadi, which is there at once if it was compiled before.

    Else it is compiled in the background, after what was asked for earlier, unless nobody keeps
    this any more by then.

    Attributes:
        ready: set when it has come, or when it is clear that there will be none.
        library: has the function under its name; None before, and where there can be none.
    """

    def __init__(self, function: ca.Function) -> None:
        self._code = _generated(function)
        self.ready = threading.Event()
        self.library: Path | None = None
        if place(*self._code).exists() or compiler() is None:
            self.come()
        else:
            self.compile_later()

    def compile_later(self) -> None:
        """Has it compiled in the background."""
        compilations().put(weakref.ref(self))

    def come(self) -> None:
        """Compiles it now, if that has not been done."""
        try:
            self.library = compiled(*self._code)
        finally:
            self.ready.set()


def finish() -> None:
    """Waits until all machine code has come that was asked for and is still wanted."""
    compilations().join()


@cache
def compilations() -> queue.Queue[weakref.ref[MachineCode]]:
    """What is still to compile, and the thread that does, which ends with the process."""
    waiting: queue.Queue[weakref.ref[MachineCode]] = queue.Queue()

    def work() -> None:
        while True:
            coming = waiting.get()()
            try:
                if coming is not None:
                    coming.come()
            finally:
                del coming
                waiting.task_done()

    threading.Thread(target=work, name="compiler", daemon=True).start()
    return waiting


def _generated(function: ca.Function) -> tuple[dict[str, str], tuple[str, ...]]:
    """The C of a function by the name of its file, and the compiler's flags."""
    name = f"{function.name()}.c"
    generator = ca.CodeGenerator(name)
    generator.add(function)
    return {name: generator.dump()}, (ca.CasadiMeta.version(), *GENERATED)


def loaded(function: ca.Function, library: Path | None) -> ca.Function:
    """The same function, from a library if that can be."""
    if library is not None:
        with contextlib.suppress(RuntimeError):
            return ca.external(function.name(), str(library))
    return function
