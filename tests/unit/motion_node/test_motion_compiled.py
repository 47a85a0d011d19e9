# SPDX-License-Identifier: Apache-2.0
"""Compiled functions give what interpreted ones give; where nothing compiles, nothing changes."""

from pathlib import Path

import casadi as ca
import numpy as np
import pytest

from motion_node.nlp import compiled as module
from motion_node.nlp.compiled import compiled


def some_function(factor: float = 2.0) -> ca.Function:
    x = ca.MX.sym("x", 40)
    values = factor * ca.sin(x)
    return ca.Function("some", [x], [values, ca.jacobian(ca.mtimes(values, x.T)[:, :8], x)])


@pytest.fixture
def cache(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    monkeypatch.setenv("XDG_CACHE_HOME", str(tmp_path))
    return tmp_path / "motion_node"


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


def test_small_functions_stay_as_they_are(cache: Path) -> None:
    x = ca.MX.sym("x", 3)
    function = ca.Function("small", [x], [2 * x])
    assert compiled(function) is function
    assert not cache.exists()


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
