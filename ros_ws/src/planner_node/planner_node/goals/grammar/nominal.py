# SPDX-License-Identifier: Apache-2.0
"""Rules for names: blocks and places, how many of them, and which by how they stand now."""

from __future__ import annotations

from dataclasses import replace
from typing import Final

from scene_graph import ABOVE, PREDICATES, UP, Phrase

from ..language import PLACE_NOUNS
from ..terms import Described, Kind, Term, Words
from .chart import Grammar
from .lattice import Word
from .meaning import Link, Names

GRAMMAR: Final = Grammar()
rule = GRAMMAR.rule


def words_of(*said: Word | None, text: str | None = None) -> Words:
    """Some words as one, in their order."""
    there = [one for one in said if one is not None]
    if text is None:
        there.sort(key=lambda word: word.offset)
    told = " ".join(one.means for one in there) if text is None else text
    return Words(told, min(one.offset for one in there), max(one.end for one in there))


# A name: its words, and whether it is of several


@rule("HEAD", "w:NOUN", "w:SHAPE", "w:ONE", "w:NOUNS", "w:SHAPES")
def _head(w: Word) -> tuple[Word, bool]:
    plural = w.text.endswith("s") and w.text not in ("roofs",)
    return (replace(w, means="one") if w.text == "ones" else w), plural


@rule("NAME", "a:COLOR", "a:FULLNAME")
def _color(a: Word) -> tuple[Words, bool]:
    return words_of(a), False


@rule("NAME", "a:REDS")
def _reds(a: Word) -> tuple[Words, bool]:
    return words_of(a), True


@rule("NAME", "h:HEAD")
def _noun(h: tuple[Word, bool]) -> tuple[Words, bool] | None:
    return None if h[0].text in ("one", "ones") else (words_of(h[0]), h[1])


@rule("NAME", "a:COLOR COLORED? h:HEAD", "h:HEAD COLORED? a:COLOR", "h:HEAD WHICH BE COLORED? a:COLOR",
      "h:HEAD WHICH BE THE a:COLOR 'one'")  # fmt: skip
def _colored(a: Word, h: tuple[Word, bool]) -> tuple[Words, bool]:
    return words_of(*sorted((a, h[0]), key=lambda word: word.offset)), h[1]


@rule("NAME", "a:COLOR b:SHAPE h:NOUN")
def _doubly(a: Word, b: Word, h: Word) -> tuple[Words, bool]:
    return words_of(a, b, h), False


@rule("NAME", "u:STRANGE+ h:HEAD?", "a:COLOR u:STRANGE+ h:HEAD?", "u:STRANGE+ a:COLOR h:HEAD?", cost=4.0)
def _strange(
    u: tuple[Word, ...], a: Word | None = None, h: tuple[Word, bool] | None = None
) -> tuple[Words, bool]:
    return words_of(a, *u, h[0] if h else None), bool(h and h[1])


@rule("STRANGE", "w:UNKNOWN", "w:SLIP", "w:TWIN")
def _stranger(w: Word) -> Word:
    return w


# A number of blocks


@rule("AMOUNT", "n:NUMBER", "EXACTLY n:NUMBER", "n:NUMBER EXACTLY", cost=0.0)
def _exactly(n: Word) -> tuple[int, int | None]:
    return int(n.means), int(n.means)


@rule("AMOUNT", "ATLEAST n:NUMBER", "n:NUMBER ORMORE")
def _at_least(n: Word) -> tuple[int, int | None]:
    return int(n.means), None


@rule("AMOUNT", "ATMOST n:NUMBER", "n:NUMBER ORLESS")
def _at_most(n: Word) -> tuple[int, int | None]:
    return 0, int(n.means)


@rule("AMOUNT", "MORETHAN n:NUMBER")
def _more_than(n: Word) -> tuple[int, int | None]:
    return int(n.means) + 1, None


@rule("AMOUNT", "LESSTHAN n:NUMBER")
def _less_than(n: Word) -> tuple[int, int | None] | None:
    return (0, int(n.means) - 1) if int(n.means) else None


