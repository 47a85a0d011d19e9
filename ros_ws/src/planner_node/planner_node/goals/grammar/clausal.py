# SPDX-License-Identifier: Apache-2.0
"""Rules for clauses: who shall stand in which relation, said with and without verbs."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace
from itertools import pairwise
from typing import Final

from scene_graph import LEFT, PREDICATES, Phrase

from ..language import PLACE_NOUNS
from ..terms import Kind, Term, Words
from .lattice import Word
from .meaning import Item, Link, Names, Relate, Take
from .nominal import INSIDE, UPON, term_of, words_of

#: Behind "not", what need not be so.
_NEED: Final = frozenset({"has to", "have to", "needs to", "need to", "had to", "need"})


@dataclass(frozen=True)
class Verb:
    """What the words of a verb say: it is denied, it may be, it was."""

    denied: bool = False
    may: str = ""
    past: bool = False
    floats: bool = False


def _verb_word(w: Word) -> tuple[str, str]:
    return "be", w.text


def _float_word(w: Word) -> tuple[str, str]:
    return "all", w.text


def _placed_word(w: Word) -> tuple[str, str]:
    return "placed", w.text


def _not_word(w: Word) -> tuple[str, str]:
    return "not", w.text


def _may_word(w: Word) -> tuple[str, str]:
    return "may", w.text


def _can_word(w: Word) -> tuple[str, str]:
    return "can", w.text


def _past_word(w: Word) -> tuple[str, str]:
    return "past", w.text


def _verb(w: Sequence[tuple[str, str]]) -> Verb | None:
    kinds = [kind for kind, _ in w]
    if kinds.count("not") > 1 or len(w) > 6 or kinds == ["not"]:
        return None
    for (kind, _), (_, text) in pairwise(w):
        if kind == "not" and text in _NEED:
            return None
    if ("not", "have") in {(kind, after) for (kind, _), (_, after) in pairwise(w)}:
        return None  # "should not have put"
    may = "may" if "may" in kinds else "can" if "can" in kinds else ""
    return Verb("not" in kinds, may, "past" in kinds, set(kinds) == {"all"})


def _asked(v: Verb | None, s: Names | None, wished: bool) -> bool:
    """Whether it is asked for: what is only allowed is not, nor is what was so."""
    if v is None:
        return True
    if v.past and not wished:
        return False
    none = s is not None and (s.denied or all(term.kind is Kind.NO for term in s.terms))
    return not v.may or v.denied or none or (wished and v.may == "can")


def relate(
    s: Names | None, to: tuple[Link, ...], v: Verb | None = None, bare: bool = False
) -> Relate | None:
    """That a subject has relations, or has not; None: it is not clear how many have."""
    denied = bool(v and v.denied)
    if denied and s is not None and len(s.terms) == 1 and s.terms[0].kind is Kind.COUNT:
        fewer = _denied_count(s.terms[0])
        return Relate(Names((fewer,)), to) if fewer is not None else None
    return Relate(s, to, denied, bare)


def _denied_count(one: Term) -> Term | None:
    """ "not at least two" as "at most one"; None: it is not clear how many may be."""
    if (one.least, one.most) == (1, None):
        return replace(one, kind=Kind.NO, least=0, most=0)
    if one.most is None:
        return replace(one, least=0, most=one.least - 1)
    if one.least == 0:
        return replace(one, least=one.most + 1, most=None)
    return None


def _before(to: tuple[Link, ...], s: Names) -> bool:
    return to[0].words.offset < s.terms[0].words.offset


def _with_verb(
    s: Names, to: tuple[Link, ...], v: Verb | None = None, wished: bool = False
) -> Relate | None:
    if not _asked(v, s, wished) or (_before(to, s) and to[0].denied):
        return None
    return relate(s, to, v)


def _there_with(
    m: tuple[Link, ...], s: Names, v: Verb, to: tuple[Link, ...], wished: bool = False
) -> Relate | None:
    if not _asked(v, s, wished) or v.denied or len(m) > 1 or m[0].denied or m[0].names is None:
        return None
    return Relate(s, (*m, *to)) if m[0].names.terms[0].is_place else None


def _which(s: Names, v: Verb, m: tuple[Link, ...], u: Verb, to: tuple[Link, ...]) -> Relate | None:
    if v.denied or u.denied or v.may or u.may or v.past or u.past:
        return None
    return Relate(s, (*m, *to)) if m[0].how == "clear" else None


def _without_subject(v: Verb, to: tuple[Link, ...], wished: bool = False) -> Relate | None:
    return relate(None, to, v) if _asked(v, None, wished) and not v.floats else None


def _has(
    s: Names, o: Names | None = None, v: Verb | None = None, x: Word | None = None,
    wished: bool = False, k: Word | None = None,
) -> Relate | None:  # fmt: skip
    if o is None:
        assert k is not None
        more = term_of(Words("block", 0, 0), Kind.COUNT, least=int(k.means) + 1)
        o = Names((more,))
    if not all(_is_place(term) for term in s.terms) or s.either:
        return None
    if any(term.is_place for term in o.terms) or not _asked(v, s, wished):
        return None
    if x is not None:
        if any(term.kind is not Kind.THE for term in o.terms):
            return None
        o = _only_of(o, x)
    return _has_them(s, o, v, Link(s.terms[0].words, INSIDE, s))


def _has_on_it(
    s: Names, o: Names, p: Link, v: Verb | None = None, wished: bool = False
) -> Relate | None:
    if any(term.is_place for term in (*s.terms, *o.terms)) or s.either:
        return None
    return _has_them(s, o, v, replace(p, names=s)) if _asked(v, s, wished) else None


def _has_at_end(
    s: Names, o: Names, t: Word, v: Verb | None = None, wished: bool = False
) -> Relate | None:
    if not all(_is_place(term) for term in s.terms) or len(s.terms) > 1 or (v and v.denied):
        return None
    how = "bottom" if "b" in t.text.split()[-1] else "top"
    return Relate(o, (Link(words_of(t), how=how, names=s),)) if _asked(v, s, wished) else None


def _covered(s: Names, o: Names, v: Verb | None = None, wished: bool = False) -> Relate | None:
    if s.either or not _asked(v, s, wished) or any(term.is_place for term in (*s.terms, *o.terms)):
        return None
    return _has_them(s, o, v, Link(s.terms[0].words, UPON, s))


def _number_of(
    n: tuple[Words, bool], to: tuple[Link, ...], v: Verb, q: tuple[int, int | None],
    wished: bool = False,
) -> Relate | None:  # fmt: skip
    number = Names((term_of(n[0], Kind.COUNT, least=q[0], most=q[1]),))
    return relate(number, to, v) if _asked(v, number, wished) and len(to) == 1 else None


def _share(
    s: Names, v: Verb | None = None, o: Names | None = None, p: Term | None = None,
    wished: bool = False,
) -> Relate | None:  # fmt: skip
    link = Link(s.terms[0].words, how="same", names=o)
    if p is not None:
        link = Link(p.words, INSIDE, Names((p,)))
    return relate(s, (link,), v) if _asked(v, s, wished) else None


def _no_place_has(s: Names, o: Names) -> Relate | None:
    """ "no pile over two high"."""
    if len(s.terms) != 1 or s.terms[0].kind is not Kind.NO or s.terms[0].words.text != "stack":
        return None
    return _has_them(s, o, None, Link(s.terms[0].words, INSIDE, s))


def _no_two(n: tuple[Words, bool], v: Verb | None = None) -> Relate | None:
    if v and v.denied:
        return None
    return Relate(Names((term_of(n[0], Kind.EVERY),)), (Link(n[0], how="different"),))


def _edge_is(e: Link, v: Verb, b: Names, wished: bool = False) -> Relate | None:
    if len(b.terms) > 1 or b.terms[0].kind is not Kind.THE or b.terms[0].is_place or v.denied:
        return None
    return Relate(b, (e,)) if _asked(v, b, wished) else None


def _what(to: tuple[Link, ...], v: Verb, s: Names, wished: bool = False) -> Relate | None:
    if v.denied or not _asked(v, s, wished) or any(term.kind is not Kind.THE for term in s.terms):
        return None
    return None if s.either or s.denied else Relate(s, to)


def _on_which(r: Word, t: Names, v: Verb, s: Names) -> Relate | None:
    if v.denied or v.may or s.either or t.either:
        return None
    return Relate(t, (Link(words_of(r), r.phrase, s),))


def _except_for(
    s: Names, to: tuple[Link, ...], e: Names, v: Verb | None = None, wished: bool = False
) -> Relate | None:
    names = but(s, e)
    return relate(names, to, v) if names and _asked(v, s, wished) else None


def _only(
    s: Names, to: tuple[Link, ...], o: Word | str, v: Verb | None = None, wished: bool = False
) -> Relate | None:
    if (v and v.denied) or s.either or s.denied or len(to) > 1 or to[0].denied:
        return None
    if v and v.may and all(term.kind is Kind.THE for term in s.terms):
        nothing = term_of(Words("block", 0, 0), Kind.NO, least=0, most=0, but=s.terms)
        return Relate(Names((nothing,)), to)
    if any(term.is_place for term in s.terms) or not _asked(v, s, wished):
        return None
    if all(term.kind is Kind.COUNT for term in s.terms):
        return Relate(s, to) if len(s.terms) == 1 else None
    return Relate(_only_of(s, o), to)


def _only_of(s: Names, x: Word | str) -> Names:
    """Them and nothing else."""
    if isinstance(x, Word) and x.text in ("nothing", "other", "others"):
        nothing = term_of(words_of(x, text="block"), Kind.NO, least=0, most=0, others=True)
        return Names((*s.terms, nothing))
    return replace(s, terms=tuple(replace(one, only=True) for one in s.terms))


def _is_place(term: Term) -> bool:
    return term.is_place or term.words.text in PLACE_NOUNS


def but(s: Names, e: Names) -> Names | None:
    """ "all in stack1 except red" with those that are left out; None: it is not said of all."""
    if len(s.terms) != 1 or s.terms[0].kind not in (Kind.EVERY, Kind.NO) or s.terms[0].but:
        return None
    if any(term.kind not in (Kind.THE, Kind.EVERY) for term in e.terms) or e.denied:
        return None
    if s.terms[0].kind is Kind.NO and all(term.kind is Kind.THE for term in e.terms):
        return _only_of(e, "only")
    return Names((replace(s.terms[0], but=e.terms, bare=False),))


def _must() -> Verb:
    return Verb()


def _has_them(s: Names, o: Names, v: Verb | None, to: Link) -> Relate | None:
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
        fewer = _denied_count(o.terms[0])
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


def _top_edge(w: Word, p: Term) -> Link | None:
    return Link(words_of(w), how="top", names=Names((p,))) if p.is_place else None


def _bottom_edge(w: Word, p: Term) -> Link | None:
    return Link(words_of(w), how="bottom", names=Names((p,))) if p.is_place else None


# Without a verb, and commands


def _bare(s: Names, to: tuple[Link, ...]) -> Relate | None:
    if _before(to, s) and to[0].denied:
        return None
    aside = to[0].phrase is not None and to[0].phrase.predicate.name == LEFT
    every = any(term.kind is Kind.EVERY for term in s.terms)
    if every and (to[0].denied or (aside and s.terms[0].words.text == "block")):
        return None  # "all blocks not in stack1": of whom something else is said?
    return relate(s, to, bare=True)


def _counted_after(k: Word, n: tuple[Words, bool], to: tuple[Link, ...], w: Word) -> Relate | None:
    """ "one block in every stack at least"."""
    least, most = int(k.means), None
    if w.text not in ("or more", "at least", "or above", "at the very least"):
        least, most = 0, least
    return relate(Names((term_of(n[0], Kind.COUNT, least=least, most=most),)), to, bare=True)


def _at_place(p: Term, s: Names, to: tuple[Link, ...]) -> Relate | None:
    if to[0].denied or to[0].names is None or to[0].names.terms[0].is_place or _before(to, s):
        return None
    return Relate(s, (Link(p.words, INSIDE, Names((p,))), *to), fronted=True)


def _beside_place(p: Term, s: Names | None = None, n: Names | None = None) -> Relate | None:
    s = s or n
    assert s is not None
    if any(_is_place(term) for term in s.terms) or s.either:
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
    if _before(to, s) and to[0].denied:
        return None
    return relate(s, to, Verb(p))


def _command_of_that(p: bool, s: Names, to: tuple[Link, ...]) -> Relate | None:
    return None if any(one.how == "side" for one in to) else relate(s, to, Verb(p))


def _not_so(s: Names, to: tuple[Link, ...]) -> Relate | None:
    if len(to) > 1 or _before(to, s) or any(term.kind is not Kind.THE for term in s.terms):
        return None
    return relate(s, to, Verb(denied=True))


def _one_tower(s: Names) -> Relate | None:
    """ "make one tower with all five blocks"."""
    if len(s.terms) > 1 or s.terms[0].kind is not Kind.EVERY or s.terms[0].is_place:
        return None
    term = replace(s.terms[0], bare=False)
    return Relate(Names((term,)), (Link(term.words, how="same"),))


def _wants() -> bool:
    return False


def _command_of_it(p: bool, to: tuple[Link, ...]) -> Relate | None:
    return None if p else Relate(None, to)


def _takes() -> bool:
    return False


def _puts(w: Word) -> bool | None:
    return None if w.text == "make" else False


def _makes() -> bool:
    return False


def _puts_not() -> bool:
    return True


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
    if (v and not _asked(v, s, False)) or (v and v.denied) or "off" not in o.words.text:
        return None
    return _take_off(s, o)


def _anywhere_but(s: Names, to: Link) -> Relate | None:
    return None if s.either or to.denied else Relate(s, (replace(to, denied=True),))


def _not_there(to: Link | None = None, p: Term | None = None) -> Link | None:
    return to if p is None else Link(p.words, INSIDE, Names((p,)))


def _put_but(s: Names, to: tuple[Link, ...], e: Names) -> Relate | None:
    names = but(s, e)
    return Relate(names, to) if names is not None else None
