# SPDX-License-Identifier: Apache-2.0
"""Questions by family: their programs and words, without those that are no real questions."""

from __future__ import annotations

from collections import Counter
from collections.abc import Callable, Sequence
from dataclasses import dataclass
from typing import Final

import numpy as np

from .programs import IllPosedError, Step, answer_of, execute
from .things import ATTRIBUTES, RELATIONS, Scene

_SCENE: Final = Step("scene")
_PHRASES: Final = {
    "left": "left of",
    "right": "right of",
    "front": "in front of",
    "behind": "behind",
    "above": "above",
    "below": "below",
}
#: An answer may be this much more frequent in its family than the median one.
_BALANCE: Final = 1.05
_TRIES: Final = 80


class DegenerateError(ValueError):
    """A question that can be answered without what it is about."""


@dataclass(frozen=True)
class Question:
    """One question.

    Attributes:
        family: a name of :data:`FAMILIES`.
        words: of the question.
        program: what it asks.
        answer: on its scene.
    """

    family: str
    words: tuple[str, ...]
    program: Step
    answer: str


#: Draws words and program; raises IllPosedError or DegenerateError where they make no question.
Draw = Callable[[Scene, np.random.Generator], tuple[str, Step]]


def _description(
    scene: Scene, rng: np.random.Generator, among: Sequence[int] = ()
) -> tuple[str, ...]:
    """Some of the words that are true of a thing that is there, or might be."""
    if among or rng.random() < 0.8:
        thing = scene[int(rng.choice(among or range(len(scene))))]
        words = [thing.size, thing.color, thing.shape]
    else:
        words = [str(rng.choice(values)) for values in ATTRIBUTES.values()]
    kept = [word for word in words if rng.random() < 0.5]
    return tuple(kept or [str(rng.choice(words))])


def _named(words: Sequence[str]) -> str:
    return " ".join(words if words and words[-1] in ATTRIBUTES["shape"] else [*words, "thing"])


def _filter(words: tuple[str, ...], things: Step = _SCENE) -> Step:
    return Step("filter", (things,), words) if words else things


def _the(words: tuple[str, ...], things: Step = _SCENE) -> Step:
    return Step("unique", (_filter(words, things),))


def _exist(scene: Scene, rng: np.random.Generator) -> tuple[str, Step]:
    words = _description(scene, rng)
    return f"is there a {_named(words)}", Step("exist", (_filter(words),))


def _count(scene: Scene, rng: np.random.Generator) -> tuple[str, Step]:
    words = _description(scene, rng)
    return f"how many {_named(words)} are there", Step("count", (_filter(words),))


def _query(scene: Scene, rng: np.random.Generator) -> tuple[str, Step]:
    words = _description(scene, rng)
    name = _asked(words, rng)
    return f"what {name} is the {_named(words)}", Step("query", (_the(words),), (name,))


def _same(scene: Scene, rng: np.random.Generator) -> tuple[str, Step]:
    first, second = _description(scene, rng), _description(scene, rng)
    one, other = _the(first), _the(second)
    if execute(one, scene) == execute(other, scene):
        raise DegenerateError("a thing is compared to itself")
    name = _asked((*first, *second), rng)
    text = f"does the {_named(first)} have the same {name} as the {_named(second)}"
    return text, Step("same", (one, other), (name,))


def _compare(scene: Scene, rng: np.random.Generator) -> tuple[str, Step]:
    first, second = _description(scene, rng), _description(scene, rng)
    if set(first) <= set(second) or set(second) <= set(first):
        raise DegenerateError("one kind is part of the other")
    function = str(rng.choice(["more", "fewer", "equal"]))
    text = {
        "more": f"are there more {_named(first)} than {_named(second)}",
        "fewer": f"are there fewer {_named(first)} than {_named(second)}",
        "equal": f"are there as many {_named(first)} as {_named(second)}",
    }[function]
    counts = Step("count", (_filter(first),)), Step("count", (_filter(second),))
    return text, Step(function, counts)


def _hops(number: int) -> Draw:
    def draw(scene: Scene, rng: np.random.Generator) -> tuple[str, Step]:
        words = _description(scene, rng)
        anchor, text = _the(words), f"the {_named(words)}"
        for hop in range(number):
            relation = str(rng.choice(RELATIONS))
            there = Step("relate", (anchor,), (relation,))
            beside = sorted(execute(there, scene))
            text = f"{_PHRASES[relation]} {text}"
            last = hop == number - 1
            if last and rng.random() < 0.5:
                kind = _description(scene, rng) if rng.random() < 0.6 else ()
                return _end(scene, rng, kind, there, text)
            if not beside:
                raise IllPosedError("nothing is there")
            kind = _description(scene, rng, beside)
            anchor = _the(kind, there)
            _needs_relation(scene, kind, there)
            text = f"the {_named(kind)} {text}"
        name = _asked(kind, rng)
        return f"what {name} is {text}", Step("query", (anchor,), (name,))

    return draw