@rule("AMOUNT", "BETWEEN n:NUMBER 'and' m:NUMBER", "n:NUMBER 'to' m:NUMBER", "n:NUMBER 'or' m:NUMBER",
      "ATLEAST n:NUMBER COMMA? BUT? COMMA? ATMOST m:NUMBER",
      "ATLEAST n:NUMBER 'and' ATMOST m:NUMBER")  # fmt: skip
def _between(n: Word, m: Word) -> tuple[int, int | None] | None:
    return (int(n.means), int(m.means)) if int(n.means) < int(m.means) else None


# A block, or blocks


def term_of(words: Words, kind: Kind = Kind.THE, **more: object) -> Term:
    """A term of words."""
    return replace(Term(words, kind), **more)  # type: ignore[arg-type]


@rule("TERM", "THE? n:NAME")
def _the(n: tuple[Words, bool]) -> Term:
    return term_of(n[0], Kind.EVERY if n[1] else Kind.THE)


@rule("TERM", "THE? w:TABLE", cost=1.0)
def _table(w: Word) -> Term:
    return term_of(words_of(w, text=w.text))


@rule("TERM", "A n:NAME", "SOMETHING n:NAME")
def _some(n: tuple[Words, bool]) -> Term:
    return term_of(n[0], Kind.COUNT)


@rule("TERM", "a:SOMETHING")
def _something(a: Word) -> Term:
    return term_of(words_of(a, text="block"), Kind.COUNT)


@rule("TERM", "EVERY n:NAME", "EVERY THE n:NAME", "EVERY k:NUMBER n:NAME", "EVERY THE k:NUMBER n:NAME",
      "BOTH n:NAME", "BOTH THE n:NAME", "THE k:NUMBER n:NAME")  # fmt: skip
def _every(n: tuple[Words, bool], k: Word | None = None) -> Term | None:
    exact = int(k.means) if k else None
    if exact in (0, 1):
        return None
    return term_of(n[0], Kind.EVERY, exact=exact)


@rule("TERM", "BOTH n:NAME", "BOTH THE n:NAME")
def _both(n: tuple[Words, bool]) -> Term | None:
    return term_of(n[0], Kind.EVERY, exact=2) if n[1] else None


@rule("TERM", "w:EVERYTHING")
def _everything(w: Word) -> Term:
    bare = w.text in ("all", "them all", "all of them")
    return term_of(words_of(w, text="block"), Kind.EVERY, bare=bare)


@rule("TERM", "NO n:NAME", "NO THE n:NAME", "NO EVERY? THE? n:NAME")
def _none(n: tuple[Words, bool]) -> Term:
    return term_of(n[0], Kind.NO, least=0, most=0)


@rule("TERM", "w:NOTHING")
def _nothing(w: Word) -> Term:
    return term_of(words_of(w, text="block"), Kind.NO, least=0, most=0)


@rule("TERM", "w:NOTHING a:COLOR", "w:EVERYTHING a:COLOR", "w:SOMETHING a:COLOR")
def _thing_colored(w: Word, a: Word) -> Term:
    if w.text.startswith(("no", "z")):
        return term_of(words_of(a), Kind.NO, least=0, most=0)
    return term_of(words_of(a), Kind.EVERY if w.text.startswith("every") else Kind.COUNT)


@rule("TERM", "q:AMOUNT n:NAME", "q:SEVERAL 'of' THE n:NAME", "q:SEVERAL 'of' THE k:NUMBER n:NAME")
def _number(q: tuple[int, int | None], n: tuple[Words, bool], k: Word | None = None) -> Term:
    if q[1] == 0:
        return term_of(n[0], Kind.NO, least=0, most=0)
    return term_of(n[0], Kind.COUNT, least=q[0], most=q[1])


@rule("SEVERAL", "EXACTLY n:NUMBER")
def _just(n: Word) -> tuple[int, int | None]:
    return _exactly(n)


@rule("SEVERAL", "q:AMOUNT")
def _not_one(q: tuple[int, int | None]) -> tuple[int, int | None] | None:
    return None if q == (1, 1) else q  # one at least, or one only?


