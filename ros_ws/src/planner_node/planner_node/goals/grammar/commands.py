# SPDX-License-Identifier: Apache-2.0
"""Rules for clauses without a verb of their own, and for commands."""

from __future__ import annotations

from dataclasses import replace

from scene_graph import LEFT

from ..terms import Kind, Term, Words
from .clausal import but
from .lattice import Word
from .meaning import Item, Link, Names, Relate, Take
from .nominal import INSIDE, UPON, counted_after, term_of, words_of
from .verbal import Verb, asked, before, is_place, relate


def _bare(s: Names, to: tuple[Link, ...]) -> Relate | None:
    if before(to, s) and to[0].denied:
        return None
    aside = to[0].phrase is not None and to[0].phrase.predicate.name == LEFT
    every = any(term.kind is Kind.EVERY for term in s.terms)
    if every and (to[0].denied or (aside and s.terms[0].words.text == "block")):
        return None  # "all blocks not in stack1": of whom something else is said?
    if to[0].how == "clear" and any(term.bare for term in s.terms):
        return None  # "nothing in stack 0, all empty"
    return relate(s, to, bare=True)


def _counted_after(k: Word, n: tuple[Words, bool], to: tuple[Link, ...], w: Word) -> Relate | None:
    """ "one block in every stack at least"."""
    return relate(counted_after(k, n, w), to, bare=True)


def _at_place(p: Term, s: Names, to: tuple[Link, ...]) -> Relate | None:
    if to[0].denied or to[0].names is None or to[0].names.terms[0].is_place or before(to, s):
        return None
    return Relate(s, (Link(p.words, INSIDE, Names((p,))), *to), fronted=True)


def _beside_place(p: Term, s: Names | None = None, n: Names | None = None) -> Relate | None:
    s = s or n
    assert s is not None
    if any(is_place(term) for term in s.terms) or s.either:
        return None
    return Relate(s, (Link(p.words, INSIDE, Names((p,))),), bare=True)


def _heading_place(p: Term) -> Term | None:
    """Not "s0:", behind which no one knows what the order means."""
    return None if 0 < p.words.end - p.words.offset < 4 and p.words.text[0] == "s" else p


def _outermost(w: Word) -> Term | None:
    if "most" not in w.text:
        return None
    return term_of(words_of(w, text=f"{w.means} stack"))


def _links_alone(to: tuple[Link, ...]) -> Relate:
    return Relate(None, to, bare=True)


def _command(p: bool, s: Names, to: tuple[Link, ...] = (), e: Link | None = None) -> Relate | None:
    if e is not None:
        return None if p or len(s.terms) > 1 else Relate(s, (e,))
    if before(to, s) and to[0].denied:
        return None
    return relate(s, to, Verb(p))


def _command_of_that(p: bool, s: Names, to: tuple[Link, ...]) -> Relate | None:
    return None if any(one.how == "side" for one in to) else relate(s, to, Verb(p))


def _command_of_topic(s: Names, to: tuple[Link, ...]) -> Relate | None:
    """ "stack 0 I would like to be empty"."""
    return None if before(to, s) else relate(s, to)


def _not_so(s: Names, to: tuple[Link, ...]) -> Relate | None:
    if len(to) > 1 or before(to, s) or any(term.kind is not Kind.THE for term in s.terms):
        return None
    return relate(s, to, Verb(denied=True))


def _one_tower(s: Names) -> Relate | None:
    """ "make one tower with all five blocks"."""
    if len(s.terms) > 1 or s.terms[0].kind is not Kind.EVERY or s.terms[0].is_place:
        return None
    term = replace(s.terms[0], bare=False)
    return Relate(Names((term,)), (Link(term.words, how="same"),))


def _command_of_it(p: bool, to: tuple[Link, ...]) -> Relate | None:
    return None if p else Relate(None, to)


def _puts(w: Word) -> bool | None:
    return None if w.text == "make" else False


def _clear_it(s: Names, w: Word) -> Relate | None:
    return Relate(s, (Link(words_of(w), how="clear"),))


def _upon_that(w: Word) -> Word | None:
    return w if w.phrase in (None, UPON) or w.text in ("above", "over") else None


def _cover(n: bool, s: Names, o: Names) -> Relate | None:
    if s.either or o.either or any(term.is_place for term in (*s.terms, *o.terms)):
        return None
    return Relate(o, (Link(s.terms[0].words, UPON, s),), n, about=True)


def _covers(n: Word | None = None) -> bool:
    return n is not None


def _take(s: Names) -> Take | None:
    if s.either or any(term.is_place for term in s.terms):
        return None
    return Take(s)


def _put_off(s: Names, o: Link) -> Item | None:
    return None if o.words.text == "from" else _take_off(s, o)  # to where?


def _take_off(s: Names, o: Link) -> Item | None:
    if s.either or any(term.is_place for term in s.terms):
        return None
    if any(term.kind is Kind.COUNT for term in s.terms):
        return None
    return Take(s, o)


def _take_from_to(s: Names, o: Link, to: tuple[Link, ...]) -> Relate | None:
    if any(one.denied for one in to) or s.either:
        return None
    if "from" in o.words.text:
        return None
    return Relate(s, (o, *to))


def _comes_off(s: Names, o: Link, v: Verb | None = None) -> Item | None:
    if (v and not asked(v, s, False)) or (v and v.denied) or "off" not in o.words.text:
        return None
    return _take_off(s, o)


def _anywhere_but(s: Names, to: Link) -> Relate | None:
    return None if s.either or to.denied else Relate(s, (replace(to, denied=True),))


def _not_there(to: Link | None = None, p: Term | None = None) -> Link | None:
    return to if p is None else Link(p.words, INSIDE, Names((p,)))


def _put_but(s: Names, to: tuple[Link, ...], e: Names) -> Relate | None:
    names = but(s, e)
    return Relate(names, to) if names is not None else None
