# SPDX-License-Identifier: Apache-2.0
"""Any problem of the planner as PDDL, for the planners of others.

The domain is Blocksworld with one action, ``move``, and a few places. STRIPS with types is all that
most problems need, so that about every planner reads them:

- what is directly on what stands in the goal itself;
- what else a goal says is asked by :mod:`.pddl_checks` once the last move is made;
- ``can-stand`` leaves out what would fall; what stands badly costs more (``:action-costs``);
- moves that the arm cannot make are left out by a precondition (``:adl``).
"""

from __future__ import annotations

import re
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from itertools import pairwise
from typing import TYPE_CHECKING, Final

from scene_graph import UP, Stacks, base_index, base_name

from ...errors import UnknownObjectError
from ...goals.goal import Goal
from ..stability import Stability
from .pddl_checks import ACTIONS, PREDICATES_OF_CHECKS, TYPES, Checks

if TYPE_CHECKING:
    from ..possible import Exclusion

#: What moves cost that put a block where it is unstable: more than the moves that avoid it.
UNSTABLE_PRICE: Final = 1000
#: How the other objects' names begin, see :mod:`.pddl_checks`.
_TAKEN: Final = ("spot-", "number-")


@dataclass(frozen=True)
class PddlProblem:
    """Two files' text, and what the objects in them are called in the scene.

    Attributes:
        domain, problem: the text.
        names: of a block or base, by its name in PDDL.
    """

    domain: str
    problem: str
    names: Mapping[str, str]


def pddl_of(
    initial: Stacks,
    goal: Goal,
    stability: Stability | None = None,
    exclusions: Sequence[Exclusion] = (),
) -> PddlProblem:
    """The problem of a state and a goal; the shortest plans have the same moves as the planner's.

    A plan is a sequence of ``move``; where the goal says more than what is directly on what, as
    many steps follow in every plan, which only look.

    Args:
        stability: None: what stands on what does not matter.
        exclusions: moves that the arm cannot make.

    Raises:
        UnknownObjectError: the goal names what is not in the state.
    """
    blocks = [name for stack in initial for name in stack]
    bases = [base_name(place) for place in range(len(initial))]
    _check_known(goal, blocks, bases)
    called = pddl_names(initial)
    on = [item for item in goal.relations if item.predicate == UP]
    others = [item for item in goal.relations if item.predicate != UP]
    checks = Checks(called, initial, others, goal.counts) if others or goal.counts else None
    prices = _prices(blocks, stability)
    costly = any(price > 1 for price in prices.values())

    facts = [f"(on {called[upper]} {called[lower]})" for upper, lower in _pairs(initial)]
    facts += [
        f"(clear {called[stack[-1] if stack else base]})" for base, stack in zip(bases, initial)
    ]
    for block in blocks:
        for support in [*blocks, *bases]:
            price = prices.get((block, support), 1)
            if support != block and price:
                facts.append(f"(can-stand {called[block]} {called[support]})")
                if costly:
                    facts.append(f"(= (price {called[block]} {called[support]}) {price})")
    if costly:
        facts.append("(= (total-cost) 0)")
    constants = () if checks is None else checks.constants
    objects = _typed([name for name in (*blocks, *bases) if name not in constants], called)
    wanted = [f"(on {called[item.subject]} {called[item.object]})" for item in on]
    if checks is not None:
        objects += checks.objects
        facts += checks.facts
        wanted.append(checks.goal)
    lines = [
        f"; {goal}",
        "(define (problem stacks)",
        "  (:domain places)",
        "  (:objects",
        *(f"    {item}" for item in objects),
        "  )",
        "  (:init",
        *(f"    {item}" for item in facts),
        "  )",
        f"  (:goal (and {' '.join(wanted)}))",
        *(["  (:metric minimize (total-cost))"] if costly else []),
        ")",
    ]
    named = _typed(constants, called)
    if checks is not None:
        named.append(f"{' '.join(checks.numbers)} - number-of")
    domain = _domain(checks, named, costly, [_forbidden(item, called) for item in exclusions])
    back = {pddl: name for name, pddl in called.items()}
    return PddlProblem(domain, "\n".join(lines) + "\n", back)


def pddl_names(stacks: Stacks) -> dict[str, str]:
    """What blocks and bases are called in PDDL: by their own names, where PDDL can have these."""
    called: dict[str, str] = {}
    used: set[str] = set()
    blocks = sorted(name for stack in stacks for name in stack)
    for name in [*map(base_name, range(len(stacks))), *blocks]:
        plain = re.sub(r"[^a-z0-9_-]", "-", name.lower())
        if not plain[:1].isalpha() or plain.startswith(_TAKEN):
            plain = f"block-{plain}"
        one, number = plain, 2
        while one in used:
            one, number = f"{plain}-{number}", number + 1
        used.add(one)
        called[name] = one
    return called