@rule("TERM", "q:AMOUNT", "q:AMOUNT 'of' 'them'", cost=0.6)
def _bare(q: tuple[int, int | None]) -> Term | None:
    if q == (1, 1):
        return None
    return term_of(Words("block", 0, 0), Kind.COUNT, least=q[0], most=q[1], bare=True)


@rule("TERM", "w:NUMBER", "EXACTLY w:NUMBER", cost=0.6)
def _bare_one(w: Word) -> Term | None:
    if w.means != "1":
        return None
    return term_of(words_of(w, text="block"), Kind.COUNT, least=1, most=1, bare=True)


@rule("TERM", "q:AMOUNT n:NAME 'each'")
def _each_number(q: tuple[int, int | None], n: tuple[Words, bool]) -> Term:
    return _number(q, n)


@rule("LISTED", "t:BLOCK COMMA? NOT u:BLOCK COMMA?", cost=0.5)
def _not_the_other(t: Term, u: Term) -> Names:
    """ "red, not green, goes on blue"."""
    return Names((t,))


@rule("TERM", "q:SEVERAL 'of' l:PAIR", "q:SEVERAL 'of' l:SERIES")
def _of_these(q: tuple[int, int | None], l: Names) -> Term | None:
    if any(one.kind is not Kind.THE for one in l.terms) or q[0] > len(l.terms):
        return None
    first = l.terms[0].words
    among = tuple(one.words for one in l.terms)
    return term_of(first, Kind.COUNT, least=q[0], most=q[1], among=among)


@rule("TERM", "t:TERMALL ALLBUT l:LISTED", "t:TERMALL COMMA ALLBUT l:LISTED")
def _all_but(t: Term, l: Names) -> Term | None:
    if any(one.kind not in (Kind.THE, Kind.EVERY) for one in l.terms):
        return None
    if t.kind is Kind.NO and any(one.kind is Kind.THE for one in l.terms):
        if len(l.terms) > 1:
            return None
        return replace(l.terms[0], only=True)  # "nothing but red in stack1"
    return replace(t, but=l.terms, bare=False)


@rule("TERMALL", "EVERY? THE? n:NAME", "w:EVERYTHING", "w:NOTHING", "NO n:NAME", "p:ALLPLACES")
def _all(
    n: tuple[Words, bool] | None = None, w: Word | None = None, p: Term | None = None
) -> Term | None:
    if p is not None:
        return p
    if w is not None:
        return _nothing(w) if w.text.startswith("no") else _everything(w)
    assert n is not None
    return term_of(n[0], Kind.EVERY) if n[1] else None


@rule("TERMALL", "EVERY n:NAME")
def _each(n: tuple[Words, bool]) -> Term:
    return term_of(n[0], Kind.EVERY)


@rule("TERM", "THE o:OTHER", "o:EVERYTHING ELSE", "EVERY THE? o:OTHER NAME?", "THE o:OTHER OTHERNOUNS",
      "EVERY THE OTHER 'of' o:THE NOUNS")  # fmt: skip
def _others(o: Word) -> Term | None:
    if o.text in ("other", "remaining", "leftover", "left over"):
        return None
    return term_of(words_of(o, text="block"), Kind.EVERY, others=True)


@rule("OTHERNOUNS", "n:NOUNS", "n:ONE")
def _noun_of_others(n: Word) -> Word | None:
    return None if n.text == "one" else n


@rule("TERM", "EVERY? THE? o:OTHER n:OTHERNOUNS", "EVERY? THE? o:OTHER n:SHAPES", "THE o:OTHER 'of' THE n:NOUNS",
      "EVERY o:OTHER n:NOUN", "EVERY o:OTHER n:SHAPE")  # fmt: skip
def _other_ones(o: Word, n: Word) -> Term:
    text = n.means if n.text not in ("ones", "one") else "block"
    return term_of(words_of(o, text=text), Kind.EVERY, others=True)


@rule("TERM", "THE? o:OTHER k:NUMBER NOUNS?")
def _other_two(o: Word, k: Word) -> Term:
    exact = int(k.means)
    return term_of(words_of(o, text="block"), Kind.EVERY, others=True, exact=exact)


