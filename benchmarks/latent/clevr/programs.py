# SPDX-License-Identifier: Apache-2.0
"""Functional programs of questions, and what they answer on a true graph."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from typing import Any, Final

from .things import ATTRIBUTES, Scene, related


class IllPosedError(ValueError):
    """A program that speaks of the one thing of a kind of which there is none, or several."""


@dataclass(frozen=True)
class Step:
    """One function of a program, of the results of other steps and of words.

    Attributes:
        function: a name of :data:`FUNCTIONS`.
        inputs: steps whose results it takes.
        words: what else it is told.
    """

    function: str
    inputs: tuple[Step, ...] = ()
    words: tuple[str, ...] = ()


def _unique(_scene: Scene, things: frozenset[int]) -> int:
    if len(things) != 1:
        raise IllPosedError(f"there are {len(things)} such things, not one")
    return next(iter(things))


FUNCTIONS: Final[dict[str, Callable[..., Any]]] = {
    "scene": lambda scene: frozenset(range(len(scene))),
    "filter": lambda scene, things, *words: frozenset(i for i in things if scene[i].has(words)),
    "unique": _unique,
    "relate": lambda scene, thing, relation: related(scene, relation, thing),
    "query": lambda scene, thing, name: getattr(scene[thing], name),
    "same": lambda scene, a, b, name: getattr(scene[a], name) == getattr(scene[b], name),
    "exist": lambda _scene, things: len(things) > 0,
    "count": lambda _scene, things: len(things),
    "and": lambda _scene, a, b: a & b,
    "or": lambda _scene, a, b: a | b,
    "more": lambda _scene, a, b: a > b,
    "fewer": lambda _scene, a, b: a < b,
    "equal": lambda _scene, a, b: a == b,
}


def execute(step: Step, scene: Scene) -> Any:
    """The result of a program: things, one thing, a number, a word, or whether something is so.

    Raises:
        IllPosedError: see there.
    """
    results = [execute(item, scene) for item in step.inputs]
    return FUNCTIONS[step.function](scene, *results, *step.words)


def answer_of(result: Any) -> str:
    """A result as the word that answers a question."""
    if isinstance(result, bool):
        return "yes" if result else "no"
    return str(result)


def tokens_of(step: Step) -> tuple[str, ...]:
    """A program as tokens in the order of execution, each filter's words one by one."""
    before = tuple(token for item in step.inputs for token in tokens_of(item))
    if step.function != "filter":
        return (*before, " ".join((step.function, *step.words)))
    named = [
        f"filter {name} {word}"
        for word in step.words
        for name, values in ATTRIBUTES.items()
        if word in values
    ]
    return (*before, *named)
