# SPDX-License-Identifier: Apache-2.0
"""Rules for what something has: "stack 1 has two blocks", "red has blue on it"."""

from __future__ import annotations

from dataclasses import replace

from scene_graph import LEFT, PREDICATES, Phrase

from ..terms import Kind, Term, Words
from .lattice import Word
from .meaning import Link, Names, Relate
from .nominal import INSIDE, UPON, term_of, words_of
from .verbal import Verb, asked, denied_count, is_place, only_of, relate


def _has(
    s: Names, o: Names | None = None, v: Verb | None = None, x: Word | None = None,
    wished: bool = False, k: Word | None = None,
) -> Relate | None:  # fmt: skip
    if o is None:
        assert k is not None
        more = term_of(Words("block", 0, 0), Kind.COUNT, least=int(k.means) + 1)
        o = Names((more,))
    if not all(is_place(term) for term in s.terms) or s.either:
        return None
    # "stack 0 can take two at most": that is all that it can.
    if any(term.is_place for term in o.terms) or not (asked(v, s, wished) or asked(v, o, wished)):
        return None
    if x is not None:
        if any(term.kind is not Kind.THE for term in o.terms):
            return None
        o = only_of(o, x)
    return has_them(s, o, v, Link(s.terms[0].words, INSIDE, s))


def _has_on_it(
    s: Names, o: Names, p: Link, v: Verb | None = None, wished: bool = False
) -> Relate | None:
    if any(term.is_place for term in (*s.terms, *o.terms)) or s.either:
        return None
    return has_them(s, o, v, replace(p, names=s)) if asked(v, s, wished) else None


def _has_at_end(
    s: Names, o: Names, top: Word | None = None, bottom: Word | None = None,
    v: Verb | None = None, wished: bool = False,
) -> Relate | None:  # fmt: skip
    if not all(is_place(term) for term in s.terms) or len(s.terms) > 1 or (v and v.denied):
        return None
    how = "bottom" if bottom else "top"
    edge = Link(words_of(top, bottom), how=how, names=s)
    return Relate(o, (edge,)) if asked(v, s, wished) else None


def _covered(s: Names, o: Names, v: Verb | None = None, wished: bool = False) -> Relate | None:
    if s.either or not asked(v, s, wished) or any(term.is_place for term in (*s.terms, *o.terms)):
        return None
    return has_them(s, o, v, Link(s.terms[0].words, UPON, s))


def _number_of(
    n: tuple[Words, bool], to: tuple[Link, ...], q: tuple[int, int | None],
    v: Verb | None = None, wished: bool = False,
) -> Relate | None:  # fmt: skip
    number = Names((term_of(n[0], Kind.COUNT, least=q[0], most=q[1]),))
    return relate(number, to, v) if asked(v, number, wished) and len(to) == 1 else None


def _number_at(
    p: Term, n: tuple[Words, bool], q: tuple[int, int | None], v: Verb | None = None,
    wished: bool = False,
) -> Relate | None:  # fmt: skip
    return _number_of(n, (Link(p.words, INSIDE, Names((p,))),), q, v, wished)


def _at_most_high(s: Names, k: Word, v: Verb | None = None, wished: bool = False) -> Relate | None:
    return _has(s, _amounted((0, int(k.means))), v, wished=wished)


def _forbidden(p: Names, s: Names) -> Relate | None:
    if s.either or any(term.is_place or term.kind is Kind.NO for term in s.terms):
        return None
    return Relate(s, (Link(p.terms[0].words, INSIDE, p, denied=True),))


def _clear_of(s: Names, o: Names) -> Relate | None:
    """ "keep stack 1 clear of green"."""
    if s.either or o.either or any(t.is_place or t.kind in (Kind.NO, Kind.COUNT) for t in o.terms):
        return None
    place = all(is_place(term) for term in s.terms)
    return Relate(o, (Link(s.terms[0].words, INSIDE if place else UPON, s, denied=True),))


def _its(s: Names, p: Link) -> Relate | None:
    """ "green has yellow to its left and red to its right": what goes on with the other side."""
    if p.phrase is None or p.phrase.predicate.name != LEFT:
        return None
    it = term_of(replace(p.words, text="it"))
    return Relate(s, (replace(p, names=Names((it,))),), about=True)


def _no_place_has(s: Names, o: Names) -> Relate | None:
    """ "no pile over two high"."""
    if len(s.terms) != 1 or s.terms[0].kind is not Kind.NO or s.terms[0].words.text != "stack":
        return None
    return has_them(s, o, None, Link(s.terms[0].words, INSIDE, s))


def has_them(s: Names, o: Names, v: Verb | None, to: Link) -> Relate | None:
    """That something has others, said of these."""
    denied = bool(v and v.denied)
    if s.denied:
        s, denied = replace(s, denied=False), not denied
    if len(s.terms) == 1 and s.terms[0].kind is Kind.NO:
        if any(term.kind is Kind.COUNT and not term.least for term in o.terms):
            return None  # "no stack has at most two"
        every = replace(s.terms[0], kind=Kind.EVERY, least=1, most=None)
        s, denied = Names((every,)), not denied
    to = replace(to, names=s)
    if denied and len(o.terms) == 1 and o.terms[0].kind is Kind.COUNT:
        fewer = denied_count(o.terms[0])
        if fewer is None:
            return None
        o, denied = Names((fewer,)), False
    if o.either and not denied:
        return None
    return Relate(o, (to,), denied, about=True)


def _amounted(q: tuple[int, int | None]) -> Names:
    words = Words("block", 0, 0)
    if q[1] == 0:
        return Names((term_of(words, Kind.NO, least=0, most=0),))
    return Names((term_of(words, Kind.COUNT, least=q[0], most=q[1]),))


def _its_phrase(w: Word) -> Link | None:
    phrase = w.phrase or UPON
    return None if phrase.needs_place else Link(words_of(w), phrase)


def _its_side(s: Word) -> Link | None:
    if s.text not in ("left", "right"):
        return None
    return Link(words_of(s), Phrase(PREDICATES[LEFT], inverse=s.text == "right"))
