# SPDX-License-Identifier: Apache-2.0
"""The grammar of goals, from ``grammar.txt``."""

from __future__ import annotations

import functools
import inspect
import re
from collections.abc import Callable
from pathlib import Path
from typing import Any, Final

from . import clausal, nominal, relational, rows, sentences
from .chart import Grammar

_LINE: Final = re.compile(r"(\S+?)(?: ([a-z]\w*)\.(\w+))?(?: ([\d.]+))?: (.*)")
_MODULES: Final = {
    module.__name__.rpartition(".")[2]: module
    for module in (nominal, relational, clausal, rows, sentences)
}


def _grammar() -> Grammar:
    grammar = Grammar()
    for line in Path(__file__).with_name("grammar.txt").read_text(encoding="utf-8").splitlines():
        if not line or line.startswith("#"):
            continue
        match = _LINE.fullmatch(line)
        assert match is not None, line
        for category in match[1].split("/"):
            build: Callable[..., Any] = functools.partial(_same, category)
            if match[2]:
                build = getattr(_MODULES[match[2]], f"_{match[3]}")
                if "wished" in inspect.signature(build).parameters:
                    build = functools.partial(build, wished=category == "WISHED")
            for side in match[5].split(" | "):
                grammar.add(category, side, build, float(match[4] or 0))
    return grammar


def _same(category: str, **part: object) -> object:
    return next(iter(part.values())) if part else category


GRAMMAR: Final = _grammar()
