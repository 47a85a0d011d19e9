# SPDX-License-Identifier: Apache-2.0
"""Functions of casadi as machine code; where there is none, they take four times as long."""

from __future__ import annotations

import contextlib
from pathlib import Path
from typing import Final

import casadi as ca
from tamp_runtime.machine_code import compiled

#: Of generated code: more takes twice as long to compile and is not faster.
GENERATED: Final = ("-O1",)


def machine_code(function: ca.Function) -> Path | None:
    """The library that has a function of casadi under its name; None where there can be none."""
    generator = ca.CodeGenerator(f"{function.name()}.c")
    generator.add(function)
    name, source = f"{function.name()}.c", generator.dump()
    return compiled({name: source}, (ca.CasadiMeta.version(), *GENERATED))


def loaded(function: ca.Function, library: Path | None) -> ca.Function:
    """The same function, from a library if that can be."""
    if library is not None:
        with contextlib.suppress(RuntimeError):
            return ca.external(function.name(), str(library))
    return function