def _end(
    scene: Scene, rng: np.random.Generator, kind: tuple[str, ...], there: Step, text: str
) -> tuple[str, Step]:
    _needs_relation(scene, kind, there)
    if rng.random() < 0.5:
        return f"is there a {_named(kind)} {text}", Step("exist", (_filter(kind, there),))
    return f"how many {_named(kind)} are {text}", Step("count", (_filter(kind, there),))


def _needs_relation(scene: Scene, kind: tuple[str, ...], there: Step) -> None:
    """Raises DegenerateError where the things of a kind are the same without the relation."""
    if execute(_filter(kind, there), scene) == execute(_filter(kind), scene):
        raise DegenerateError("the relation leaves out nothing")


def _both(scene: Scene, rng: np.random.Generator) -> tuple[str, Step]:
    sides, texts = [], []
    for _ in range(2):
        words, relation = _description(scene, rng), str(rng.choice(RELATIONS))
        sides.append(Step("relate", (_the(words),), (relation,)))
        texts.append(f"{_PHRASES[relation]} the {_named(words)}")
    together = Step("and", tuple(sides))
    found = execute(together, scene)
    if any(execute(side, scene) == found for side in sides):
        raise DegenerateError("one of the two says it all")
    return f"how many thing are {texts[0]} and {texts[1]}", Step("count", (together,))


def _either(scene: Scene, rng: np.random.Generator) -> tuple[str, Step]:
    first, second = _description(scene, rng), _description(scene, rng)
    together = Step("or", (_filter(first), _filter(second)))
    found = execute(together, scene)
    if any(execute(side, scene) == found for side in together.inputs):
        raise DegenerateError("one of the two says it all")
    return f"how many thing are {_named(first)} or {_named(second)}", Step("count", (together,))


def _asked(words: Sequence[str], rng: np.random.Generator) -> str:
    """An attribute that the words do not tell."""
    open_ = [name for name, values in ATTRIBUTES.items() if not set(values) & set(words)]
    if not open_:
        raise DegenerateError("everything is told already")
    return str(rng.choice(open_))


FAMILIES: Final[dict[str, Draw]] = {
    "existence": _exist,
    "count": _count,
    "attribute": _query,
    "attribute comparison": _same,
    "integer comparison": _compare,
    "one hop": _hops(1),
    "two hops": _hops(2),
    "three hops": _hops(3),
    "and": _both,
    "or": _either,
}


class Asker:
    """Draws questions whose answers are balanced within each family.

    Attributes:
        answers: how often each answer was given, by family.
    """

    def __init__(self) -> None:
        self.answers: dict[str, Counter[str]] = {name: Counter() for name in FAMILIES}

    def ask(self, scene: Scene, rng: np.random.Generator) -> list[Question]:
        """One question of each family of which the scene allows one, all different."""
        asked = []
        for family in FAMILIES:
            for _ in range(_TRIES):
                question = draw_question(family, scene, rng)
                if question is not None and self._wanted(question):
                    self.answers[family][question.answer] += 1
                    asked.append(question)
                    break
        return asked

    def take(self, question: Question) -> None:
        """To be told of questions that were asked before, of a set that is gone on with."""
        self.answers[question.family][question.answer] += 1

    def _wanted(self, question: Question) -> bool:
        counts = self.answers[question.family]
        # Of an attribute's words, and of numbers and yes or no, each by itself.
        peers = [counts[word] for word in _peers(question.answer) if counts[word]]
        return counts[question.answer] <= _BALANCE * float(np.median(peers or [0])) + 1.0


def _peers(answer: str) -> tuple[str, ...]:
    groups = (*ATTRIBUTES.values(), ("yes", "no"), tuple(map(str, range(7))))
    return next(group for group in groups if answer in group)


def draw_question(family: str, scene: Scene, rng: np.random.Generator) -> Question | None:
    """A question of a family about a scene; None where what was drawn is none."""
    try:
        text, program = FAMILIES[family](scene, rng)
        answer = answer_of(execute(program, scene))
    except (IllPosedError, DegenerateError):
        return None
    return Question(family, tuple(text.split()), program, answer)
