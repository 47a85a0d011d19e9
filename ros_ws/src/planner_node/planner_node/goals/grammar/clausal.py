# SPDX-License-Identifier: Apache-2.0
"""Rules for clauses: who shall stand in which relation, said with and without verbs."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace
from itertools import pairwise
from typing import Final

from scene_graph import LEFT, PREDICATES, Phrase

from ..terms import Kind, Term, Words
from .lattice import Word
from .meaning import Item, Link, Names, Relate, Row, Take
from .nominal import INSIDE, UPON, rule, term_of, words_of

#: Behind "not", what need not be so.
_NEED: Final = frozenset({"has to", "have to", "needs to", "need to", "had to", "need"})


@dataclass(frozen=True)
class Verb:
    """What the words of a verb say: it is denied, it may be, it was."""

    denied: bool = False
    may: str = ""
    past: bool = False
    floats: bool = False


@rule("VERBWORD", "w:BE", "w:MUST", "w:DO")
def _verb_word(w: Word) -> tuple[str, str]:
    return "be", w.text


@rule("VERBWORD", "w:FLOAT")
def _float_word(w: Word) -> tuple[str, str]:
    return "all", w.text


@rule("VERBWORD", "w:PLACED")
def _placed_word(w: Word) -> tuple[str, str]:
    return "placed", w.text


@rule("VERBWORD", "w:NOT")
def _not_word(w: Word) -> tuple[str, str]:
    return "not", w.text


@rule("VERBWORD", "w:MAY")
def _may_word(w: Word) -> tuple[str, str]:
    return "may", w.text


@rule("VERBWORD", "w:CAN")
def _can_word(w: Word) -> tuple[str, str]:
    return "can", w.text


@rule("VERBWORD", "w:PAST")
def _past_word(w: Word) -> tuple[str, str]:
    return "past", w.text


@rule("VERB", "w:VERBWORD+")
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
    s: Names | None, l: tuple[Link, ...], v: Verb | None = None, bare: bool = False
) -> Relate | None:
    denied = bool(v and v.denied)
    if denied and s is not None and len(s.terms) == 1 and s.terms[0].kind is Kind.COUNT:
        fewer = _denied_count(s.terms[0])
        return fewer and Relate(Names((fewer,)), l)
    return Relate(s, l, denied, bare)


def _denied_count(one: Term) -> Term | None:
    """ "not at least two" as "at most one"; None: it is not clear how many may be."""
    if (one.least, one.most) == (1, None):
        return replace(one, kind=Kind.NO, least=0, most=0)
    if one.most is None:
        return replace(one, least=0, most=one.least - 1)
    if one.least == 0:
        return replace(one, least=one.most + 1, most=None)
    return None


def _before(l: tuple[Link, ...], s: Names) -> bool:
    return l[0].words.offset < s.terms[0].words.offset


for _clause, _wished in (("CLAUSE", False), ("WISHED", True)):

    @rule(_clause, "s:LISTED v:VERB l:LINKS", "s:LISTED COMMA? ITORTHEM v:VERB l:LINKS", "s:LISTED COLON ITORTHEM v:VERB l:LINKS",
          "THERE v:VERB s:LISTED l:LINKS", "THERE v:VERB s:LISTED VERB l:LINKS", "MUST BE s:LISTED v:VERB? l:LINKS", "l:LINKS v:VERB s:LISTED", "l:LINKS COMMA? THERE v:VERB s:LISTED",
          "l:LINKS v:MUSTNOT s:LISTED BE", "s:LISTED COMMA? WHICH v:VERB l:LINKS COMMA?", "MUST s:LISTED v:VERB l:LINKS")  # fmt: skip
    @rule(_clause, "s:LISTED l:LINKS v:VERB", cost=0.4)
    def _with_verb(
        s: Names, l: tuple[Link, ...], v: Verb | None = None, w: bool = _wished
    ) -> Relate | None:
        if not _asked(v, s, w) or (_before(l, s) and l[0].denied):
            return None
        return relate(s, l, v)

    @rule(_clause, "m:LINKS COMMA? THERE v:VERB s:LISTED l:LINKS", "m:LINKS COMMA? s:LISTED v:VERB l:LINKS")
    def _there_with(
        m: tuple[Link, ...], s: Names, v: Verb, l: tuple[Link, ...], w: bool = _wished
    ) -> Relate | None:
        if not _asked(v, s, w) or v.denied or len(m) > 1 or m[0].denied or m[0].names is None:
            return None
        return Relate(s, (*m, *l)) if m[0].names.terms[0].is_place else None

    @rule(_clause, "s:LISTED COMMA? WHICH v:VERB m:LINKS COMMA? u:VERB l:LINKS")
    def _which(
        s: Names, v: Verb, m: tuple[Link, ...], u: Verb, l: tuple[Link, ...], w: bool = _wished
    ) -> Relate | None:
        if v.denied or u.denied or v.may or u.may or v.past or u.past:
            return None
        return Relate(s, (*m, *l)) if m[0].how == "clear" else None

    @rule(_clause, "v:VERB l:LINKS", cost=0.2)
    def _without_subject(v: Verb, l: tuple[Link, ...], w: bool = _wished) -> Relate | None:
        return relate(None, l, v) if _asked(v, None, w) and not v.floats else None

    @rule(_clause, "s:LISTED v:VERB? HAS o:LISTED ITSELFIN?", "s:LISTED v:VERB? HAS o:AMOUNTED ITSELFIN?",
          "s:LISTED v:VERB o:AMOUNTED", "s:LISTED v:VERB? HAS o:LISTED x:EXCLUSIVE ITSELFIN?",
          "s:LISTED v:VERB? HAS x:ONLY o:LISTED ITSELFIN?", "THE? HEIGHT 'of' s:LISTED v:VERB? o:AMOUNTED",
          "s:LISTED v:VERB? HIGHER AS k:NUMBER NOUNS?", "THE? HEIGHT 'of' s:LISTED v:VERB EXCEED k:NUMBER NOUNS?", "s:LISTED v:VERB EXCEED k:NUMBER NOUNS?")  # fmt: skip
    def _has(
        s: Names, o: Names | None = None, v: Verb | None = None, x: Word | None = None,
        w: bool = _wished, k: Word | None = None,
    ) -> Relate | None:  # fmt: skip
        if o is None:
            assert k is not None
            more = term_of(Words("block", 0, 0), Kind.COUNT, least=int(k.means) + 1)
            o = Names((more,))
        if not all(_is_place(term) for term in s.terms) or s.either:
            return None
        if any(term.is_place for term in o.terms) or not _asked(v, s, w):
            return None
        if x is not None:
            if any(term.kind is not Kind.THE for term in o.terms):
                return None
            o = _only_of(o, x)
        return _has_them(s, o, v, Link(s.terms[0].words, INSIDE, s))

    @rule(_clause, "s:LISTED v:VERB? HAS o:LISTED p:ITSPHRASE")
    def _has_on_it(
        s: Names, o: Names, p: Link, v: Verb | None = None, w: bool = _wished
    ) -> Relate | None:
        if any(term.is_place for term in (*s.terms, *o.terms)) or s.either:
            return None
        return _has_them(s, o, v, replace(p, names=s)) if _asked(v, s, w) else None

    @rule(_clause, "s:LISTED v:VERB? HAS o:LISTED t:ATTOP", "s:LISTED v:VERB? HAS o:LISTED t:ATBOTTOM")
    def _has_at_end(
        s: Names, o: Names, t: Word, v: Verb | None = None, w: bool = _wished
    ) -> Relate | None:
        if not all(_is_place(term) for term in s.terms) or len(s.terms) > 1 or (v and v.denied):
            return None
        how = "bottom" if "b" in t.text.split()[-1] else "top"
        return Relate(o, (Link(words_of(t), how=how, names=s),)) if _asked(v, s, w) else None

    @rule(_clause, "s:LISTED v:VERB? COVERED o:LISTED", "s:LISTED v:VERB? CARRY o:LISTED", "o:LISTED v:VERB? SUPPORTED s:LISTED")
    def _covered(
        s: Names, o: Names, v: Verb | None = None, w: bool = _wished
    ) -> Relate | None:
        if s.either or not _asked(v, s, w) or any(term.is_place for term in (*s.terms, *o.terms)):
            return None
        return _has_them(s, o, v, Link(s.terms[0].words, UPON, s))

    @rule(_clause, "THE NUMBEROF n:NAME l:LINKS v:VERB q:AMOUNT")
    def _number_of(
        n: tuple[Words, bool], l: tuple[Link, ...], v: Verb, q: tuple[int, int | None],
        w: bool = _wished,
    ) -> Relate | None:  # fmt: skip
        number = Names((term_of(n[0], Kind.COUNT, least=q[0], most=q[1]),))
        return relate(number, l, v) if _asked(v, number, w) and len(l) == 1 else None

    @rule(_clause, "s:LISTED v:VERB? SHARE A? PLACENOUN", "s:LISTED v:VERB? SHARE A? PLACENOUN 'with' o:LISTED",
          "s:LISTED v:VERB? SHARE p:PLACE")  # fmt: skip
    def _share(
        s: Names, v: Verb | None = None, o: Names | None = None, p: Term | None = None,
        w: bool = _wished,
    ) -> Relate | None:  # fmt: skip
        link = Link(s.terms[0].words, how="same", names=o)
        if p is not None:
            link = Link(p.words, INSIDE, Names((p,)))
        return relate(s, (link,), v) if _asked(v, s, w) else None

    @rule(_clause, "s:LISTED o:AMOUNTED", cost=0.4)
    def _no_place_has(s: Names, o: Names) -> Relate | None:
        """ "no pile over two high"."""
        if len(s.terms) != 1 or s.terms[0].kind is not Kind.NO or s.terms[0].words.text != "stack":
            return None
        return _has_them(s, o, None, Link(s.terms[0].words, INSIDE, s))

    @rule(_clause, "NO 'two' n:NAME v:VERB? SAMEPLACE", "NO 'two' n:NAME v:VERB? SHARE A? PLACENOUN")
    def _no_two(n: tuple[Words, bool], v: Verb | None = None, w: bool = _wished) -> Relate | None:
        if v and v.denied:
            return None
        return Relate(Names((term_of(n[0], Kind.EVERY),)), (Link(n[0], how="different"),))

    @rule(_clause, "e:EDGE v:VERB b:LISTED", "b:LISTED v:VERB e:EDGE")
    def _edge_is(e: Link, v: Verb, b: Names, w: bool = _wished) -> Relate | None:
        if len(b.terms) > 1 or b.terms[0].kind is not Kind.THE or b.terms[0].is_place or v.denied:
            return None
        return Relate(b, (e,)) if _asked(v, b, w) else None

    @rule(_clause, "THE HEAD WHICH? WHO WANT l:LINKS v:VERB s:LISTED", "'what' WHO WANT l:LINKS v:VERB s:LISTED",
          "s:LISTED v:VERB 'what' WHO WANT l:LINKS", "s:LISTED v:VERB THE HEAD WHICH? WHO WANT l:LINKS", "'what' BE l:LINKS v:VERB s:LISTED", "'it' v:VERB s:LISTED WHICH VERB l:LINKS")  # fmt: skip
    def _what(l: tuple[Link, ...], v: Verb, s: Names, w: bool = _wished) -> Relate | None:
        if v.denied or not _asked(v, s, w) or any(term.kind is not Kind.THE for term in s.terms):
            return None
        return None if s.either or s.denied else Relate(s, l)

    @rule(_clause, "THE HEAD r:RELATION WHICH t:LISTED VERB v:VERB s:LISTED", "THE HEAD r:RELATION WHICH t:LISTED v:VERB s:LISTED")
    def _on_which(r: Word, t: Names, v: Verb, s: Names, w: bool = _wished) -> Relate | None:
        if v.denied or v.may or s.either or t.either:
            return None
        return Relate(t, (Link(words_of(r), r.phrase, s),))

    @rule(_clause, "s:LISTED v:VERB? l:LINKS COMMA? ALLBUT e:LISTED")
    def _but(
        s: Names, l: tuple[Link, ...], e: Names, v: Verb | None = None, w: bool = _wished
    ) -> Relate | None:
        names = but(s, e)
        return relate(names, l, v) if names and _asked(v, s, w) else None

    @rule(_clause, "o:ONLY s:LISTED v:VERB? l:LINKS", "s:LISTED v:VERB o:THEONLY l:LINKS",
          "o:THEONLY l:LINKS v:VERB s:LISTED", "l:LINKS v:VERB? o:ONLY s:LISTED", "THERE v:VERB o:ONLY VERB? s:LISTED l:LINKS",
          "l:LINKS THERE v:VERB o:ONLY s:LISTED", "l:LINKS COMMA? WHO WANT TOSEE? o:ONLY s:LISTED",
          "s:LISTED o:EXCLUSIVE v:VERB? l:LINKS", "s:LISTED v:VERB? l:LINKS o:EXCLUSIVE")  # fmt: skip
    def _only(
        s: Names, l: tuple[Link, ...], o: Word | str, v: Verb | None = None, w: bool = _wished
    ) -> Relate | None:
        if (v and v.denied) or s.either or s.denied or len(l) > 1 or l[0].denied:
            return None
        if v and v.may and all(term.kind is Kind.THE for term in s.terms):
            nothing = term_of(Words("block", 0, 0), Kind.NO, least=0, most=0, but=s.terms)
            return Relate(Names((nothing,)), l)
        if any(term.is_place for term in s.terms) or not _asked(v, s, w):
            return None
        if all(term.kind is Kind.COUNT for term in s.terms):
            return Relate(s, l) if len(s.terms) == 1 else None
        return Relate(_only_of(s, o), l)


def _only_of(s: Names, x: Word | str) -> Names:
    """Them and nothing else."""
    if isinstance(x, Word) and x.text in ("nothing", "other", "others"):
        nothing = term_of(words_of(x, text="block"), Kind.NO, least=0, most=0, others=True)
        return Names((*s.terms, nothing))
    return replace(s, terms=tuple(replace(one, only=True) for one in s.terms))


def _is_place(term: Term) -> bool:
    return term.is_place or term.words.text == "stack"


def but(s: Names, e: Names) -> Names | None:
    """ "all in stack1 except red" with those that are left out; None: it is not said of all."""
    if len(s.terms) != 1 or s.terms[0].kind not in (Kind.EVERY, Kind.NO) or s.terms[0].but:
        return None
    if any(term.kind not in (Kind.THE, Kind.EVERY) for term in e.terms) or e.denied:
        return None
    if s.terms[0].kind is Kind.NO and all(term.kind is Kind.THE for term in e.terms):
        return _only_of(e, "only")
    return Names((replace(s.terms[0], but=e.terms, bare=False),))


@rule("MUSTNOT", "w:MUST", "w:MUST NOT?")
def _must(w: Word) -> Verb:
    return Verb()


def _has_them(s: Names, o: Names, v: Verb | None, l: Link) -> Relate | None:
    """That something has others, said of these."""
    denied = bool(v and v.denied)
    if s.denied:
        s, denied = replace(s, denied=False), not denied
    if len(s.terms) == 1 and s.terms[0].kind is Kind.NO:
        if any(term.kind is Kind.COUNT and not term.least for term in o.terms):
            return None  # "no stack has at most two"
        every = replace(s.terms[0], kind=Kind.EVERY, least=1, most=None)
        s, denied = Names((every,)), not denied
    l = replace(l, names=s)
    if denied and len(o.terms) == 1 and o.terms[0].kind is Kind.COUNT:
        fewer = _denied_count(o.terms[0])
        if fewer is None:
            return None
        o, denied = Names((fewer,)), False
    if o.either and not denied:
        return None
    return Relate(o, (l,), denied, about=True)


@rule("AMOUNTED", "q:AMOUNT", "q:AMOUNT HIGH", "q:AMOUNT NOUNS HIGH", "q:AMOUNT NOUN HIGH", "q:AMOUNT NOUNS", "q:AMOUNT NOUN")
def _amounted(q: tuple[int, int | None]) -> Names:
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


@rule("CLAUSE", "s:LISTED l:LINKS", "s:LISTED COLON l:LINKS", "s:LISTED COMMA? 'it' l:LINKS", "s:LISTED COMMA? SOTHAT 'it' VERB l:LINKS")
@rule("CLAUSE", "l:LINKS s:LISTED", "l:LINKS COMMA s:LISTED", cost=0.4)
@rule("CLAUSE", "s:LISTED MARK l:LINKS", cost=1.0)
@rule("WISHED", "s:LISTED l:LINKS")
def _bare(s: Names, l: tuple[Link, ...]) -> Relate | None:
    if _before(l, s) and l[0].denied:
        return None
    aside = l[0].phrase is not None and l[0].phrase.predicate.name == LEFT
    every = any(term.kind is Kind.EVERY for term in s.terms)
    if every and (l[0].denied or (aside and s.terms[0].words.text == "block")):
        return None  # "all blocks not in stack1": of whom something else is said?
    return relate(s, l, bare=True)


@rule("CLAUSE", "p:HEADPLACE COLON s:LISTED l:LINKS", "INPLACE p:PLACE COMMA? s:LISTED l:LINKS", "INPLACE p:PLACE COMMA? PUT s:LISTED l:LINKS", "INPLACE p:PLACE COMMA? WHO WANT s:LISTED l:LINKS")
def _at_place(p: Term, s: Names, l: tuple[Link, ...]) -> Relate | None:
    if l[0].denied or l[0].names is None or l[0].names.terms[0].is_place or _before(l, s):
        return None
    return Relate(s, (Link(p.words, INSIDE, Names((p,))), *l), fronted=True)


@rule("CLAUSE", "s:LISTED p:BAREPLACE", "s:LISTED COLON p:BAREPLACE", "p:BAREPLACE BE s:LISTED", "p:BAREPLACE n:AMOUNTED", "'for' p:ALLPLACES COMMA? s:LISTED", "INPLACE? p:ALLPLACES COMMA s:LISTED")
@rule("CLAUSE", "p:HEADPLACE COLON s:LISTED", cost=0.4)
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


@rule("HEADPLACE", "p:BAREPLACE")
def _heading_place(p: Term) -> Term | None:
    """Not "s0:", behind which no one knows what the order means."""
    return None if 0 < p.words.end - p.words.offset < 4 and p.words.text[0] == "s" else p


@rule("HEADPLACE", "w:SIDE", cost=0.5)
def _outermost(w: Word) -> Term | None:
    if "most" not in w.text:
        return None
    return term_of(words_of(w, text=f"{w.means} stack"))


@rule("CLAUSE", "l:LINKS", cost=0.4)
def _links_alone(l: tuple[Link, ...]) -> Relate:
    return Relate(None, l, bare=True)


@rule("CLAUSE", "p:PUTS s:LISTED l:LINKS", "p:PUTS s:LISTED BE l:LINKS", "p:PUTS l:LINKS s:LISTED", "p:PUTS l:LINKS COMMA s:LISTED",
      "l:LINKS COMMA? p:PUTS s:LISTED", "p:PUTS s:LISTED COMMA l:LINKS",
      "l:LINKS COMMA? MUST p:PUTS s:LISTED", "l:LINKS COMMA? p:WANTS s:LISTED", "l:LINKS COMMA? p:WANTS TOSEE s:LISTED", "p:PUTS s:LISTED SOTHAT 'it' VERB l:LINKS", "p:PUTS s:LISTED FLOAT l:LINKS",
      "p:PUTS s:LISTED BE PLACED l:LINKS", "p:PUTS s:LISTED PLACED l:LINKS", "p:PUTS s:LISTED BE e:EDGE")  # fmt: skip
@rule("CLAUSE", "p:TAKES s:LISTED l:LINKS", cost=0.3)
def _command(
    p: bool, s: Names, l: tuple[Link, ...] = (), e: Link | None = None
) -> Relate | None:
    if e is not None:
        return None if p or len(s.terms) > 1 else Relate(s, (e,))
    if _before(l, s) and l[0].denied:
        return None
    return relate(s, l, Verb(p))


@rule("CLAUSE", "s:LISTED COMMA p:PUTS ITORTHEM l:LINKS")
def _command_of_that(p: bool, s: Names, l: tuple[Link, ...]) -> Relate | None:
    return None if any(one.how == "side" for one in l) else relate(s, l, Verb(p))


@rule("CLAUSE", "NOT s:LISTED l:LINKS", cost=0.3)
def _not_so(s: Names, l: tuple[Link, ...]) -> Relate | None:
    if len(l) > 1 or _before(l, s) or any(term.kind is not Kind.THE for term in s.terms):
        return None
    return relate(s, l, Verb(denied=True))


@rule("CLAUSE", "HEADING 'with' s:LISTED", "HEADING OFOF s:LISTED", "HEADING 'out' 'of' s:LISTED", cost=0.5)
def _one_tower(s: Names) -> Relate | None:
    """ "make one tower with all five blocks"."""
    if len(s.terms) > 1 or s.terms[0].kind is not Kind.EVERY or s.terms[0].is_place:
        return None
    term = replace(s.terms[0], bare=False)
    return Relate(Names((term,)), (Link(term.words, how="same"),))


@rule("WANTS", "WHO WANT")
def _wants() -> bool:
    return False


@rule("CLAUSE", "p:PUTS l:LINKS", cost=0.3)
def _command_of_it(p: bool, l: tuple[Link, ...]) -> Relate | None:
    return None if p else Relate(None, l)


@rule("ITORTHEM", "w:IT", "w:BOTHOF", "w:ALLOF", "w:FLOAT")
def _it_or_them(w: Word) -> Word:
    return w


@rule("TAKES", "w:TAKE", "'to' w:TAKE")
def _takes(w: Word) -> bool:
    return False


@rule("PUTS", "w:PUT", "w:PUTTING", "'to' w:PUT")
def _puts(w: Word) -> bool | None:
    return None if w.text == "make" else False


@rule("PUTS", "PUT YOU", cost=0.3)
@rule("PUTS", "MAKE", "'to' MAKE", cost=0.6)
def _makes() -> bool:
    return False


@rule("PUTS", "DO? w:NOT w2:PUT", "'to' w:NOT PUT", "NOT 'to' w:PUT", "YOU MUST w:NOT PUT", "MUST w:NOT PUT", "YOU MAY w:NOT PUT", "AVOID w:PUTTING",
      "DO w:NOT PUT", "DO w:NOT YOU? DARE PUT", "DO w:NOT YOU? DARE PUTTING", "w:NOT PUTTING", "'without' w:PUTTING")  # fmt: skip
def _puts_not(w: Word, w2: Word | None = None) -> bool:
    return True


@rule("CLAUSE", "w:REMOVE WHATIS UPONTHAT s:LISTED", "WHATIS w:UPONTHAT s:LISTED MUST? COMEOFF", "TAKE w:WHATIS UPONTHAT s:LISTED OFFTHERE", "w:CLEARS s:LISTED", "CLEARS THE? w:TOPOF s:LISTED", "PUT w:TOPOF s:LISTED CLEAR", "COVER s:LISTED 'with' w:NOTHING", "THE? w:TOPOF s:LISTED VERB? CLEAR")
def _clear_it(s: Names, w: Word) -> Relate | None:
    return Relate(s, (Link(words_of(w), how="clear"),))


@rule("UPONTHAT", "w:RELATION", "w:TOPOF", "w:OFF")
def _upon_that(w: Word) -> Word | None:
    return w if w.phrase in (None, UPON) or w.text in ("above", "over") else None


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
    if any(term.kind is Kind.COUNT for term in s.terms):
        return None
    return Take(s, o)


@rule("CLAUSE", "TAKE s:LISTED o:OFFLINK COMMA? AND? l:LINKS", "PUT s:LISTED o:OFFLINK COMMA? AND? l:LINKS")
def _take_from_to(s: Names, o: Link, l: tuple[Link, ...]) -> Relate | None:
    if any(one.denied for one in l) or s.either:
        return None
    if "from" in o.words.text:
        return None
    return Relate(s, (o, *l))


@rule("CLAUSE", "s:LISTED o:OFFLINK", "s:LISTED v:VERB o:OFFLINK", cost=0.3)
def _comes_off(s: Names, o: Link, v: Verb | None = None) -> Item | None:
    if (v and not _asked(v, s, False)) or (v and v.denied) or "off" not in o.words.text:
        return None
    return _take_off(s, o)


@rule("CLAUSE", "s:LISTED MUST BE? ANYWHEREBUT l:NOTTHERE", "PUT s:LISTED ANYWHEREBUT l:NOTTHERE", "s:LISTED ANYWHEREBUT l:NOTTHERE",
      "s:LISTED MAY BE ANYWHEREBUT l:NOTTHERE", "s:LISTED BE ANYWHEREBUT l:NOTTHERE")  # fmt: skip
def _anywhere_but(s: Names, l: Link) -> Relate | None:
    return None if s.either or l.denied else Relate(s, (replace(l, denied=True),))


@rule("NOTTHERE", "l:PLAINLINK", "p:PLACE")
def _not_there(l: Link | None = None, p: Term | None = None) -> Link | None:
    return l if p is None else Link(p.words, INSIDE, Names((p,)))


@rule("CLAUSE", "PUT s:LISTED l:LINKS COMMA? ALLBUT e:LISTED")
def _put_but(s: Names, l: tuple[Link, ...], e: Names) -> Relate | None:
    names = but(s, e)
    return names and Relate(names, l)
