# SPDX-License-Identifier: Apache-2.0
"""Rules for clauses: who shall stand in which relation, said with and without verbs."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace
from typing import Final

from ..terms import Kind, Term
from .lattice import Word
from .meaning import Change, Clear, Item, Link, Names, Relate, Row, Take
from .nominal import INSIDE, UPON, rule, term_of, words_of

#: Behind "not", what need not be so.
_NEED: Final = frozenset({"has to", "have to", "needs to", "need to", "had to", "need"})


@dataclass(frozen=True)
class Verb:
    """What the words of a verb say: it is denied, it may be, it was."""

    denied: bool = False
    may: bool = False
    past: bool = False


@rule("VERBWORD", "w:BE", "w:MUST", "w:DO")
def _verb_word(w: Word) -> tuple[str, str]:
    return "be", w.text


@rule("VERBWORD", "w:NOT")
def _not_word(w: Word) -> tuple[str, str]:
    return "not", w.text


@rule("VERBWORD", "w:MAY")
def _may_word(w: Word) -> tuple[str, str]:
    return "may", w.text


@rule("VERBWORD", "w:PAST")
def _past_word(w: Word) -> tuple[str, str]:
    return "past", w.text


@rule("ANYVERB", "w:VERBWORD+")
def _verb(w: Sequence[tuple[str, str]]) -> Verb | None:
    kinds = [kind for kind, _ in w]
    if kinds.count("not") > 1 or len(w) > 5:
        return None
    for (kind, _), (_, text) in zip(w, w[1:]):
        if kind == "not" and text in _NEED:
            return None
    return Verb("not" in kinds, "may" in kinds, "past" in kinds)


@rule("VERB", "v:ANYVERB")
def _asked_for(v: Verb) -> Verb | None:
    """What is allowed or was so is not asked for; what is not allowed is."""
    return None if v.past or (v.may and not v.denied) else v


@rule("WISHVERB", "v:ANYVERB")
def _wished_for(v: Verb) -> Verb | None:
    return None if v.may else v


def _relate(
    s: Names | None, l: tuple[Link, ...], v: Verb | None = None, bare: bool = False
) -> Relate | None:
    if s is not None and s.either and not (v and v.denied):
        return None
    return Relate(s, l, bool(v and v.denied), bare)


for _clause, _verb_kind in (("CLAUSE", "VERB"), ("WISHED", "WISHVERB")):

    @rule(_clause, f"s:LISTED v:{_verb_kind} l:LINKS", f"s:LISTED COMMA 'it' v:{_verb_kind} l:LINKS",
          f"THERE v:{_verb_kind} s:LISTED l:LINKS", f"l:LINKS v:{_verb_kind} s:LISTED", f"l:LINKS COMMA? THERE v:{_verb_kind} s:LISTED",
          f"v:{_verb_kind} s:LISTED l:LINKS", f"'it' v:{_verb_kind} s:LISTED WHICH BE l:LINKS")  # fmt: skip
    def _with_verb(s: Names, v: Verb, l: tuple[Link, ...]) -> Relate | None:
        return _relate(s, l, v)

    @rule(_clause, f"v:{_verb_kind} l:LINKS", cost=0.2)
    def _without_subject(v: Verb, l: tuple[Link, ...]) -> Relate | None:
        return _relate(None, l, v)

    @rule(_clause, f"s:LISTED v:{_verb_kind}? NOTTOUCH l:LISTED")
    def _apart_from(s: Names, l: Names, v: Verb | None = None) -> Item | None:
        return None

    @rule(_clause, f"s:LISTED v:{_verb_kind}? c:CLEAR", f"s:LISTED v:{_verb_kind}? n:NOT c:CLEAR",
          f"s:LISTED COMMA 'it' v:{_verb_kind} c:CLEAR", f"v:{_verb_kind} c:CLEAR s:LISTED")  # fmt: skip
    def _clear(s: Names, c: Word, v: Verb | None = None, n: Word | None = None) -> Clear | None:
        denied = bool(v and v.denied)
        if denied and n is not None:
            return None
        if s.denied:
            s, denied = replace(s, denied=False), not denied
        if s.either and not denied:
            return None
        return Clear(replace(s, either=False), denied or n is not None)

    @rule(_clause, f"s:LISTED v:{_verb_kind}? HAS o:LISTED ITSELFIN?", f"s:LISTED v:{_verb_kind}? HAS o:AMOUNTED ITSELFIN?",
          f"s:LISTED v:{_verb_kind} o:AMOUNTED", f"s:LISTED v:{_verb_kind}? HAS o:LISTED x:EXCLUSIVE ITSELFIN?",
          f"s:LISTED v:{_verb_kind}? HAS x:ONLY o:LISTED ITSELFIN?")  # fmt: skip
    def _has(
        s: Names, o: Names, v: Verb | None = None, x: Word | None = None
    ) -> Relate | None:
        if not all(term.is_place or term.words.text == "it" for term in s.terms) or s.either:
            return None
        if any(term.is_place for term in o.terms):
            return None
        if x is not None:
            if any(term.kind is not Kind.THE for term in o.terms):
                return None
            o = replace(o, terms=tuple(replace(term, only=True) for term in o.terms))
        return _has_them(s, o, v, (Link(s.terms[0].words, INSIDE, s),))

    @rule(_clause, f"s:LISTED v:{_verb_kind}? HAS o:LISTED p:ITSPHRASE")
    def _has_on_it(s: Names, o: Names, p: Link, v: Verb | None = None) -> Relate | None:
        if any(term.is_place for term in (*s.terms, *o.terms)) or s.either:
            return None
        return _has_them(s, o, v, (replace(p, names=s),))

    @rule(_clause, f"s:LISTED v:{_verb_kind}? COVERED o:LISTED", f"s:LISTED v:{_verb_kind}? SUPPORTED o:LISTED")
    def _covered(s: Names, o: Names, v: Verb | None = None) -> Relate | None:
        return None if s.either else _has_them(s, o, v, (Link(s.terms[0].words, UPON, s),))

    @rule(_clause, f"s:LISTED v:{_verb_kind}? SHARE A? PLACENOUN", f"s:LISTED v:{_verb_kind}? SHARE A? PLACENOUN 'with' o:LISTED",
          f"s:LISTED v:{_verb_kind}? SHARE p:PLACE")  # fmt: skip
    def _share(
        s: Names, v: Verb | None = None, o: Names | None = None, p: Term | None = None
    ) -> Relate | None:
        link = Link(s.terms[0].words, how="same", names=o)
        if p is not None:
            link = Link(p.words, INSIDE, Names((p,)))
        return _relate(s, (link,), v)

    @rule(_clause, f"e:EDGE v:{_verb_kind} b:LISTED", f"b:LISTED v:{_verb_kind} e:EDGE")
    def _edge_is(e: Link, v: Verb, b: Names) -> Relate | None:
        if len(b.terms) > 1 or b.terms[0].kind is not Kind.THE or b.terms[0].is_place or v.denied:
            return None
        return Relate(b, (e,), v.denied)

    @rule(_clause, f"o:ONLY s:LISTED v:{_verb_kind}? l:LINKS", f"s:LISTED o:ONLY l:LINKS", f"s:LISTED v:{_verb_kind} o:THEONLY l:LINKS",
          f"o:THEONLY l:LINKS v:{_verb_kind} s:LISTED", f"l:LINKS v:{_verb_kind}? o:ONLY s:LISTED", f"THERE v:{_verb_kind} o:ONLY s:LISTED l:LINKS",
          f"l:LINKS THERE v:{_verb_kind} o:ONLY s:LISTED",
          f"s:LISTED o:EXCLUSIVE v:{_verb_kind}? l:LINKS", f"s:LISTED v:{_verb_kind}? l:LINKS o:EXCLUSIVE")  # fmt: skip
    def _only(s: Names, l: tuple[Link, ...], o: Word | str, v: Verb | None = None) -> Relate | None:
        if (v and v.denied) or s.either or len(l) > 1 or l[0].denied:
            return None
        if any(term.is_place for term in s.terms):
            return None
        return Relate(replace(s, terms=tuple(replace(one, only=True) for one in s.terms)), l)


def _has_them(s: Names, o: Names, v: Verb | None, l: tuple[Link, ...]) -> Relate | None:
    """That something has others, said of these."""
    denied = bool(v and v.denied)
    if s.denied:
        l, denied = (replace(l[0], names=replace(s, denied=False)),), not denied
    if denied and len(o.terms) == 1 and o.terms[0].kind is Kind.COUNT:
        one = o.terms[0]
        if (one.least, one.most) == (1, None):
            o, denied = Names((replace(one, kind=Kind.NO, least=0, most=0),)), False
        elif one.most is None:
            o, denied = Names((replace(one, least=0, most=one.least - 1),)), False
        elif one.least == 0:
            o, denied = Names((replace(one, least=(one.most or 0) + 1, most=None),)), False
        else:
            return None
    if o.either and not denied:
        return None
    return Relate(o, l, denied, about=True)


@rule("AMOUNTED", "q:AMOUNT", "q:AMOUNT HIGH", "q:AMOUNT NOUNS HIGH", "q:AMOUNT NOUN HIGH", "HIGHER w:MORETHANTHAN k:NUMBER NOUNS?")
def _amounted(
    q: tuple[int, int | None] | None = None, w: Word | None = None, k: Word | None = None
) -> Names | None:
    if q is None:
        return None
    from ..terms import Words

    words = Words("block", 0, 0)
    if q[1] == 0:
        return Names((term_of(words, Kind.NO, least=0, most=0),))
    return Names((term_of(words, Kind.COUNT, least=q[0], most=q[1]),))


@rule("ITSPHRASE", "w:RELATION 'it'", "w:RELATION 'them'", "w:ATTOP", "w:RELATION 'itself'")
def _its_phrase(w: Word) -> Link | None:
    phrase = w.phrase or UPON
    return None if phrase.needs_place else Link(words_of(w), phrase)


@rule("ITSPHRASE", "'to' POSSESSIVE s:SIDE", "'on' POSSESSIVE s:SIDE", "'at' POSSESSIVE s:SIDE")
def _its_side(s: Word) -> Link | None:
    from scene_graph import LEFT, PREDICATES, Phrase

    if s.text not in ("left", "right"):
        return None
    return Link(words_of(s), Phrase(PREDICATES[LEFT], inverse=s.text == "right"))


@rule("EDGE", "w:TOPOF p:TERM", "THE w:TOPMOST HEAD INOF p:TERM", "THE HEAD w:TOPOF p:TERM", "THE ONE w:TOPOF p:TERM", "THE w:TOPMOST 'of' p:TERM",
      "THE w:TOPMOST ONE INOF p:TERM")  # fmt: skip
def _top_edge(w: Word, p: Term) -> Link | None:
    return Link(words_of(w), how="top", names=Names((p,))) if p.is_place else None


@rule("EDGE", "w:BOTTOMOF p:TERM", "THE w:LOWEST HEAD INOF p:TERM", "THE HEAD w:BOTTOMOF p:TERM", "THE ONE w:BOTTOMOF p:TERM", "THE w:LOWEST 'of' p:TERM",
      "THE w:LOWEST ONE INOF p:TERM")  # fmt: skip
def _bottom_edge(w: Word, p: Term) -> Link | None:
    return Link(words_of(w), how="bottom", names=Names((p,))) if p.is_place else None


@rule("THEONLY", "THE 'only' HEAD", "THE 'only' HEAD WHICH BE", "THE 'only' ONE", "THE 'only' 'one'")
def _the_only() -> str:
    return "only"


@rule("EXCLUSIVE", "w:ALONE", "w:ONLY", "COMMA? AND w:NOTHING ELSE", "BUT w:NOTHING ELSE", "AND NO w:OTHER HEAD?", "AND NO w:OTHER")
def _exclusive(w: Word) -> Word:
    return w


# Without a verb, and commands


@rule("CLAUSE", "s:LISTED l:LINKS", "s:LISTED COLON l:LINKS", "s:LISTED COMMA 'it' l:LINKS")
@rule("CLAUSE", "l:LINKS s:LISTED", "l:LINKS COMMA s:LISTED", cost=0.4)
@rule("CLAUSE", "s:LISTED STOP l:LINKS", cost=1.0)
@rule("WISHED", "s:LISTED l:LINKS")
def _bare(s: Names, l: tuple[Link, ...]) -> Relate | None:
    return _relate(s, l, bare=True)


@rule("CLAUSE", "s:LISTED p:BAREPLACE", "p:BAREPLACE COLON s:LISTED", "p:BAREPLACE BE s:LISTED", "p:BAREPLACE n:AMOUNTED")
@rule("CLAUSE", "p:BAREPLACE s:LISTED", cost=0.8)
def _beside_place(p: Term, s: Names | None = None, n: Names | None = None) -> Relate | None:
    s = s or n
    assert s is not None
    if any(term.is_place for term in s.terms) or s.either:
        return None
    return Relate(s, (Link(p.words, INSIDE, Names((p,))),), bare=True)


@rule("BAREPLACE", "p:PLACE")
def _bare_place(p: Term) -> Term:
    return p


@rule("CLAUSE", "l:LINKS", cost=0.4)
def _links_alone(l: tuple[Link, ...]) -> Relate:
    return Relate(None, l, bare=True)


@rule("CLAUSE", "p:PUTS s:LISTED l:LINKS", "p:PUTS s:LISTED BE l:LINKS", "p:PUTS l:LINKS s:LISTED", "p:PUTS l:LINKS COMMA s:LISTED",
      "l:LINKS COMMA? p:PUTS s:LISTED", "s:LISTED COMMA p:PUTS ITORTHEM l:LINKS", "p:PUTS s:LISTED COMMA l:LINKS",
      "l:LINKS COMMA? MUST p:PUTS s:LISTED")  # fmt: skip
@rule("CLAUSE", "p:TAKES s:LISTED l:LINKS", cost=0.3)
def _command(p: bool, s: Names, l: tuple[Link, ...]) -> Relate | None:
    if s.either and not p:
        return None
    if p and len(s.terms) == 1 and s.terms[0].kind is Kind.COUNT:
        # "do not put anything on red"
        if (s.terms[0].least, s.terms[0].most) != (1, None):
            return None
        return Relate(Names((replace(s.terms[0], kind=Kind.NO, least=0, most=0),)), l)
    if p and s.terms[0].kind is Kind.EVERY and s.terms[0].words.text == "block":
        return Relate(Names((replace(s.terms[0], kind=Kind.NO, least=0, most=0, bare=False),)), l)
    return _relate(s, l, Verb(p))


@rule("CLAUSE", "p:PUTS l:LINKS", cost=0.3)
def _command_of_it(p: bool, l: tuple[Link, ...]) -> Relate | None:
    return None if p else Relate(None, l)


@rule("ITORTHEM", "w:IT", "w:BOTHOF", "w:ALLOF")
def _it_or_them(w: Word) -> Word:
    return w


@rule("TAKES", "w:TAKE", "'to' w:TAKE")
def _takes(w: Word) -> bool:
    return False


@rule("PUTS", "w:PUT", "w:PUTTING", "'to' w:PUT")
def _puts(w: Word) -> bool:
    return False


@rule("PUTS", "DO? w:NOT w2:PUT", "'to' w:NOT PUT", "NOT 'to' w:PUT", "YOU MUST w:NOT PUT", "MUST w:NOT PUT", "YOU MAY w:NOT PUT", "AVOID w:PUTTING",
      "DO w:NOT PUT", "w:NOT PUTTING", "'without' w:PUTTING")  # fmt: skip
def _puts_not(w: Word, w2: Word | None = None) -> bool:
    return True


@rule("CLAUSE", "PUT s:LISTED c:CLEAR", "CLEARS s:LISTED", "CLEARS THE? TOPOF s:LISTED", "PUT c:CLEAR s:LISTED", "PUT s:LISTED BE c:CLEAR", "PUT TOPOF s:LISTED c:CLEAR",
      "'clear' s:LISTED", "n:NOTLEAVE s:LISTED c:CLEAR", "COVER s:LISTED 'with' NOTHING")  # fmt: skip
def _clear_it(s: Names, c: Word | None = None, n: Word | None = None) -> Clear | None:
    if s.denied:
        return None
    return Clear(replace(s, either=False), denied=n is not None)


@rule("NOTLEAVE", "DO w:NOT PUT", "w:NOT PUT")
def _not_leave(w: Word) -> Word:
    return w


@rule("CLAUSE", "n:COVERS s:LISTED 'with' o:LISTED")
def _cover(n: bool, s: Names, o: Names) -> Relate | None:
    if s.either or o.either or any(term.is_place for term in (*s.terms, *o.terms)):
        return None
    return Relate(o, (Link(s.terms[0].words, UPON, s),), n, about=True)


@rule("COVERS", "w:COVER", "n:NOT w:COVER", "DO n:NOT w:COVER")
def _covers(w: Word, n: Word | None = None) -> bool:
    return n is not None


@rule("CLAUSE", "TAKE s:LISTED", "'to' TAKE s:LISTED", "TAKE s:LISTED 'up'")
def _take(s: Names) -> Take | None:
    if s.either or any(term.is_place for term in s.terms):
        return None
    return Take(s)


@rule("CLAUSE", "TAKE s:LISTED o:OFFLINK", "PUT s:LISTED o:OFFLINK", "TAKE o:OFFLINK s:LISTED", "PUT OUTOF? s:LISTED o:OFFLINK")
def _take_off(s: Names, o: Link) -> Item | None:
    if s.either or any(term.is_place for term in s.terms):
        return None
    if all(term.kind in (Kind.EVERY, Kind.COUNT) for term in s.terms):
        terms = tuple(replace(one, kind=Kind.NO, least=0, most=0, bare=False) for one in s.terms)
        if len(terms) > 1 or s.terms[0].most is not None:
            return None
        return Relate(Names(terms), (replace(o, denied=False),))
    return Take(s, o)


@rule("CLAUSE", "TAKE s:LISTED o:OFFLINK COMMA? AND? l:LINKS", "PUT s:LISTED o:OFFLINK COMMA? AND? l:LINKS")
def _take_from_to(s: Names, o: Link, l: tuple[Link, ...]) -> Relate | None:
    if any(one.denied for one in l) or s.either:
        return None
    return Relate(s, l)


@rule("CLAUSE", "s:LISTED o:OFFLINK", "s:LISTED v:VERB o:OFFLINK", cost=0.3)
def _comes_off(s: Names, o: Link, v: Verb | None = None) -> Item | None:
    if v and v.denied:
        return None
    return _take_off(s, o)


@rule("CLAUSE", "s:LISTED MUST BE? ANYWHEREBUT l:LINK", "PUT s:LISTED ANYWHEREBUT l:LINK", "s:LISTED ANYWHEREBUT l:LINK",
      "s:LISTED MAY BE ANYWHEREBUT l:LINK")  # fmt: skip
def _anywhere_but(s: Names, l: Link) -> Relate | None:
    return None if s.either or l.denied else Relate(s, (replace(l, denied=True),))
