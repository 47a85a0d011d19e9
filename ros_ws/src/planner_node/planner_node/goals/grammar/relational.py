# SPDX-License-Identifier: Apache-2.0
"""Rules for what is said to what something stands in a relation: "on blue and left of green"."""

from __future__ import annotations

from dataclasses import replace
from typing import Final

from scene_graph import ABOVE, BESIDE, FRONT, LEFT

from ..terms import Kind, Term
from .lattice import Word
from .meaning import Link, Names
from .nominal import INSIDE, UPON, rule, term_of, words_of

_SIDEWAYS: Final = (LEFT, FRONT)


@rule("PLAINLINK", "w:RELATION l:LISTED")
@rule("PLAINLINK", "d:DIRECTLY w:RELATION l:LISTED", cost=0.1)
def _relation(w: Word, l: Names, d: Word | None = None) -> Link | None:
    phrase = w.phrase
    assert phrase is not None
    places = [term.is_place or term.words.text in ("it", "they") for term in l.terms]
    if phrase.needs_place and not all(places):
        return None
    if len({term.is_place for term in l.terms}) > 1:
        return None
    if not phrase.predicate.takes_place and any(term.is_place for term in l.terms):
        return None
    if d is not None and phrase.predicate.name == ABOVE:
        if phrase.needs_place:
            return None
        phrase = UPON._replace(inverse=phrase.inverse)
    adjacent = d is not None and phrase.predicate.name in _SIDEWAYS
    return Link(words_of(w), phrase, l, adjacent=adjacent)


@rule("PLAINLINK", "w:RELATION l:LISTED", cost=1.9)
def _misused(w: Word, l: Names) -> Link:
    """Read all the same, so that it can be said what is wrong with it."""
    assert w.phrase is not None
    return Link(words_of(w), w.phrase, l)


@rule("PLAINLINK", "w:INPLACE l:LISTED", cost=0.1)
def _in_place(w: Word, l: Names) -> Link | None:
    if not all(term.is_place for term in l.terms):
        return None
    upon = w.text in ("on", "onto", "upon") or w.text.startswith(("on", "down on"))
    return Link(words_of(w), UPON if upon else INSIDE, l)


@rule("PLAINLINK", "p:ALLPLACES", "p:PERPLACE", cost=0.3)
def _per_place(p: Term) -> Link:
    return Link(p.words, INSIDE, Names((p,)))


@rule("PLAINLINK", "w:INPLACE t:THE s:SIDE END?", cost=1.0)
def _at_side(w: Word, t: Word, s: Word) -> Link | None:
    if w.text not in ("on", "in", "at") or t.text != "the" or s.text.startswith("far"):
        return None
    place = term_of(words_of(s, text=f"{s.means} stack"))
    return Link(words_of(w), INSIDE, Names((place,)), how="side")


@rule("PLAINLINK", "INPLACE THE PLACENOUN d:DIRECTLY r:RELATION l:LISTED")
def _in_place_aside(d: Word, r: Word, l: Names) -> Link | None:
    if r.phrase is None or r.phrase.predicate.name not in _SIDEWAYS:
        return None
    return Link(words_of(r), r.phrase, l, adjacent=True)


@rule("PLAINLINK", "INPLACE THE PLACENOUN r:RELATION l:LISTED", "INPLACE THE PLACENOUN WHICH BE r:RELATION l:LISTED", "INPLACE A PLACENOUN r:RELATION l:LISTED")
def _in_place_beside(r: Word, l: Names) -> Link | None:
    if r.phrase is None or r.phrase.predicate.name != BESIDE:
        return None
    return Link(words_of(r), r.phrase, l)


@rule("PLAINLINK", "w:CLEAR")
def _clear(w: Word) -> Link:
    return Link(words_of(w), how="clear")


@rule("PLAINLINK", "w:THERE")
def _there(w: Word) -> Link:
    return Link(words_of(w), how="there")


@rule("PLAINLINK", "w:ATTOP", "w:ATTOP INOF p:TERM", "w:TOPOF p:TERM")
def _at_top(w: Word, p: Term | None = None) -> Link | None:
    return _edge(w, "top", p)


@rule("PLAINLINK", "w:ATBOTTOM", "w:ATBOTTOM INOF p:TERM", "w:BOTTOMOF p:TERM")
def _at_bottom(w: Word, p: Term | None = None) -> Link | None:
    return _edge(w, "bottom", p)


def _edge(w: Word, how: str, p: Term | None) -> Link | None:
    if p is not None and not (p.is_place or p.words.text == "it"):
        return None
    if p is not None and not p.is_place and w.text.startswith(("on", "up")):
        return None
    return Link(words_of(w), how=how, names=Names((p,)) if p else None)


@rule("SAMEPLACE", "INPLACE THE? w:SAME PLACENOUN", "TOGETHER INPLACE w:A PLACENOUN", "INPLACE w:A 'single' PLACENOUN", "w:TOGETHER", "TOGETHER INPLACE THE? w:SAME PLACENOUN")
def _same_place(w: Word) -> Word:
    return w


@rule("PLAINLINK", "w:SAMEPLACE",
      "INPLACE THE? w:SAME PLACENOUN AS l:LISTED", "w:TOGETHER 'with' l:LISTED", "INPLACE THE? w:SAME PLACENOUN 'with' l:LISTED")  # fmt: skip
def _together(w: Word, l: Names | None = None) -> Link:
    return Link(words_of(w), how="same", names=l)


