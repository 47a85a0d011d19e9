# SPDX-License-Identifier: Apache-2.0
"""Rules for what is said to what something stands in a relation: "on blue and left of green"."""

from __future__ import annotations

from dataclasses import replace
from typing import Final

from scene_graph import ABOVE, BESIDE, FRONT, LEFT, PREDICATES, Phrase

from ..terms import Kind, Term
from .lattice import Word
from .meaning import Link, Names
from .nominal import INSIDE, UPON, term_of, words_of

_SIDEWAYS: Final = (LEFT, FRONT)


def _relation(w: Word, who: Names, d: Word | None = None) -> Link | None:
    phrase = w.phrase
    assert phrase is not None
    places = [term.is_place or term.words.text in ("it", "they") for term in who.terms]
    if phrase.needs_place and not all(places):
        return None
    if w.text == "->" and any(term.is_place for term in who.terms):
        return None
    if len({term.is_place for term in who.terms}) > 1:
        return None
    if who.denied:  # "on neither red nor blue"
        link = _relation(w, replace(who, denied=False, either=True), d)
        return link and replace(link, denied=True)
    places_too = phrase.predicate.takes_place or (phrase.predicate.name == LEFT and d is None)
    if not places_too and any(term.is_place for term in who.terms):
        return None
    if d is not None and phrase.predicate.name == ABOVE:
        if phrase.needs_place:
            return None
        phrase = UPON._replace(inverse=phrase.inverse)
    adjacent = d is not None and phrase.predicate.name in _SIDEWAYS
    return Link(words_of(w), phrase, who, adjacent=adjacent)


def _sideways(w: Word, who: Names) -> Link | None:
    phrase = Phrase(PREDICATES[LEFT], inverse=w.means == "right")
    return _relation(replace(w, phrase=phrase), who)


def _misused(w: Word, who: Names) -> Link:
    """Read all the same, so that it can be said what is wrong with it."""
    assert w.phrase is not None
    return Link(words_of(w), w.phrase, who)


def _in_place(w: Word, who: Names) -> Link | None:
    if not all(term.is_place for term in who.terms):
        return None
    if who.denied:
        who = replace(who, denied=False, either=True)
        return replace(Link(words_of(w), INSIDE, who), denied=True)
    upon = w.text in ("on", "onto", "upon") or w.text.startswith(("on", "down on"))
    return Link(words_of(w), UPON if upon else INSIDE, who)


def _per_place(p: Term) -> Link:
    return Link(p.words, INSIDE, Names((p,)))


def _at_side(w: Word, t: Word, s: Word) -> Link | None:
    if w.text not in ("on", "in", "at") or t.text != "the" or s.text.startswith("far"):
        return None
    place = term_of(words_of(s, text=f"{s.means} stack"))
    return Link(words_of(w), INSIDE, Names((place,)), how="side")


def _in_place_aside(r: Word, who: Names) -> Link | None:
    if r.phrase is None or r.phrase.predicate.name not in _SIDEWAYS:
        return None
    return Link(words_of(r), r.phrase, who, adjacent=True)


def _in_place_beside(r: Word, who: Names) -> Link | None:
    if r.phrase is None or r.phrase.predicate.name != BESIDE:
        return None
    return Link(words_of(r), r.phrase, who)


def _clear(w: Word) -> Link:
    return Link(words_of(w), how="clear")


def _there(w: Word) -> Link:
    return Link(words_of(w), how="there")


def _off_there(w: Word) -> Link:
    """ "out of that stack"."""
    return Link(words_of(w), how="there", denied=True)


def _at_top(w: Word, p: Term | None = None) -> Link | None:
    return _edge(w, "top", p)


def _at_bottom(w: Word, p: Term | None = None) -> Link | None:
    return _edge(w, "bottom", p)


def _edge(w: Word, how: str, p: Term | None) -> Link | None:
    if p is not None and not (p.is_place or p.words.text == "it"):
        return None
    if p is not None and not p.is_place and w.text.startswith(("on", "up", "right on")):
        return None
    return Link(words_of(w), how=how, names=Names((p,)) if p else None)


def _together(w: Word, who: Names | None = None) -> Link | None:
    if who is not None and (who.either or who.denied):
        return None
    return Link(words_of(w), how="same", names=who)


def _apart(w: Word, who: Names | None = None) -> Link | None:
    if who is None and w.text == "another":
        return None
    return Link(words_of(w), how="different", names=who)


def _compared(w: Word) -> Link:
    return Link(words_of(w), Phrase(PREDICATES[ABOVE], inverse="low" in w.text), how="compared")