@rule("TERM", "w:NOTHING ELSE", "NO w:OTHER HEAD?", "NO w:OTHER")
def _nothing_else(w: Word) -> Term | None:
    return term_of(words_of(w, text="block"), Kind.NO, least=0, most=0, others=True)


# Those that were named before


@rule("TERM", "SOMETHING w:OTHER HEAD", "A w:OTHER HEAD", "w:ANOTHER HEAD")
def _another(w: Word) -> Term:
    return term_of(words_of(w, text="block"), Kind.COUNT)


@rule("TERM", "EVERY THE? n:NAME WHICH BE NOT a:COLOR", "THE n:NAME WHICH BE NOT a:COLOR", "w:EVERYTHING WHICH BE NOT a:COLOR")
def _not_colored(a: Word, n: tuple[Words, bool] | None = None, w: Word | None = None) -> Term | None:
    words = n[0] if n else words_of(w, text="block")
    return term_of(words, Kind.EVERY, but=(term_of(words_of(a), Kind.EVERY),))


@rule("TERM", "w:IT")
def _it(w: Word) -> Term:
    return term_of(words_of(w, text="it"))


@rule("TERM", "w:BOTHOF")
def _they(w: Word) -> Term:
    exact = None if w.text in ("they", "them", "these", "those", "themselves") else 2
    return term_of(words_of(w, text="they"), Kind.EVERY, exact=exact, bare=True)


@rule("TERM", "w:ALLOF")
def _all_of_them(w: Word) -> Term:
    exact = int(w.means) if w.means.isdigit() else None
    return term_of(words_of(w, text="they"), Kind.EVERY, exact=exact, bare=True)


# Places


@rule("PLACE", "THE? n:PLACENOUN NR? k:INDEX", "THE? n:PLACENOUN k:INDEX")
def _numbered(n: Word, k: Word) -> Term:
    noun = n.text if n.text in PLACE_NOUNS else "stack"
    return term_of(words_of(n, k, text=f"{noun} {k.means}"))


@rule("TERM", "THE? n:PLACENOUN", cost=1.5)
def _some_place(n: Word) -> Term:
    """Asked back with the places that there are."""
    return term_of(words_of(n))


@rule("PLACE", "THE s:SIDE 'one'", cost=0.6)
def _side_one(s: Word) -> Term:
    return term_of(words_of(s, text=f"{s.means} stack"))


@rule("PLACE", "THE? w:NUMBERED")
def _numbered_in_one(w: Word) -> Term | None:
    letters = w.text.rstrip("0123456789").rstrip("_-")
    if letters in ("s", "st", "stck", "stk"):
        return term_of(words_of(w, text=f"stack {w.text.removeprefix(letters)}"))
    return term_of(words_of(w))


@rule("PLACE", "THE? s:SIDE PLACENOUN", "THE? PLACENOUN 'on' THE s:SIDE", "THE? PLACENOUN 'in' THE s:SIDE",
      "THE PLACENOUN 'to' THE s:SIDE", "THE PLACENOUN 'at' THE s:SIDE END?",
      "THE PLACENOUN WHICH BE FURTHEST? TOSIDE? THE s:SIDE", "THE PLACENOUN FURTHEST TOSIDE THE s:SIDE",
      "THE? PLACENOUN TOSIDE THE s:SIDE END")  # fmt: skip
def _at_side(s: Word) -> Term | None:
    if s.text == "center" and False:
        return None
    return term_of(words_of(s, text=f"{s.means} stack"))


@rule("PLACE", "THE? o:ORDINAL PLACENOUN COMMA? FROMLEFT", "THE? PLACENOUN WHICH BE o:ORDINAL COMMA? FROMLEFT")
def _from_left(o: Word) -> Term | None:
    number = int(o.means)
    return term_of(words_of(o, text=f"stack {number - 1}")) if number > 0 else None


@rule("PLACE", "THE? o:ORDINAL PLACENOUN COMMA? FROMRIGHT")
def _from_right(o: Word) -> Term | None:
    number = int(o.means)
    return term_of(words_of(o, text=f"stack {number - 1} from right")) if number > 0 else None


