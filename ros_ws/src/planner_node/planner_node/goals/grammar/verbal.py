# SPDX-License-Identifier: Apache-2.0
"""What verbs say: that it is so, is not, may be, or was."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace
from itertools import pairwise
from typing import Final

from ..language import PLACE_NOUNS
from ..terms import Kind, Term
from .lattice import Word
from .meaning import Link, Names, Relate
from .nominal import term_of, words_of

#: Behind "not", what need not be so.
_NEED: Final = frozenset({"has to", "have to", "needs to", "need to", "had to", "need"})


@dataclass(frozen=True)
class Verb:
    """What the words of a verb say: it is denied, it may be, it was."""

    denied: bool = False
    may: str = ""
    past: bool = False
    floats: bool = False


def _verb(w: Sequence[tuple[str, Word]]) -> Verb | None:
    kinds = [kind for kind, _ in w]
    if kinds.count("not") > 1 or len(w) > 6 or kinds == ["not"]:
        return None
    if "not" in kinds and "all" in kinds[kinds.index("not") :]:
        return None  # "not both": none, or one of them?
    for (kind, _), (_, word) in pairwise(w):
        if kind == "not" and word.text in _NEED:
            return None
    if ("not", "have") in {(kind, after.text) for (kind, _), (_, after) in pairwise(w)}:
        return None  # "should not have put"
    floats = "all" in kinds[:1] or ("all" in kinds and w[0][1].text == "keep")
    may = "may" if "may" in kinds else "can" if "can" in kinds else ""
    return Verb("not" in kinds, may, "past" in kinds, floats)


def asked(v: Verb | None, s: Names | None, wished: bool) -> bool:
    """Whether it is asked for: what is only allowed is not, nor is what was so."""
    if v is None:
        return True
    if v.past and not wished:
        return False
    none = s is not None and (s.denied or all(map(_bounded, s.terms)))
    return not v.may or v.denied or none or (wished and v.may == "can")


def _bounded(term: Term) -> bool:
    """Whether no more than so many are spoken of: "at most one block may stay"."""
    return term.kind is Kind.NO or (term.kind is Kind.COUNT and not term.least)


def relate(
    s: Names | None, to: tuple[Link, ...], v: Verb | None = None, bare: bool = False
) -> Relate | None:
    """That a subject has relations, or has not; None: it is not clear how many have."""
    denied = bool(v and v.denied)
    if denied and s is not None and len(s.terms) == 1 and s.terms[0].kind is Kind.COUNT:
        fewer = denied_count(s.terms[0])
        return Relate(Names((fewer,)), to) if fewer is not None else None
    return Relate(s, to, denied, bare)


def denied_count(one: Term) -> Term | None:
    """ "not at least two" as "at most one"; None: it is not clear how many may be."""
    if (one.least, one.most) == (1, None):
        return replace(one, kind=Kind.NO, least=0, most=0)
    if one.most is None:
        return replace(one, least=0, most=one.least - 1)
    if one.least == 0:
        return replace(one, least=one.most + 1, most=None)
    return None


def is_place(term: Term) -> bool:
    """Whether it is a place, or the word for one."""
    return term.is_place or term.words.text in PLACE_NOUNS


def only_of(s: Names, x: Word | str) -> Names:
    """Them and nothing else."""
    if isinstance(x, Word) and x.text in ("nothing", "other", "others"):
        nothing = term_of(words_of(x, text="block"), Kind.NO, least=0, most=0, others=True)
        return Names((*s.terms, nothing))
    return replace(s, terms=tuple(replace(one, only=True) for one in s.terms))


def before(to: tuple[Link, ...], s: Names) -> bool:
    """Whether the relation is told before its subject."""
    return to[0].words.offset < s.terms[0].words.offset