def _each_other(r: Word) -> Link | None:
    if r.phrase is not None and r.phrase.predicate.name != BESIDE:
        return None
    return Link(words_of(r), how="each other")


def _not_upon_each_other(w: Word) -> Link:
    return Link(words_of(w), UPON, how="not upon each other")


def _alone(w: Word) -> Link:
    return Link(words_of(w), how="alone")


def _where(w: Word, t: Term) -> Link:
    return Link(words_of(w), how="where", names=Names((t,)))


def _elsewhere(w: Word) -> Link:
    return Link(words_of(w), how="elsewhere")


def _off(w: Word, who: Names) -> Link | None:
    if who.either or who.denied or any(term.kind is Kind.NO for term in who.terms):
        return None
    place = all(term.is_place for term in who.terms)
    return Link(words_of(w), INSIDE if place else UPON, who, denied=True)


def _away(w: Word, p: Term) -> Link:
    return Link(words_of(w), INSIDE, Names((p,)), denied=True)


def _lower(w: Word, who: Names) -> Link:
    return Link(words_of(w), Phrase(PREDICATES[ABOVE], inverse=True), who)


def _closely(to: Link) -> tuple[Link, ...] | None:
    """ "above blue, with nothing between"."""
    if to.phrase is None or to.denied or to.phrase.needs_place or to.phrase.predicate.name != ABOVE:
        return None
    return (replace(to, phrase=UPON._replace(inverse=to.phrase.inverse)),)


def _next_door(to: Link) -> tuple[Link, ...] | None:
    """ "left of blue, in the very next stack"."""
    if to.phrase is None or to.denied or to.how or to.phrase.predicate.name not in _SIDEWAYS:
        return None
    return (replace(to, adjacent=True),)


def _higher(w: Word, who: Names) -> Link:
    return Link(words_of(w), Phrase(PREDICATES[ABOVE]), who)


def _on_its_side(to: Link, s: Word) -> tuple[Link, ...] | None:
    """ "beside blue, on its left"."""
    beside = to.phrase is not None and to.phrase.predicate.name == BESIDE
    if not beside or s.means not in ("left", "right"):
        return None
    return (to, replace(to, phrase=Phrase(PREDICATES[LEFT], inverse=s.means == "right")))


def _denied(to: Link) -> Link | None:
    if to.adjacent or to.denied or to.how in ("alone", "where"):
        return None
    return replace(to, denied=True)


def _stays_off(o: Link) -> Link | None:
    return o if o.words.text in ("off", "off of", "out of") else None


def _chain(to: Link, m: tuple[Link, ...], w: Word | None = None) -> tuple[Link, ...] | None:
    if w is not None:
        block = to.names is not None and not to.names.terms[0].is_place and not to.how
        return (to, replace(m[0], chained=True), *m[1:]) if block else None
    if to.names is None and to.how not in ("alone",):
        # "at the top in stack1", "together in stack1"
        return (to, *m) if m[0].names and to.how in ("top", "bottom", "same", "there") else None
    if m[0].how in ("alone", "top", "bottom", "there"):
        return (to, *m)
    chained = to.how != "alone" and not (to.names and to.names.terms[0].is_place)
    return (to, replace(m[0], chained=chained), *m[1:])


def _and(
    to: Link, m: tuple[Link, ...] = (),
    o: tuple[Link, ...] = (),
) -> tuple[Link, ...] | None:  # fmt: skip
    rest = m or o
    if to.how == "there":
        return None
    return (to, *rest)


def _not_directly(to: Link) -> tuple[Link, ...] | None:
    if to.phrase is None or to.phrase.predicate.name != ABOVE or to.phrase.needs_place:
        return None
    return (to, replace(to, phrase=UPON._replace(inverse=to.phrase.inverse), denied=True))


def _or(to: Link, m: tuple[Link, ...]) -> tuple[Link, ...]:
    return (replace(to, how=to.how or "or"), *m)


def _neither(to: Link, m: Link) -> tuple[Link, ...]:
    return (replace(to, denied=True), replace(m, denied=True))


def _neither_of(w: Word, levels: Term, m: Term) -> tuple[Link, ...]:
    return (Link(words_of(w), w.phrase, Names((levels, m)), denied=True),)


def _corrected_place(to: Link, p: Term) -> tuple[Link, ...] | None:
    place = to.names is not None and all(term.is_place for term in to.names.terms)
    return (replace(to, names=Names((p,))),) if place and not to.how else None