@rule("PLACE", "THE? TABLE INPLACE? p:PLACE", "THE? TABLE 'in' p:PLACE")
def _table_there(p: Term) -> Term:
    return p


@rule("ALLPLACES", "w:EVERY PLACENOUN", "w:EVERY PLACENOUNS")
def _all_places(w: Word) -> Term:
    return term_of(words_of(w, text="stack"), Kind.EVERY)


@rule("PERPLACE", "w:PER PLACENOUN")
def _per_place(w: Word) -> Term | None:
    return None if w.text == "a" else _all_places(w)


@rule("TERM", "p:PLACE", "p:ALLPLACES")
def _place(p: Term) -> Term:
    return p


@rule("TERM", "w:A 'one' PLACENOUN", "w:A 'single' PLACENOUN", "w:SOMETHING PLACENOUN", "w:SOMETHING PLACENOUNS", "w:A PLACENOUN")
def _any_place(w: Word) -> Term | None:
    if w.text in ("some", "another"):
        return None
    return term_of(words_of(w, text="stack"), Kind.COUNT)


@rule("TERM", "w:NO PLACENOUN", "w:NO PLACENOUNS")
def _no_place(w: Word) -> Term:
    return term_of(words_of(w, text="stack"), Kind.NO, least=0, most=0)


# Those that are told by how they stand now


def described(how: str, words: Words, place: bool = False, **more: object) -> Term:
    """A term of the one of which something is true now."""
    return Term(words, described=Described(how, place, **more))  # type: ignore[arg-type]


@rule("TERM", "THE n:NAME WHICH BE NOW? l:PLAINLINK", "THE o:ONE WHICH BE NOW? l:PLAINLINK",
      "THE n:NAME WHICH PAST NOW? l:PLAINLINK", "THE o:ONE WHICH PAST NOW? l:PLAINLINK",
      "WHICHEVER n:NAME BE NOW? l:PLAINLINK",
      cost=0.5)  # fmt: skip
@rule("TERM", "THE n:NAME NOW? l:PLAINLINK", "THE o:ONE NOW? l:PLAINLINK", cost=2.0)
def _standing(
    l: Link, n: tuple[Words, bool] | None = None, o: Word | None = None
) -> Term | None:
    words = n[0] if n else words_of(o, text="block")
    if (n and n[1]) or l.names is None or l.denied or l.how or l.adjacent:
        return None
    return described("related", words, phrase=l.phrase, others=l.names.terms)


@rule("TERM", "THE w:TOPMOST HEAD", "THE w:TOPMOST HEAD INOF p:TERM", "THE w:TOPMOST 'of' p:TERM",
      "WHATEVER w:ATTOP INOF p:TERM", "WHATEVER w:ATTOP", "WHATEVER w:TOPOF p:TERM",
      "THE ONE w:TOPOF p:PLACE", "THE HEAD w:TOPOF p:PLACE", "THE ONE w:ATTOP", cost=0.8)  # fmt: skip
def _topmost(w: Word, p: Term | None = None) -> Term:
    return described("top", words_of(w, text="block"), others=(p,) if p else ())


@rule("TERM", "THE w:LOWEST HEAD", "THE w:LOWEST HEAD INOF p:TERM", "WHATEVER w:ATBOTTOM INOF p:TERM",
      "THE ONE w:BOTTOMOF p:PLACE", "THE HEAD w:BOTTOMOF p:PLACE", "THE ONE w:ATBOTTOM", cost=0.8)  # fmt: skip
def _bottommost(w: Word, p: Term | None = None) -> Term:
    return described("bottom", words_of(w, text="block"), others=(p,) if p else ())


@rule("INOF", "w:OFOF", "w:INPLACE")
def _in_of(w: Word) -> Word:
    return w


@rule("WHATEVER", "'what' BE NOW?", "'whatever' BE NOW?", "'whichever' HEAD? BE NOW?")
def _whatever() -> str:
    return "whatever"


@rule("TERM", "'what' BE NOW? l:PLAINLINK", "'whatever' BE NOW? l:PLAINLINK", cost=1.5)
def _what_stands(l: Link) -> Term | None:
    if l.names is None or l.how or l.phrase is None:
        return None
    return described("related", replace(l.words, text="block"), phrase=l.phrase, others=l.names.terms)


