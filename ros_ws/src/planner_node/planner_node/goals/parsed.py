# SPDX-License-Identifier: Apache-2.0
"""Relations as they were read, whose names are not yet resolved."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from itertools import permutations

from scene_graph import ABOVE, LEFT, PREDICATES, UP, Phrase

from .terms import Kind, Term, Words


@dataclass(frozen=True)
class ParsedRelation:
    """A relation whose names are not yet resolved; subject and object as they were written.

    Attributes:
        negated: it must not hold.
    """

    subject: Term
    phrase: Phrase
    object: Term
    negated: bool = False


@dataclass(frozen=True)
class Changed:
    """A change of how the blocks stand now.

    Attributes:
        kind: ``swap``, ``keep``, ``turn`` (upside down), ``same`` (all stays), ``shift``.
        terms: of whom; empty for everything.
        steps: of a shift, to the right.
    """

    kind: str
    words: Words
    terms: tuple[Term, ...] = ()
    steps: int = 0


Said = ParsedRelation | Changed


@dataclass(frozen=True)
class Parsed:
    """What a text says.

    Attributes:
        readings: the ways to read it that are as good as one another; mostly it is one.
    """

    readings: tuple[tuple[Said, ...], ...]

    @property
    def block_names(self) -> tuple[Words, ...]:
        """The blocks that the first reading names one by one."""
        found: list[Words] = []
        for item in self.readings[0]:
            terms = item.terms if isinstance(item, Changed) else (item.subject, item.object)
            for term in terms:
                others = term.described.others if term.described is not None else ()
                found += [
                    one.words
                    for one in (*others, *(() if term.described else (term,)))
                    if one.kind is Kind.THE and not one.is_place
                ]
        return tuple(found)


def in_one_place(blocks: Sequence[Term], same: bool, denied: bool) -> list[ParsedRelation] | None:
    """The relations of "red and blue in the same stack", or in different ones.

    Returns:
        None where it is not clear what is meant: of three that are not in the same stack, two may
        be.
    """
    if len(blocks) == 1 and blocks[0].kind is Kind.EVERY and not blocks[0].is_place:
        if denied and blocks[0].exact != 2:
            return None
        blocks = [blocks[0], blocks[0]]  # "the red ones in the same stack"
    elif (
        len(blocks) < 2
        or any(term.kind is not Kind.THE or term.is_place for term in blocks)
        or (len(blocks) > 2 and denied)
    ):
        return None
    # In one stack are those of which none is left of the other.
    predicate = PREDICATES[LEFT if same != denied else ABOVE]
    return [
        ParsedRelation(one, Phrase(predicate), other, negated=True)
        for one, other in permutations(blocks, 2)
    ]


def none_but(
    subjects: Sequence[Term], phrase: Phrase, denied: bool, object_: Term
) -> ParsedRelation | None:
    """That nothing but the subjects has a relation: "only red in stack1"; None: it is not clear."""
    if denied or any(term.kind is not Kind.THE for term in subjects) or not object_.is_place:
        return None
    others = Term(Words("block", subjects[0].words.offset), Kind.EVERY, but=tuple(subjects))
    if phrase.predicate.name == UP:
        phrase = Phrase(PREDICATES[ABOVE])  # "only red on stack1"
    return ParsedRelation(others, phrase, object_, negated=True)
