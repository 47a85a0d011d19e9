# SPDX-License-Identifier: Apache-2.0
"""Rules for clauses with a verb: who shall stand in which relation."""

from __future__ import annotations

from dataclasses import replace

from ..terms import Kind, Term, Words
from .lattice import Word
from .meaning import Link, Names, Relate
from .nominal import INSIDE, UPON, of_these, term_of, words_of
from .verbal import Verb, asked, before, only_of, relate


def _with_verb(
    s: Names, to: tuple[Link, ...], v: Verb | None = None, wished: bool = False
) -> Relate | None:
    if v and v.may and not v.denied and all(term.only for term in s.terms):
        return _only(Names(tuple(replace(term, only=False) for term in s.terms)), to, "only", v)
    if before(to, s) and (to[0].denied or s.terms[0].words.text == "it"):
        return None
    return relate(s, to, v) if asked(v, s, wished) else None


def _there_with(
    m: tuple[Link, ...], s: Names, v: Verb, to: tuple[Link, ...], wished: bool = False
) -> Relate | None:
    if not asked(v, s, wished) or v.denied or len(m) > 1 or m[0].denied or m[0].names is None:
        return None
    return Relate(s, (*m, *to)) if m[0].names.terms[0].is_place else None


def _which(s: Names, v: Verb, m: tuple[Link, ...], u: Verb, to: tuple[Link, ...]) -> Relate | None:
    if v.denied or u.denied or v.may or u.may or v.past or u.past:
        return None
    return Relate(s, (*m, *to)) if m[0].how == "clear" else None


def _without_subject(v: Verb, to: tuple[Link, ...], wished: bool = False) -> Relate | None:
    return relate(None, to, v) if asked(v, None, wished) and not v.floats else None


def _share(
    s: Names, v: Verb | None = None, o: Names | None = None, p: Term | None = None,
    wished: bool = False,
) -> Relate | None:  # fmt: skip
    link = Link(s.terms[0].words, how="same", names=o)
    if p is not None:
        link = Link(p.words, INSIDE, Names((p,)))
    return relate(s, (link,), v) if asked(v, s, wished) else None


def _among_them(
    s: Names, v: Verb | None = None, n: Word | None = None, wished: bool = False
) -> Relate | None:
    """ "three blocks in stack1, red among them"."""
    if (v and v.denied) or not asked(v, s, wished) or any(term.is_place for term in s.terms):
        return None
    return Relate(s, (Link(s.terms[0].words, how="there"),), denied=n is not None)


def _neither_of_them(s: Names, to: tuple[Link, ...], v: Verb | None = None) -> Relate | None:
    """ "blue and green: neither may be on red"."""
    if len(s.terms) < 2 or s.either or s.denied or (v and (v.denied or v.past)):
        return None
    return Relate(replace(s, denied=True), to)


def _some_of_them(
    s: Names, q: tuple[int, int | None], to: tuple[Link, ...], v: Verb | None = None
) -> Relate | None:
    """ "red, blue and green: at least one of them in stack 0"."""
    term = of_these(q, s)
    return relate(Names((term,)), to, v) if term and asked(v, Names((term,)), False) else None


def _nor(s: Names, to: tuple[Link, ...]) -> Relate | None:
    """ "nor shall any other block be above it"."""
    plain = all(term.kind in (Kind.THE, Kind.COUNT) for term in s.terms)
    return relate(s, to, Verb(denied=True)) if plain and len(s.terms) == 1 else None


def _different_for(s: Names) -> Relate:
    return Relate(s, (Link(s.terms[0].words, how="different"),))


def _no_two(n: tuple[Words, bool], v: Verb | None = None) -> Relate | None:
    if v and v.denied:
        return None
    return Relate(Names((term_of(n[0], Kind.EVERY),)), (Link(n[0], how="different"),))


def _edge_is(e: Link, b: Names, v: Verb | None = None, wished: bool = False) -> Relate | None:
    denied = v is not None and v.denied
    if len(b.terms) > 1 or b.terms[0].kind is not Kind.THE or b.terms[0].is_place or denied:
        return None
    return Relate(b, (e,)) if asked(v, b, wished) else None


def _what(to: tuple[Link, ...], v: Verb, s: Names, wished: bool = False) -> Relate | None:
    if v.denied or not asked(v, s, wished) or any(term.kind is not Kind.THE for term in s.terms):
        return None
    return None if s.either or s.denied else Relate(s, to)


def _what_stands(to: tuple[Link, ...], v: Verb, s: Names) -> Relate | None:
    """ "the block on green should be yellow"; "the one below" may be any that is there."""
    if len(to) > 1 or to[0].phrase is None or to[0].phrase.predicate != UPON.predicate:
        return None
    return _what(to, v, s)


def _on_which(r: Word, t: Names, v: Verb, s: Names) -> Relate | None:
    if v.denied or v.may or s.either or t.either:
        return None
    return Relate(t, (Link(words_of(r), r.phrase, s),))


def _except_for(
    s: Names, to: tuple[Link, ...], e: Names, v: Verb | None = None, wished: bool = False
) -> Relate | None:
    none = s.terms[0].kind is Kind.NO and len(s.terms) == 1
    if none and v and v.may and not v.denied and not s.terms[0].but:
        # Those that are left out may be there, and need not.
        return relate(Names((replace(s.terms[0], but=e.terms),)), to)
    names = but(s, e)
    return relate(names, to, v) if names and asked(v, s, wished) else None


def _only(
    s: Names, to: tuple[Link, ...], o: Word | str, v: Verb | None = None, wished: bool = False
) -> Relate | None:
    if (v and v.denied) or s.either or s.denied or len(to) > 1 or to[0].denied:
        return None
    if v and v.may and all(term.kind is Kind.THE for term in s.terms):
        nothing = term_of(Words("block", 0, 0), Kind.NO, least=0, most=0, but=s.terms)
        return Relate(Names((nothing,)), to)
    if any(term.is_place for term in s.terms) or not asked(v, s, wished):
        return None
    if all(term.kind is Kind.COUNT for term in s.terms):
        return Relate(s, to) if len(s.terms) == 1 else None
    return Relate(only_of(s, o), to)


def but(s: Names, e: Names) -> Names | None:
    """ "all in stack1 except red" with those that are left out; None: it is not said of all."""
    if len(s.terms) != 1 or s.terms[0].kind not in (Kind.EVERY, Kind.NO) or s.terms[0].but:
        return None
    if any(term.kind not in (Kind.THE, Kind.EVERY) for term in e.terms) or e.denied:
        return None
    if s.terms[0].kind is Kind.NO and all(term.kind is Kind.THE for term in e.terms):
        return only_of(e, "only")
    return Names((replace(s.terms[0], but=e.terms, bare=False),))


def _must() -> Verb:
    return Verb()


def _must_not() -> Verb:
    return Verb(denied=True)


def _top_edge(w: Word, p: Term) -> Link | None:
    return Link(words_of(w), how="top", names=Names((p,))) if p.is_place else None


def _bottom_edge(w: Word, p: Term) -> Link | None:
    return Link(words_of(w), how="bottom", names=Names((p,))) if p.is_place else None