@rule("PLAINLINK", "INPLACE w:DIFFERENT PLACENOUNS", "INPLACE w:DIFFERENT PLACENOUN",
      "INPLACE A? w:DIFFERENT PLACENOUN AS l:LISTED", "INPLACE A? w:DIFFERENT PLACENOUN OFF l:LISTED")  # fmt: skip
def _apart(w: Word, l: Names | None = None) -> Link | None:
    if l is None and w.text == "another":
        return None
    return Link(words_of(w), how="different", names=l)


@rule("PLAINLINK", "r:RELATION EACHOTHER", "r:NEIGHBORS")
def _each_other(r: Word) -> Link | None:
    if r.phrase is not None and r.phrase.predicate.name != BESIDE:
        return None
    return Link(words_of(r), how="each other")


@rule("PLAINLINK", "w:ALONE", cost=0.6)
def _alone(w: Word) -> Link:
    return Link(words_of(w), how="alone")


@rule("PLAINLINK", "INPLACE? w:WHERE t:BLOCK BE NOW?", "INPLACE? w:WHERE t:BLOCK NOW BE", "INPLACE? w:WHERE t:BLOCK PAST NOW?")
def _where(w: Word, t: Term) -> Link:
    return Link(words_of(w), how="where", names=Names((t,)))


@rule("PLAINLINK", "w:ELSEWHERE")
def _elsewhere(w: Word) -> Link:
    return Link(words_of(w), how="elsewhere")


@rule("OFFLINK", "w:OFF l:LISTED")
def _off(w: Word, l: Names) -> Link | None:
    if l.either or l.denied or any(term.kind is Kind.NO for term in l.terms):
        return None
    place = all(term.is_place for term in l.terms)
    return Link(words_of(w), INSIDE if place else UPON, l, denied=True)


@rule("LINK", "l:PLAINLINK", "l:PLAINLINK 'either'")
def _plain(l: Link) -> Link:
    return l


@rule("LINK", "NOT l:PLAINLINK", "NOT 'to' BE l:PLAINLINK", "NOT l:PLAINLINK 'either'")
def _denied(l: Link) -> Link | None:
    if l.adjacent or l.how in ("alone", "where"):
        return None
    return replace(l, denied=True)


@rule("LINKS", "m:LINK COMMA? INSTEADOF l:LINK", cost=0.3)
def _instead_of(l: Link, m: Link) -> tuple[Link, ...]:
    return (m,)


@rule("LINK", "o:OFFLINK", cost=0.8)
def _stays_off(o: Link) -> Link | None:
    return o if o.words.text in ("off", "off of", "out of") else None


@rule("LINKS", "l:LINK")
def _one(l: Link) -> tuple[Link, ...]:
    return (l,)


@rule("LINKS", "l:LINK m:LINKS", "l:LINK COMMA? w:WHICH BE m:LINKS", "l:LINK COMMA? w:WHICH MUST BE? m:LINKS", "l:LINK COMMA? w:WHICH BE m:LINKS COMMA")
def _chain(l: Link, m: tuple[Link, ...], w: Word | None = None) -> tuple[Link, ...] | None:
    if w is not None:
        block = l.names is not None and not l.names.terms[0].is_place and not l.how
        return (l, replace(m[0], chained=True), *m[1:]) if block else None
    if l.names is None and l.how not in ("alone",):
        # "at the top in stack1", "together in stack1"
        return (l, *m) if m[0].names and l.how in ("top", "bottom", "same", "there") else None
    if m[0].how in ("alone", "top", "bottom", "there"):
        return (l, *m)
    chained = l.how != "alone" and not (l.names and l.names.terms[0].is_place)
    return (l, replace(m[0], chained=chained), *m[1:])


@rule("LINKS", "l:LINK COMMA? a:AND m:LINKS", "l:LINK COMMA? b:BUT m:LINKS",
      "l:LINK COMMA o:LINKS")  # fmt: skip
def _and(
    l: Link, m: tuple[Link, ...] = (), a: Word | None = None, b: Word | None = None,
    o: tuple[Link, ...] = (),
) -> tuple[Link, ...] | None:  # fmt: skip
    rest = m or o
    if l.how == "there":
        return None
    return (l, *rest)


@rule("LINKS", "l:LINK COMMA? BUT NOTDIRECTLY", "l:LINK COMMA? NOTDIRECTLY", "l:LINK COMMA? AND NOTDIRECTLY",
      "l:LINK COMMA? BUT NOTDIRECTLY PLAINUP 'it'")  # fmt: skip
def _not_directly(l: Link) -> tuple[Link, ...] | None:
    if l.phrase is None or l.phrase.predicate.name != ABOVE or l.phrase.needs_place:
        return None
    return (l, replace(l, phrase=UPON._replace(inverse=l.phrase.inverse), denied=True))


@rule("LINKS", "l:LINK COMMA? OR m:LINKS", "l:LINK COMMA? 'nor' m:LINKS")
def _or(l: Link, m: tuple[Link, ...]) -> tuple[Link, ...]:
    return (replace(l, how=l.how or "or"), *m)


@rule("LINKS", "'neither' l:PLAINLINK COMMA? 'nor' m:PLAINLINK")
def _neither(l: Link, m: Link) -> tuple[Link, ...]:
    return (replace(l, denied=True), replace(m, denied=True))


@rule("LINKS", "'neither' w:RELATION l:TERM 'nor' m:TERM")
def _neither_of(w: Word, l: Term, m: Term) -> tuple[Link, ...]:
    return (Link(words_of(w), w.phrase, Names((l, m)), denied=True),)


@rule("LINKS", "l:LINK CORRECTED m:LINK", cost=0.5)
def _corrected(l: Link, m: Link) -> tuple[Link, ...]:
    return (m,)