@rule("TERM", "THE w:TALLEST PLACENOUN", "THE w:SHORTEST PLACENOUN", cost=0.3)
def _by_height(w: Word) -> Term:
    how = "tallest" if w.text in "tallest highest biggest largest longest fullest" else "shortest"
    return described(how, words_of(w, text="stack"), place=True)


@rule("TERM", "THE w:EMPTYNOW PLACENOUN", "A w:EMPTYNOW PLACENOUN", cost=0.3)
def _empty_place(w: Word) -> Term:
    return described("empty", words_of(w, text="stack"), place=True)


@rule("TERM", "THE w:OTHER PLACENOUN", cost=0.3)
def _other_place(w: Word) -> Term:
    return described("other", words_of(w, text="stack"), place=True)


@rule("TERM", "THE w:PLACENOUN 'with' l:LISTED 'in'? 'it'?", "THE w:PLACENOUN WHERE l:LISTED BE NOW?",
      "THE w:PLACENOUN WHICH HAS l:LISTED", "THE w:PLACENOUN OF l:LISTED", "THE w:PLACENOUN WHICH l:LISTED BE NOW? 'in' 'now'?",
      cost=0.5)  # fmt: skip
def _place_with(w: Word, l: Names) -> Term | None:
    if l.either or l.denied or any(one.kind is not Kind.THE or one.is_place for one in l.terms):
        return None
    return described("with", words_of(w, text="stack"), place=True, others=l.terms)


@rule("TERM", "t:BLOCK POSS w:PLACENOUN", cost=0.3)
def _place_of(t: Term, w: Word) -> Term:
    return described("with", words_of(w, text="stack"), place=True, others=(t,))


@rule("BLOCK", "THE? n:NAME")
def _block(n: tuple[Words, bool]) -> Term | None:
    return None if n[1] else term_of(n[0])


# Several names


@rule("LISTED", "t:TERM")
def _one(t: Term) -> Names:
    return Names((t,))


@rule("LISTED", "BOTHAND? l:SERIES", "BOTHAND? l:PAIR")
def _several(l: Names) -> Names:
    return l


@rule("BOTHAND", "w:BOTH")
def _both_and(w: Word) -> Word:
    return w


@rule("PAIR", "t:TERM AND u:TERM")
@rule("PAIR", "t:TERM u:TERM", cost=2.0)
def _pair(t: Term, u: Term) -> Names | None:
    return _joined((t, u))


@rule("PAIR", "t:TERM 'or' u:TERM", "'either' t:TERM 'or' u:TERM")
def _either(t: Term, u: Term) -> Names:
    return Names((t, u), either=True)


@rule("SERIES", "t:TERM COMMA r:SERIES", "t:TERM COMMA r:LASTTWO", "t:TERM AND r:LASTTWO", "t:TERM AND r:SERIES")
@rule("SERIES", "t:TERM r:LASTTWO", cost=2.0)
def _series(t: Term, r: Names) -> Names | None:
    joined = _joined((t, *r.terms))
    return joined and replace(joined, either=r.either)


@rule("LASTTWO", "t:TERM COMMA? AND u:TERM", "t:TERM COMMA? o:OR u:TERM")
@rule("LASTTWO", "t:TERM COMMA u:TERM", cost=0.4)
def _last_two(t: Term, u: Term, o: Word | None = None) -> Names | None:
    joined = _joined((t, u))
    return joined and replace(joined, either=o is not None)


@rule("PAIR", "t:TERM COMMA u:TERM", cost=0.4)
def _enumerated(t: Term, u: Term) -> Names | None:
    return _joined((t, u))


@rule("LISTED", "'neither' t:TERM COMMA? 'nor' u:TERM", "'neither' t:TERM COMMA? 'or' u:TERM", "'not' t:TERM COMMA? 'nor' u:TERM",
      "'neither' t:TERM COMMA? 'nor' u:TERM COMMA? 'nor' v:TERM")  # fmt: skip
