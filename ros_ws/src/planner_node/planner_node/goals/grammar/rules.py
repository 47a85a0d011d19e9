# SPDX-License-Identifier: Apache-2.0
"""The grammar of goals, from ``rules_of_names.txt`` and its neighbours."""

from __future__ import annotations

import ast
import functools
import inspect
import re
from collections.abc import Callable
from pathlib import Path
from typing import Any, Final

from . import (
    clausal,
    commands,
    listing,
    locative,
    nominal,
    possessive,
    relational,
    rows,
    sentences,
    verbal,
)
from .chart import Grammar

_LINE: Final = re.compile(r"(\S+?)(?: ([a-z]\w*\.\w+|@\w+|=\S+?|\+))?(?: ([\d.]+))?: (.*)")
_MODULES: Final = {
    module.__name__.rpartition(".")[2]: module
    for module in (
        nominal,
        locative,
        listing,
        relational,
        verbal,
        clausal,
        possessive,
        commands,
        rows,
        sentences,
    )
}


def _grammar() -> Grammar:
    grammar = Grammar(last=("ITEMS", "TEXT"))
    paths = sorted(Path(__file__).parent.glob("rules_*.txt"))
    for line in "".join(path.read_text(encoding="utf-8") for path in paths).splitlines():
        if not line or line.startswith("#"):
            continue
        match = _LINE.fullmatch(line)
        assert match is not None, line
        for category in match[1].split("/"):
            build = _builder(match[2] or "", category)
            for side in match[4].split(" | "):
                grammar.add(category, side, build, float(match[3] or 0))
    return grammar


def _builder(written: str, category: str) -> Callable[..., Any]:
    """What a line names: a function, ``@tag``, ``=value``, ``+`` (a tuple of it), or its part."""
    if written.startswith("="):
        return functools.partial(_constant, ast.literal_eval(written[1:]))
    if written.startswith("@"):
        return functools.partial(_tagged, written[1:])
    if written == "+":
        return _tuple
    if not written:
        return functools.partial(_same, category)
    module, _, name = written.partition(".")
    build: Callable[..., Any] = getattr(_MODULES[module], f"_{name}")
    if "wished" in inspect.signature(build).parameters:
        build = functools.partial(build, wished=category == "WISHED")
    return build


def _constant(value: object, **_: object) -> object:
    return value


def _tagged(tag: str, **part: object) -> object:
    return tag, next(iter(part.values()))


def _tuple(**part: object) -> object:
    return tuple(part.values())


def _same(category: str, **part: object) -> object:
    return next(iter(part.values())) if part else category


GRAMMAR: Final = _grammar()
