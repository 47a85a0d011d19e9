# SPDX-License-Identifier: Apache-2.0
"""Goals that cannot be: contradictory, ambiguous, or out of reach; and what is said of each.

What is right is found by trying all arrangements, with the meanings of :mod:`goal_sentences`.
"""

from __future__ import annotations

import random
import time
from collections.abc import Callable, Sequence
from typing import Final

from goal_sentences import FIRST_SEED, all_states, holds
from results_file import Row
from tqdm import tqdm

from planner_node import PlannerError, make_plan, parse_goal, resolve_goal
from planner_node.errors import AmbiguousObjectError, ContradictoryGoalError, UnreachableError
from planner_node.goals import complete_goal
from scene_graph import Stacks

_COLORS: Final = ("red", "green", "blue", "yellow", "purple")
_WORDS: Final = {"on": "on", "above": "above", "left": "left of", "beside": "next to"}
Triple = tuple[str, str, str]
#: The goal, the scene, and whether an error says of it what is so.
Refused = tuple[str, Stacks, Callable[[PlannerError], bool]]


def refused_rows(count: int) -> list[Row]:
    """How many are refused for the right reason, and the longest time of one."""
    kinds = (_contradictory, _ambiguous, _out_of_reach)
    right, seconds = [0] * len(kinds), [0.0]
    asked = [0] * len(kinds)
    for index in tqdm(range(count), desc="goals that cannot be"):
        # Half of them contradict themselves, a quarter each is of the other kinds.
        kind = (0, 1, 0, 2)[index % 4]
        text, initial, is_right = kinds[kind](random.Random(FIRST_SEED + index))
        names = [name for stack in initial for name in stack]
        start = time.perf_counter()
        error: PlannerError | None = None
        try:
            make_plan(initial, resolve_goal(parse_goal(text), names, len(initial)))
        except PlannerError as caught:
            error = caught
        seconds.append(time.perf_counter() - start)
        asked[kind] += 1
        right[kind] += error is not None and is_right(error)
    rows = [
        Row(f"{name} goals", "refused for the right reason", good, "", number,
            required=f"== {number}")
        for name, good, number in zip(("contradictory", "ambiguous", "unreachable"), right, asked)
    ]  # fmt: skip
    rows.append(
        Row("goals that cannot be", "time, worst", max(seconds), "s", count, required="<= 0.5")
    )
    return rows


def _scene(rng: random.Random, places: int) -> tuple[tuple[str, ...], Stacks]:
    names = tuple(f"{color}_box" for color in rng.sample(_COLORS, rng.choice((4, 5))))
    return names, rng.choice(all_states(names, places))


def _contradictory(rng: random.Random) -> Refused:
    """Relations that no arrangement fulfils; a smallest choice of them is to be named."""
    names, initial = _scene(rng, 3)
    states = all_states(names, 3)
    while True:
        triples = _triples(rng, names)
        if not _possible(triples, states):
            break
    goal = ", ".join(map(_text, triples))

    def is_right(error: PlannerError) -> bool:
        if not isinstance(error, ContradictoryGoalError):
            return False
        told = {f"{subject} {_WORDS[word]} {object_}": (subject, word, object_)
                for subject, word, object_ in triples}  # fmt: skip
        named = [told[text] for text in error.relations if text in told]
        smaller = [[other for other in named if other != one] for one in named]
        return (
            len(named) == len(error.relations)
            and not _possible(named, states)
            and all(_possible(some, states) for some in smaller)
        )

    return goal, initial, is_right


def _triples(rng: random.Random, names: Sequence[str]) -> list[Triple]:
    triples: list[Triple] = []
    while len(triples) < rng.choice((2, 3, 4, 5)):
        word = rng.choice(tuple(_WORDS))
        bases = [f"stack{place}" for place in range(3)] if word in ("on", "above") else []
        subject, object_ = rng.choice(names), rng.choice([*names, *bases])
        if subject != object_ and (subject, word, object_) not in triples:
            triples.append((subject, word, object_))
    return triples


def _text(triple: Triple) -> str:
    return f"{triple[0]} {_WORDS[triple[1]]} {triple[2]}"


def _possible(triples: Sequence[Triple], states: Sequence[Stacks]) -> bool:
    meaning = [{"rel": triple} for triple in triples]
    return any(holds(meaning, state) for state in states)


def _ambiguous(rng: random.Random) -> Refused:
    """A name that two blocks have; both are to be named."""
    color, *others = rng.sample(_COLORS, 4)
    twins = (f"{color}_box", f"{color}_cylinder")
    names = (*twins, *(f"{other}_box" for other in others[:2]))
    initial = rng.choice(all_states(names, 3))
    word = rng.choice(tuple(_WORDS))
    pair = [rng.choice((color, f"the {color} block")), others[0]]
    rng.shuffle(pair)
    goal = f"{pair[0]} {_WORDS[word]} {pair[1]}"
    return (
        goal,
        initial,
        lambda error: (
            isinstance(error, AmbiguousObjectError) and set(error.candidates) == set(twins)
        ),
    )


def _out_of_reach(rng: random.Random) -> Refused:
    """On two places blocks cannot pass one another; the search has to prove it."""
    names, initial = _scene(rng, 2)
    order = [*initial[0], *reversed(initial[1])]
    while True:
        wanted = rng.choice(all_states(names, 2))
        if [*wanted[0], *reversed(wanted[1])] != order:
            break
    goal = str(complete_goal(wanted))
    return goal, initial, lambda error: isinstance(error, UnreachableError)