def _neither(t: Term, u: Term, v: Term | None = None) -> Names | None:
    terms = (t, u) if v is None else (t, u, v)
    return Names(terms, denied=True) if all(one.kind is Kind.THE for one in terms) else None


@rule("LISTED", "THE? a:COLOR AND THE? b:COLOR h:HEAD")
def _colors_of(a: Word, b: Word, h: tuple[Word, bool]) -> Names | None:
    if not h[1]:
        return None
    return Names(tuple(term_of(words_of(one, h[0])) for one in (a, b)))


@rule("LISTED", "THE? a:COLOR COMMA b:COLOR COMMA? AND c:COLOR h:HEAD")
def _three_colors_of(a: Word, b: Word, c: Word, h: tuple[Word, bool]) -> Names | None:
    if not h[1]:
        return None
    return Names(tuple(term_of(words_of(one, h[0])) for one in (a, b, c)))


@rule("LISTED", "THE h:HEAD WHICH BE a:COLOR OR b:COLOR", "THE h:HEAD WHICH BE a:COLOR AND b:COLOR")
def _either_color(h: tuple[Word, bool], a: Word, b: Word) -> Names | None:
    if not h[1]:
        return None
    return Names(tuple(term_of(words_of(one, h[0])) for one in (a, b)))


@rule("LISTED", "THE? n:PLACENOUNS NR? i:INDEX COMMA? AND j:INDEX",
      "THE? n:PLACENOUN i:INDEX o:OR j:INDEX", "THE? n:PLACENOUN i:INDEX AND j:INDEX")  # fmt: skip
def _places(n: Word, i: Word, j: Word, o: Word | None = None) -> Names | None:
    if n.means == n.text and not j.text.isdigit():
        return None  # "two in stack 0 and one in stack 1"
    places = tuple(term_of(words_of(n, k, text=f"stack {k.means}")) for k in (i, j))
    return Names(places, either=o is not None)


@rule("LISTED", "p:PLACE THROUGH q:PLACE", "THE? PLACENOUNS p:INDEX THROUGH q:INDEX")
def _range(p: Term | Word, q: Term | Word) -> Names | None:
    ends = [one.means if isinstance(one, Word) else (one.words.base or "")[5:] for one in (p, q)]
    if not all(end.isdigit() for end in ends) or int(ends[0]) >= int(ends[1]):
        return None
    words = p.words if isinstance(p, Term) else words_of(p)
    numbers = range(int(ends[0]), int(ends[1]) + 1)
    return Names(tuple(term_of(replace(words, text=f"stack {number}")) for number in numbers))


@rule("LISTED", "THE? i:SIDE AND THE? j:SIDE n:PLACENOUN", "THE? i:SIDE AND THE? j:SIDE n:PLACENOUNS")
def _sides(i: Word, j: Word, n: Word) -> Names:
    return Names(tuple(term_of(words_of(k, text=f"{k.means} stack")) for k in (i, j)))


@rule("LISTED", "l:LISTED1 CORRECTED m:TERM", cost=0.8)
def _corrected(l: Names, m: Term) -> Names:
    return Names((m,))


@rule("LISTED1", "t:TERM")
def _to_correct(t: Term) -> Names:
    return Names((t,))


@rule("CORRECTED", "COMMA* CORRECTION COMMA?", "COMMA* CORRECTION COMMA? CORRECTION COMMA?", "COMMA* CORRECTION1 COMMA? CORRECTION COMMA?")
@rule("CORRECTED", "COMMA* w:CORRECTION1 COMMA?", cost=0.6)
def _correction(w: Word | None = None) -> str:
    return "no" if w is None else w.text


def _joined(terms: tuple[Term, ...]) -> Names | None:
    if any(term.bare and term.kind is Kind.EVERY for term in terms[1:]):
        return None
    if any(term.but or term.among for term in terms[:-1]):
        return None  # "all but red and blue"
    if any(term.kind is Kind.NO and not term.others for term in terms):
        return None
    if any(term.kind is Kind.NO for term in terms[:-1]):
        return None
    return Names(terms)


UPON: Final = Phrase(PREDICATES[UP])
INSIDE: Final = Phrase(PREDICATES[ABOVE], needs_place=True)