def _typed(names: Sequence[str], called: Mapping[str, str]) -> list[str]:
    """Declarations of blocks and bases."""
    kinds: dict[str, list[str]] = {"block": [], "base": []}
    for name in names:
        kinds["block" if base_index(name) is None else "base"].append(called[name])
    return [f"{' '.join(items)} - {kind}" for kind, items in kinds.items() if items]


def _domain(
    checks: Checks | None, constants: Sequence[str], costly: bool, forbidden: Sequence[str]
) -> str:
    requirements = ":strips :typing"
    requirements += " :adl" if forbidden else ""
    requirements += " :action-costs" if costly else ""
    before = "(on ?b ?from) (clear ?b) (clear ?to) (can-stand ?b ?to)"
    after = "(on ?b ?to) (clear ?from) (not (on ?b ?from)) (not (clear ?to))"
    if checks is not None:
        before += " (moving)"
    if costly:
        after += " (increase (total-cost) (price ?b ?to))"
    functions = [
        "  (:functions",
        "    (total-cost) - number",
        "    (price ?b - block ?t - thing) - number",
        "  )",
    ]
    lines = [
        "(define (domain places)",
        f"  (:requirements {requirements})",
        "  (:types",
        "    thing - object",
        "    block base - thing",
        *([f"    {TYPES}"] if checks is not None else []),
        "  )",
        *(["  (:constants", *(f"    {item}" for item in constants), "  )"] if constants else []),
        "  (:predicates",
        "    (on ?b - block ?t - thing)  ; directly",
        "    (clear ?t - thing)  ; nothing is on it",
        "    (can-stand ?b - block ?t - thing)",
        *((f"    {item}" for item in PREDICATES_OF_CHECKS) if checks is not None else []),
        *((f"    {item}" for item in checks.predicates) if checks is not None else []),
        "  )",
        *(functions if costly else []),
        "  (:action move",
        "    :parameters (?b - block ?from ?to - thing)",
        f"    :precondition (and {before}",
        *(f"      {item}" for item in forbidden),
        "    )",
        f"    :effect (and {after})",
        "  )",
        *([ACTIONS] if checks is not None else []),
        *(checks.actions if checks is not None else []),
        ")",
    ]
    return "\n".join(lines) + "\n"


def _forbidden(item: Exclusion, called: Mapping[str, str]) -> str:
    """That a move is not the excluded one: one of the things that make it so is not true."""
    true = [f"(= ?b {called[item.block]})"]
    standing: list[tuple[str, str]] = []
    for place, under, parameter in (
        (item.source, item.under, "?from"),
        (item.target, item.onto, "?to"),
    ):
        if place is not None:
            column = [base_name(place), *under]
            true.append(f"(= {parameter} {called[column[-1]]})")
            standing += [(upper, lower) for lower, upper in pairwise(column)]
    standing += _pairs(item.state or ())
    true += [f"(on {called[upper]} {called[lower]})" for upper, lower in dict.fromkeys(standing)]
    return f"(or {' '.join(f'(not {one})' for one in true)})"


def _prices(blocks: Sequence[str], stability: Stability | None) -> Mapping[tuple[str, str], int]:
    """What putting a block on another costs where it is not 1; 0: it cannot stand there."""
    if stability is None:
        return {}
    prices = {}
    for block in blocks:
        for support in blocks:
            objection = stability.objection(block, support) if support != block else None
            if objection is not None:
                never = objection.falls or stability.require
                prices[block, support] = 0 if never else UNSTABLE_PRICE
    return prices


def _pairs(stacks: Stacks) -> list[tuple[str, str]]:
    """Who is directly on what."""
    columns = ((base_name(place), *stack) for place, stack in enumerate(stacks))
    return [(upper, lower) for column in columns for lower, upper in pairwise(column)]


def _check_known(goal: Goal, blocks: Sequence[str], bases: Sequence[str]) -> None:
    relations = [*goal.relations, *(one for item in goal.counts for one in item.relations)]
    for name in (name for item in relations for name in (item.subject, item.object)):
        if name not in blocks and name not in bases:
            known = bases if base_index(name) is not None else blocks
            raise UnknownObjectError(
                name, known, f"there is no {name}; there are {', '.join(known)}"
            )
