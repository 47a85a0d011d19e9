# SPDX-License-Identifier: Apache-2.0
"""What goals say beyond what is directly on what, in STRIPS: looked at after the last move.

``look`` ends the moving. Then one step an object finds all spots (a place and a level), from the
first base to the top of the last stack, and one step a relation checks that it holds at the spots
of its two, or counts. What a predicate means comes from :data:`scene_graph.PREDICATES`, spot by
spot, so that every predicate can be told, one of your own too. All these steps come in a fixed
order, and there are as many in every plan: the shortest plans are those with the fewest moves.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from itertools import pairwise
from typing import Final

from scene_graph import PREDICATES, Relation, Spot, Stacks, base_name

from ...goals.goal import Count

TYPES: Final = "spot number-of - object"
PREDICATES_OF_CHECKS: Final = (
    "(moving)",
    "(first-place ?u - base)",
    "(looking-at ?t - thing)",
    "(at ?t - thing ?s - spot)",
    "(higher ?r ?s - spot)  ; the next level of the same place",
    "(then-to ?s - spot ?u - base)  ; the base of the next place",
    "(last-place ?s - spot)",
    "(counted ?n - number-of)",
    "(one-more ?n ?o - number-of)",
)
_SPOTS: Final = "?s ?t - spot"
ACTIONS: Final = """\
  (:action look
    :parameters (?u - base)
    :precondition (and (moving) (first-place ?u))
    :effect (and (not (moving)) (looking-at ?u))
  )
  (:action look-up
    :parameters (?t - thing ?b - block ?s ?r - spot)
    :precondition (and (looking-at ?t) (on ?b ?t) (at ?t ?s) (higher ?r ?s))
    :effect (and (not (looking-at ?t)) (looking-at ?b) (at ?b ?r))
  )
  (:action look-on
    :parameters (?t - thing ?s - spot ?u - base)
    :precondition (and (looking-at ?t) (clear ?t) (at ?t ?s) (then-to ?s ?u))
    :effect (and (not (looking-at ?t)) (looking-at ?u))
  )
  (:action look-back
    :parameters (?t - thing ?s - spot)
    :precondition (and (looking-at ?t) (clear ?t) (at ?t ?s) (last-place ?s))
    :effect (and (not (looking-at ?t)) (question-0))
  )"""


class Checks:
    """What goes into a domain and a problem for some relations and counts.

    Attributes:
        predicates, actions: of the domain, for what is asked.
        constants: blocks and bases that the questions name.
        numbers: that can be counted to, constants as well.
        objects, facts: of the problem.
        goal: what holds after the last question.
    """

    def __init__(
        self,
        called: Mapping[str, str],
        initial: Stacks,
        relations: Sequence[Relation],
        counts: Sequence[Count],
    ) -> None:
        """``called``: the names in PDDL of blocks and bases."""
        self._called = called
        self._places, self._height = len(initial), sum(map(len, initial))
        self._questions = 0
        self.predicates, self.actions = ["(question-0)"], list[str]()
        self.facts = ["(moving)"]
        self._tell_spots()
        counted = [relation for count in counts for relation in count.relations]
        named = dict.fromkeys(
            name for item in (*relations, *counted) for name in (item.subject, item.object)
        )
        self.constants = tuple(named)
        for relation in relations:
            self._ask((_SPOTS, self._at_spots(relation, "true"), ""))
        for count in counts:
            self._ask_count(count)
        for name in dict.fromkeys(item.predicate for item in (*relations, *counted)):
            self._define(name, any(item.predicate == name for item in counted))
        most = max((len(count.relations) for count in counts), default=0)
        numbers = [_number(number) for number in range(most + 1)]
        if counts:
            self.facts += [f"(counted {numbers[0]})"]
            self.facts += [f"(one-more {one} {more})" for one, more in pairwise(numbers)]
        self.numbers = tuple(numbers)
        self.objects = [f"{' '.join(_spot(*spot) for spot in self._spots())} - spot"]
        self.goal = f"(question-{self._questions})"

    def _spots(self) -> list[tuple[int, int]]:
        levels = range(-1, self._height)
        return [(place, level) for place in range(self._places) for level in levels]

    def _tell_spots(self) -> None:
        base = [self._called[base_name(place)] for place in range(self._places)]
        self.facts.append(f"(first-place {base[0]})")
        for place, level in self._spots():
            spot = _spot(place, level)
            if level < 0:
                self.facts.append(f"(at {base[place]} {spot})")
            else:
                self.facts.append(f"(higher {spot} {_spot(place, level - 1)})")
            last = place + 1 == self._places
            self.facts.append(
                f"(last-place {spot})" if last else f"(then-to {spot} {base[place + 1]})"
            )

    def _at_spots(self, relation: Relation, truth: str) -> str:
        subject, object_ = self._called[relation.subject], self._called[relation.object]
        return f"(at {subject} ?s) (at {object_} ?t) ({truth}-{relation.predicate} ?s ?t)"

    def _ask(self, *answers: tuple[str, str, str]) -> None:
        """A question that one of these answers: parameters, precondition, further effect."""
        number = self._questions
        for index, (parameters, answer, effect) in enumerate(answers):
            self.actions.append(f"""\
  (:action check-{number}-{index}
    :parameters ({parameters})
    :precondition (and (question-{number}) {answer})
    :effect (and (not (question-{number})) (question-{number + 1}){effect})
  )""")
        self._questions += 1
        self.predicates.append(f"(question-{self._questions})")

    def _ask_count(self, count: Count) -> None:
        """A question a relation, which counts, and one for the number in the end."""
        more = f"{_SPOTS} ?n ?o - number-of"
        for relation in count.relations:
            true, false = (self._at_spots(relation, truth) for truth in ("true", "false"))
            self._ask(
                (
                    more,
                    f"{true} (counted ?n) (one-more ?n ?o)",
                    " (not (counted ?n)) (counted ?o)",
                ),
                (_SPOTS, false, ""),
            )
        first = _number(0)
        allowed = range(count.least, min(count.most, len(count.relations)) + 1)
        self._ask(
            *(
                (
                    "",
                    f"(counted {number})",
                    "" if number == first else f" (not (counted {number})) (counted {first})",
                )
                for number in map(_number, allowed)
            )
        )

    def _define(self, name: str, counted: bool) -> None:
        """A predicate's truth at all spots."""
        self.predicates += [f"({truth}-{name} ?s ?t - spot)" for truth in ("true", "false")]
        predicate, spots = PREDICATES[name], self._spots()
        for one in spots:
            for other in spots:
                # What takes no place need not know what to say of one.
                if not predicate.takes_place and -1 in (one[1], other[1]):
                    continue
                if predicate.holds(Spot(*one), Spot(*other)):
                    self.facts.append(f"(true-{name} {_spot(*one)} {_spot(*other)})")
                elif counted:
                    self.facts.append(f"(false-{name} {_spot(*one)} {_spot(*other)})")


def _spot(place: int, level: int) -> str:
    """Level 0 is the base's."""
    return f"spot-{place}-{level + 1}"


def _number(number: int) -> str:
    return f"number-{number}"
