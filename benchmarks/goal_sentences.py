# SPDX-License-Identifier: Apache-2.0
"""Goals in sentences: 300 that a generator writes from random scenes, 300 written by hand.

A sentence is read right if the goal is true in exactly those states in which its meaning is. The
hundred in ``goal_sentences.json`` were written, with their meanings, by somebody who did not know
the reader, and those in ``goal_sentences_of_twenty.json`` by another one, as twenty people would
put it, which have been looked at since. Nobody who works on the reader looks at those in
``goal_sentences_unseen.json``, which a third one wrote as twenty-five people would: they tell how a
stranger's sentences fare. Those whose meaning is null are to be asked back.
"""

from __future__ import annotations

import itertools
import json
import random
from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass
from functools import lru_cache
from pathlib import Path
from typing import Any, Final

from results_file import Row

from planner_node import PlannerError
from planner_node.goals import Goal, parse_goal, resolve_goal
from scene_graph import Stacks, spots_of

FIRST_SEED: Final = 1000
BY_HAND: Final = Path(__file__).with_suffix(".json")
OF_TWENTY: Final = BY_HAND.with_stem("goal_sentences_of_twenty")
UNSEEN: Final = BY_HAND.with_stem("goal_sentences_unseen")
SCENES: Final = {
    "A": (3, ("red_box", "blue_box", "green_box", "yellow_box", "cyan_box")),
    "B": (3, ("red_box", "red_cylinder", "blue_box", "green_box", "yellow_sphere")),
    "C": (4, ("purple_box", "orange_box", "pink_cylinder", "brown_box", "white_box")),
}
Meaning = Sequence[dict[str, Any]]
#: Where the planner takes blocks to be in a state; many sentences are of the same scene.
_SPOTS: Final = lru_cache(maxsize=40_000)(spots_of)


@dataclass(frozen=True)
class Sentence:
    """What was written, in which scene, and what it means; None: it is to be asked back."""

    places: int
    names: tuple[str, ...]
    text: str
    meaning: Meaning | None


def by_hand(path: Path = BY_HAND) -> list[Sentence]:
    """Those of a file: scene, text and meaning of each."""
    return [
        Sentence(*SCENES[item["scene"]], item["text"], item["meaning"])
        for item in json.loads(path.read_text(encoding="utf-8"))
    ]


@lru_cache(maxsize=4)
def all_states(names: tuple[str, ...], places: int) -> tuple[Stacks, ...]:
    """Every arrangement of the blocks."""
    states = []
    for order in itertools.permutations(names):
        inner = itertools.combinations_with_replacement(range(len(names) + 1), places - 1)
        for walls in inner:
            cuts = (0, *walls, len(names))
            states.append(tuple(order[a:b] for a, b in itertools.pairwise(cuts)))
    return tuple(states)


@lru_cache(maxsize=40_000)
def _where(stacks: Stacks) -> dict[str, tuple[int, int]]:
    """Of each block and place of a state the place, and the level."""
    spots = {f"stack{place}": (place, -1) for place in range(len(stacks))}
    for place, stack in enumerate(stacks):
        spots |= {name: (place, level) for level, name in enumerate(stack)}
    return spots


def holds(meaning: Meaning, stacks: Stacks) -> bool:
    """Whether a state is what a sentence means; shares nothing with the planner."""
    spots = _where(stacks)

    def related(subject: str, predicate: str, object_: str) -> bool:
        (ours, level), (theirs, below) = spots[subject], spots[object_]
        return {
            "on": ours == theirs and level == below + 1,
            "above": ours == theirs and level > below,
            "left": ours < theirs,
            "beside": abs(ours - theirs) == 1,
        }[predicate]

    for item in meaning:
        if "rel" in item and not related(*item["rel"]):
            return False
        if "not" in item and related(*item["not"]):
            return False
        if "count" in item:
            count = item["count"]
            number = sum(
                related(name, count["predicate"], count["object"]) for name in count["subjects"]
            )
            most = len(count["subjects"]) if count["most"] is None else count["most"]
            if not (count["least"] or 0) <= number <= most:
                return False
    return True


def outcome(sentence: Sentence) -> tuple[str, str]:
    """right, asked back or wrong; and what was understood, or asked."""
    try:
        goal = resolve_goal(parse_goal(sentence.text), sentence.names, sentence.places)
    except PlannerError as error:
        return ("right" if sentence.meaning is None else "asked back"), f"{error.status}: {error}"
    if sentence.meaning is None:
        # What no state fulfils is refused before anything moves, with the relations that clash.
        possible = any(
            goal.holds_at(_SPOTS(state)) for state in all_states(sentence.names, sentence.places)
        )
        return ("wrong" if possible else "right"), str(goal)
    same = _same(goal, sentence.meaning, all_states(sentence.names, sentence.places))
    return ("right" if same else "wrong"), str(goal)


def _same(goal: Goal, meaning: Meaning, states: Sequence[Stacks]) -> bool:
    return all(goal.holds_at(_SPOTS(state)) == holds(meaning, state) for state in states)


# What the generator writes

_ON: Final = ("on", "on top of", "directly on", "onto")
_OPENINGS: Final = (
    "",
    "",
    "",
    "put ",
    "please put ",
    "I want ",
    "make sure that ",
    "could you put ",
)
_COLORS: Final = ("red", "green", "blue", "yellow", "purple", "orange", "cyan", "pink", "brown")


