# SPDX-License-Identifier: Apache-2.0
"""Compiled functions give what interpreted ones give; where nothing compiles, nothing changes."""

import contextlib
import ctypes
import gc
import os
import select
import subprocess
import sys
import weakref
from collections.abc import Callable
from pathlib import Path

import casadi as ca
import numpy as np
import pytest
from numpy.typing import NDArray
from tamp_runtime import machine_code as module
from tamp_runtime.machine_code import address, opened, written, written_below

from motion_node.nlp.compiled import MachineCode, compilations, finish, loaded, machine_code


def some_function(factor: float = 2.0) -> ca.Function:
    x = ca.MX.sym("x", 40)
    values = factor * ca.sin(x)
    return ca.Function("some", [x], [values, ca.jacobian(ca.mtimes(values, x.T)[:, :8], x)])


def compiled(function: ca.Function) -> ca.Function:
    return loaded(function, machine_code(function))


@pytest.fixture
def cache(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    monkeypatch.setenv("XDG_CACHE_HOME", str(tmp_path))
    return tmp_path / "tamp_runtime"


def assert_same(one: ca.Function, other: ca.Function) -> None:
    x = np.random.default_rng(0).normal(size=40)
    for mine, its in zip(one(x), other(x)):
        np.testing.assert_allclose(np.array(mine), np.array(its), rtol=1e-12)


def test_a_compiled_function_gives_the_same_and_is_kept_by_its_content(cache: Path) -> None:
    function = some_function()
    assert_same(compiled(function), function)
    (library,) = cache.iterdir()
    before = library.stat().st_mtime_ns
    assert_same(compiled(some_function()), function)
    assert [library] == list(cache.iterdir())
    assert library.stat().st_mtime_ns == before
    other = some_function(3.0)
    assert_same(compiled(other), other)
    assert len(list(cache.iterdir())) == 2


@pytest.mark.parametrize("why", ["no compiler", "compiler fails", "no place", "broken library"])
def test_what_cannot_be_compiled_is_interpreted(
    cache: Path, monkeypatch: pytest.MonkeyPatch, why: str
) -> None:
    function = some_function()
    if why == "no compiler":
        monkeypatch.setattr(module.shutil, "which", lambda _name: None)
    elif why == "compiler fails":
        monkeypatch.setattr(module.shutil, "which", lambda _name: "/bin/false")
    elif why == "no place":
        cache.write_text("a file")
    else:
        compiled(function)
        (library,) = cache.iterdir()
        library.write_text("not a library")
    assert compiled(function) is function


def test_c_files_are_compiled_with_those_that_they_include(cache: Path, tmp_path: Path) -> None:
    first, second = tmp_path / "first.c", tmp_path / "second.c"
    first.write_text('#include "second.c"\nint more(int x) { return x + MORE; }\n')
    second.write_text("#define MORE 5\n")
    library = written(first, second)
    assert library is not None
    assert library.more(2) == 7
    assert len(list(cache.iterdir())) == 1


def test_c_files_below_a_folder_are_compiled_before_they_are_needed(
    cache: Path, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    (tmp_path / "inner").mkdir()
    files = [tmp_path / "outer.c", tmp_path / "inner" / "inner.c"]
    for value, file in enumerate(files, 3):
        file.write_text(f"int value(void) {{ return {value}; }}\n")
    written_below(tmp_path)
    assert len(list(cache.iterdir())) == 2
    monkeypatch.setattr(module, "compiled", None)  # nothing is left to compile
    libraries = [written(file) for file in files]
    assert [library.value() for library in libraries if library is not None] == [3, 4]


def read_only() -> NDArray[np.float64]:
    array = np.arange(3.0)
    array.flags.writeable = False
    return array


@pytest.mark.parametrize(
    "make",
    [lambda: np.arange(3.0), read_only, lambda: np.arange(6.0)[::2], lambda: np.empty((0, 3))],
    ids=["any", "read-only", "with gaps", "empty"],
)
def test_an_array_lives_as_long_as_its_address(make: Callable[[], NDArray[np.float64]]) -> None:
    array = make()
    kept = weakref.ref(array)
    pointer = address(array)
    begin = ctypes.cast(pointer, ctypes.c_void_p).value
    assert not array.size or begin == array.__array_interface__["data"][0]
    del array
    assert kept() is not None
    del pointer
    gc.collect()  # ctypes.cast leaves a cycle
    assert kept() is None


@pytest.mark.usefixtures("cache")
def test_what_is_no_c_has_no_library(tmp_path: Path) -> None:
    wrong = tmp_path / "wrong.c"
    wrong.write_text("this is not C")
    assert written(wrong) is None
    assert opened(None) is None
    assert opened(wrong) is None


@pytest.mark.usefixtures("cache")
def test_machine_code_comes_in_the_background(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(
        MachineCode, "compile_later", lambda self: compilations().put(weakref.ref(self))
    )
    coming = [MachineCode(some_function(factor)) for factor in (2.0, 3.0)]
    finish()
    assert all(one.ready.is_set() for one in coming)
    for one, factor in zip(coming, (2.0, 3.0)):
        function = some_function(factor)
        assert one.library is not None
        assert_same(loaded(function, one.library), function)


def test_machine_code_that_nobody_keeps_is_not_compiled(
    cache: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    waiting: list[weakref.ref[MachineCode]] = []
    monkeypatch.setattr(
        MachineCode, "compile_later", lambda self: waiting.append(weakref.ref(self))
    )
    MachineCode(some_function(4.0))
    compilations().put(waiting[0])
    finish()
    assert not cache.exists() or not list(cache.iterdir())


def test_a_process_that_ends_ends_its_compiler(tmp_path: Path) -> None:
    compiler, began, alive = (tmp_path / name for name in ("cc", "began", "alive"))
    os.mkfifo(alive)
    compiler.write_text(f"#!/bin/sh\nexec 3<>{alive}\ntouch {began}\nexec sleep 600\n")
    compiler.chmod(0o755)
    program = (
        "import time, casadi as ca; from pathlib import Path\n"
        "from motion_node.nlp.compiled import MachineCode\n"
        "x = ca.MX.sym('x', 3)\n"
        "coming = MachineCode(ca.Function('some', [x], [ca.sin(x)]))\n"
        f"while not Path({str(began)!r}).exists(): time.sleep(0.01)\n"
    )
    path = f"{tmp_path}:{os.environ['PATH']}"
    subprocess.run(
        [sys.executable, "-c", program],
        env={**os.environ, "PATH": path, "XDG_CACHE_HOME": str(tmp_path)},
        check=True,
        timeout=120,
    )
    assert nobody_writes(alive)


def nobody_writes(pipe: Path) -> bool:
    """Whether nobody has a named pipe open, or everybody closes it within a minute."""
    reading = os.open(pipe, os.O_RDONLY | os.O_NONBLOCK)
    try:
        with contextlib.suppress(BlockingIOError):
            return os.read(reading, 1) == b""
        return bool(select.select([reading], [], [], 60.0)[0]) and os.read(reading, 1) == b""
    finally:
        os.close(reading)
