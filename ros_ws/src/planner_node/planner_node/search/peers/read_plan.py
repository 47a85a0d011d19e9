# SPDX-License-Identifier: Apache-2.0
"""Plans as others write them, read move by move.

A plan is a file of PDDL, as planners write it, or a list of moves:

    (move red_box blue_box stack0)      what, from what, onto what
    0.000: (move red_box blue_box stack0) [1.000]
    red_box from blue_box to stack0     the same in words
    (2, 0)                              the top of stack2 to stack0; also "2 0" or "(2, 0) red_box"

Steps that only look (see :mod:`.pddl_checks`), empty lines and comments (;, #) say nothing.
"""

from __future__ import annotations

import re
from dataclasses import dataclass
from typing import Final

from scene_graph import Move, Stacks, apply_move, base_name

from ...errors import GivenPlanError
from .pddl import pddl_names

_TIME: Final = re.compile(r"^\d+(\.\d+)?:\s*")
_DURATION: Final = re.compile(r"\s*\[[\d.]+\]$")
_NUMBERS: Final = re.compile(r"^\(?\s*(-?\d+)\s*[,\s]\s*(-?\d+)\s*\)?(?:\s+(\S+).*)?$")
_STEP: Final = re.compile(r"^\(\s*([^\s()]+)((?:\s+[^\s()]+)*)\s*\)$")
_CALL: Final = re.compile(r"^([\w-]+)\(([^()]*)\)$")
_WORDS: Final = re.compile(r"^(\S+) from (\S+) (?:to|onto|on) (\S+)$")
#: Steps that change nothing.
_LOOKS: Final = ("look", "check-")


@dataclass(frozen=True)
class _Step:
    """What a line asks for: numbers of stacks, or names."""

    text: str
    block: str = ""
    source: int | None = None
    target: int | None = None
    below: str = ""
    onto: str = ""


def read_moves(text: str, initial: Stacks) -> list[Move]:
    """The moves of a plan as text, each of which is possible after the ones before.

    Raises:
        GivenPlanError: a line is no step, or its step is not possible; both are told.
    """
    stacks = initial
    names = {called: name for name, called in pddl_names(initial).items()}
    moves: list[Move] = []
    for line in text.splitlines():
        plain = _DURATION.sub("", _TIME.sub("", re.split("[;#]", line)[0].strip()))
        if not plain:
            continue
        step = _read(plain, len(moves))
        if step is None:
            continue
        move = _move_of(step, stacks, names, len(moves))
        moves.append(move)
        stacks = apply_move(stacks, move)
    return moves


def state_after(text: str, initial: Stacks) -> Stacks:
    """Where a plan leads; raises GivenPlanError as :func:`read_moves`."""
    stacks = initial
    for move in read_moves(text, initial):
        stacks = apply_move(stacks, move)
    return stacks


def _read(line: str, step: int) -> _Step | None:
    """One line without time and comment; None: it only looks."""
    if found := _NUMBERS.match(line):
        source, target, block = found.groups()
        return _Step(line, block or "", int(source), int(target))
    if found := _WORDS.match(line):
        block, below, onto = found.groups()
        return _Step(line, block, below=below, onto=onto)
    if (found := _STEP.match(line)) or (found := _CALL.match(line)):
        name, arguments = found.group(1).lower(), found.group(2).replace(",", " ").split()
        if name == "move" and len(arguments) == 3:
            return _Step(line, arguments[0], below=arguments[1], onto=arguments[2])
        if name.startswith(_LOOKS):
            return None
    raise GivenPlanError(
        f"step {step + 1} of the plan, '{line}', is not understood; steps look like "
        "'(move red_box blue_box stack0)' or '(2, 0)'",
        step,
    )


def _move_of(step: _Step, stacks: Stacks, names: dict[str, str], number: int) -> Move:
    """The move of a step in a state."""

    def wrong(problem: str) -> GivenPlanError:
        return GivenPlanError(f"step {number + 1} of the plan, '{step.text}': {problem}", number)

    def known(name: str) -> str:
        plain = name.lower()
        if plain not in names:
            raise wrong(f"there is no {name}; there are {', '.join(sorted(names.values()))}")
        return names[plain]

    columns = [[base_name(place), *stack] for place, stack in enumerate(stacks)]

    def place_of(name: str) -> int:
        return next(place for place, column in enumerate(columns) if name in column)

    if step.source is not None and step.target is not None:
        for place in (step.source, step.target):
            if place not in range(len(stacks)):
                raise wrong(f"there is no stack{place}; there are {len(stacks)} stacks")
        source, target = step.source, step.target
        if not stacks[source]:
            raise wrong(f"stack{source} is empty")
        block = known(step.block) if step.block else stacks[source][-1]
    else:
        block, below, onto = known(step.block), known(step.below), known(step.onto)
        source, target = place_of(block), place_of(onto)
        level = columns[source].index(block)
        if not level:
            raise wrong(f"{block} is a place")
        if columns[source][level - 1] != below:
            raise wrong(f"{block} is not on {below}, but on {columns[source][level - 1]}")
        if source != target and columns[target][-1] != onto:
            on_it = columns[target][columns[target].index(onto) + 1]
            raise wrong(f"{on_it} stands on {onto}")
    if stacks[source][-1] != block:
        column = columns[source]
        if block not in column:
            raise wrong(f"{block} is on stack{place_of(block)}, not on stack{source}")
        raise wrong(f"{column[column.index(block) + 1]} stands on {block}")
    if source == target:
        raise wrong("it ends where it starts")
    return Move(source, target)