def generated(count: int) -> Iterator[Sentence]:
    """Sentences from random scenes, seeds from 1000."""
    for seed in range(FIRST_SEED, FIRST_SEED + count):
        yield _write(random.Random(seed))


def _write(rng: random.Random) -> Sentence:
    places = rng.choice((3, 3, 4))
    colors = rng.sample(_COLORS, rng.choice((3, 4, 5)))
    names = tuple(f"{color}_{rng.choice(('box', 'cylinder'))}" for color in colors)
    target = rng.choice(all_states(names, places))
    true = list(_facts(target, names))
    chosen = rng.sample(true, min(len(true), rng.choice((1, 1, 2, 3))))
    texts = [rng.choice(_OPENINGS) + _told(kind, rng) for kind, _ in chosen]
    joined = rng.choice((", ", " and ", ", and ", "; ", ". ")).join(texts)
    text = joined + rng.choice(("", "", ".", " please", "!"))
    if rng.random() < 0.3:
        text = text.capitalize() if rng.random() < 0.5 else text.upper()
    return Sentence(places, names, text, [item for _, meaning in chosen for item in meaning])


def _facts(state: Stacks, names: Sequence[str]) -> Iterator[tuple[tuple[str, ...], Meaning]]:
    """What is true of a state: the kind and its names, and the meaning."""
    for place, stack in enumerate(state):
        base = f"stack{place}"
        if not stack:
            yield ("empty", base), [{"not": [name, "above", base]} for name in names]
            continue
        yield ("on place", stack[0], base), [{"rel": [stack[0], "on", base]}]
        yield ("number", str(len(stack)), base), [
            {"count": {"least": len(stack), "most": len(stack), "subjects": list(names),
                       "predicate": "above", "object": base}}
        ]  # fmt: skip
        top = stack[-1]
        yield ("clear", top), [{"not": [name, "on", top]} for name in names if name != top]
        for lower, upper in itertools.pairwise(stack):
            yield ("on", upper, lower), [{"rel": [upper, "on", lower]}]
        for lower, upper in itertools.combinations(stack, 2):
            yield ("above", upper, lower), [{"rel": [upper, "above", lower]}]
        for other in state[place + 1 :]:
            for ours, theirs in itertools.product(stack, other):
                yield ("left", ours, theirs), [{"rel": [ours, "left", theirs]}]
        for name in names:
            if name not in stack:
                yield ("not in", name, base), [{"not": [name, "above", base]}]


def _told(fact: tuple[str, ...], rng: random.Random) -> str:
    """One of the ways to write a fact."""
    kind, *parts = fact
    said = [_name(part, rng) for part in parts]
    words: dict[str, Callable[[], str]] = {
        "on": lambda: f"{said[0]} {rng.choice(_ON)} {said[1]}",
        "above": lambda: rng.choice(
            (
                f"{said[0]} above {said[1]}",
                f"{said[1]} below {said[0]}",
                f"{said[1]} under {said[0]}",
            )
        ),
        "left": lambda: rng.choice(
            (f"{said[0]} left of {said[1]}", f"{said[1]} to the right of {said[0]}")
        ),
        "on place": lambda: f"{said[0]} on {said[1]}",
        "number": lambda: f"{rng.choice(('', 'exactly '))}{parts[0]} blocks in {said[1]}",
        "empty": lambda: rng.choice((f"nothing in {said[0]}", f"{said[0]} empty")),
        "clear": lambda: rng.choice((f"nothing on {said[0]}", f"{said[0]} clear")),
        "not in": lambda: f"{said[0]} not in {said[1]}",
    }
    return words[kind]()


def _name(name: str, rng: random.Random) -> str:
    if name.isdigit():
        return name
    if name.startswith("stack"):
        return rng.choice((name, f"stack {name[5:]}"))
    color, shape = name.split("_")
    return rng.choice(
        (color, f"the {color} {shape}", f"{color} {shape}", name, f"the {color} block")
    )


def sentence_rows(count: int) -> list[Row]:
    """How many are read right, asked back and read wrong."""
    rows = []
    for name, sentences, required in (
        ("written by a generator", list(generated(count)), ">= 0.99"),
        ("written by hand", by_hand(), ">= 0.9"),
        ("written by hand, as twenty people would", by_hand(OF_TWENTY), ">= 0.9"),
        ("written by hand, never looked at", by_hand(UNSEEN), ">= 0.9"),
    ):
        found = [outcome(sentence)[0] for sentence in sentences]
        share = found.count("right") / len(found)
        rows += [
            Row(f"goals {name}", "read right", share, "", len(found), required=required),
            Row(f"goals {name}", "asked back", found.count("asked back"), "", len(found)),
            Row(f"goals {name}", "read wrong", found.count("wrong"), "", len(found),
                required="== 0"),
        ]  # fmt: skip
    return rows


if __name__ == "__main__":
    for written in (*generated(300), *by_hand(), *by_hand(OF_TWENTY)):
        result, told = outcome(written)
        if result != "right":
            print(f"{result:10s} | {written.text} | {told} | {written.meaning}")
