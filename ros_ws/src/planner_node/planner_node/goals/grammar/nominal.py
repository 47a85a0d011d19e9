# SPDX-License-Identifier: Apache-2.0
"""What names mean: blocks and places, how many of them, and which by how they stand now."""

from __future__ import annotations

from dataclasses import replace
from typing import Final

from scene_graph import ABOVE, PREDICATES, UP, Phrase

from ..language import PLACE_NOUNS
from ..terms import Described, Kind, Term, Words
from .lattice import Word
from .meaning import Link, Names


def words_of(*said: Word | None, text: str | None = None) -> Words:
    """Some words as one, in their order."""
    there = [one for one in said if one is not None]
    if text is None:
        there.sort(key=lambda word: word.offset)
    told = " ".join(one.means for one in there) if text is None else text
    return Words(told, min(one.offset for one in there), max(one.end for one in there))


# A name: its words, and whether it is of several


def _head(w: Word) -> tuple[Word, bool]:
    plural = w.text.endswith("s") and w.text not in ("roofs",)
    return (replace(w, means="one") if w.text == "ones" else w), plural


def _color(a: Word) -> tuple[Words, bool]:
    return words_of(a), False


def _reds(a: Word) -> tuple[Words, bool]:
    return words_of(a), True


def _noun(h: tuple[Word, bool]) -> tuple[Words, bool] | None:
    return None if h[0].text in ("one", "ones") else (words_of(h[0]), h[1])


def _colored(a: Word, h: tuple[Word, bool]) -> tuple[Words, bool]:
    return words_of(*sorted((a, h[0]), key=lambda word: word.offset)), h[1]


def _doubly(a: Word, b: Word, h: Word) -> tuple[Words, bool]:
    return words_of(a, b, h), False


def _strange(
    u: tuple[Word, ...], a: Word | None = None, h: tuple[Word, bool] | None = None
) -> tuple[Words, bool]:
    return words_of(a, *u, h[0] if h else None), bool(h and h[1])


# A number of blocks


def _exactly(n: Word) -> tuple[int, int | None]:
    return int(n.means), int(n.means)


def _at_least(n: Word) -> tuple[int, int | None]:
    return int(n.means), None


def _at_most(n: Word) -> tuple[int, int | None]:
    return 0, int(n.means)


def _more_than(n: Word) -> tuple[int, int | None]:
    return int(n.means) + 1, None


def _less_than(n: Word) -> tuple[int, int | None] | None:
    return (0, int(n.means) - 1) if int(n.means) else None


def _between(n: Word, m: Word) -> tuple[int, int | None] | None:
    return (int(n.means), int(m.means)) if int(n.means) < int(m.means) else None


# A block, or blocks


def term_of(words: Words, kind: Kind = Kind.THE, **more: object) -> Term:
    """A term of words."""
    return replace(Term(words, kind), **more)  # type: ignore[arg-type]


def _the(n: tuple[Words, bool]) -> Term:
    return term_of(n[0], Kind.EVERY if n[1] else Kind.THE)


def _table(w: Word) -> Term:
    return term_of(words_of(w, text=w.text))


def _some(n: tuple[Words, bool]) -> Term:
    return term_of(n[0], Kind.COUNT)


def _something(a: Word) -> Term:
    return term_of(words_of(a, text="block"), Kind.COUNT)


def _every(n: tuple[Words, bool], k: Word | None = None) -> Term | None:
    exact = int(k.means) if k else None
    if exact in (0, 1):
        return None
    return term_of(n[0], Kind.EVERY, exact=exact)


def _both(n: tuple[Words, bool]) -> Term | None:
    return term_of(n[0], Kind.EVERY, exact=2) if n[1] else None


def _everything(w: Word) -> Term:
    bare = w.text in ("all", "them all", "all of them", "all of it", "it all")
    return term_of(words_of(w, text="block"), Kind.EVERY, bare=bare)


def _none(n: tuple[Words, bool]) -> Term:
    return term_of(n[0], Kind.NO, least=0, most=0)


def _nothing(w: Word) -> Term:
    return term_of(words_of(w, text="block"), Kind.NO, least=0, most=0)


def _thing_colored(w: Word, a: Word) -> Term:
    if w.text.startswith(("no", "z")):
        return term_of(words_of(a), Kind.NO, least=0, most=0)
    return term_of(words_of(a), Kind.EVERY if w.text.startswith("every") else Kind.COUNT)


def _number(q: tuple[int, int | None], n: tuple[Words, bool]) -> Term:
    if q[1] == 0:
        return term_of(n[0], Kind.NO, least=0, most=0)
    return term_of(n[0], Kind.COUNT, least=q[0], most=q[1])


def _just(n: Word) -> tuple[int, int | None]:
    return _exactly(n)


def _not_one(q: tuple[int, int | None]) -> tuple[int, int | None] | None:
    return None if q == (1, 1) else q  # one at least, or one only?


def _bare(q: tuple[int, int | None]) -> Term | None:
    if q == (1, 1):
        return None
    return term_of(Words("block", 0, 0), Kind.COUNT, least=q[0], most=q[1], bare=True)


def _bare_one(w: Word) -> Term | None:
    if w.means != "1":
        return None
    return term_of(words_of(w, text="block"), Kind.COUNT, least=1, most=1, bare=True)


def _each_number(q: tuple[int, int | None], n: tuple[Words, bool]) -> Term:
    return _number(q, n)


def _not_the_other(t: Term) -> Names:
    """ "red, not green, goes on blue"."""
    return Names((t,))


def _of_these(q: tuple[int, int | None], who: Names) -> Term | None:
    if any(one.kind is not Kind.THE for one in who.terms) or q[0] > len(who.terms):
        return None
    first = who.terms[0].words
    among = tuple(one.words for one in who.terms)
    return term_of(first, Kind.COUNT, least=q[0], most=q[1], among=among)


def _all_but(t: Term, who: Names) -> Term | None:
    if any(one.kind not in (Kind.THE, Kind.EVERY) for one in who.terms):
        return None
    if t.kind is Kind.NO and any(one.kind is Kind.THE for one in who.terms):
        if len(who.terms) > 1:
            return None
        return replace(who.terms[0], only=True)  # "nothing but red in stack1"
    return replace(t, but=who.terms, bare=False)


def _all(
    n: tuple[Words, bool] | None = None, w: Word | None = None, p: Term | None = None
) -> Term | None:
    if p is not None:
        return p
    if w is not None:
        return _nothing(w) if w.text.startswith("no") else _everything(w)
    assert n is not None
    return term_of(n[0], Kind.EVERY) if n[1] else None


def _each(n: tuple[Words, bool]) -> Term:
    return term_of(n[0], Kind.EVERY)


def _others(o: Word) -> Term | None:
    if o.text in ("other", "remaining", "leftover", "left over"):
        return None
    return term_of(words_of(o, text="block"), Kind.EVERY, others=True)


def _noun_of_others(n: Word) -> Word | None:
    return None if n.text == "one" else n


def _other_ones(o: Word, n: Word) -> Term:
    text = n.means if n.text not in ("ones", "one") else "block"
    return term_of(words_of(o, text=text), Kind.EVERY, others=True)


def _other_two(o: Word, k: Word) -> Term:
    exact = int(k.means)
    return term_of(words_of(o, text="block"), Kind.EVERY, others=True, exact=exact)


def _nothing_else(w: Word) -> Term | None:
    return term_of(words_of(w, text="block"), Kind.NO, least=0, most=0, others=True)


# Those that were named before


def _another(w: Word) -> Term:
    return term_of(words_of(w, text="block"), Kind.COUNT)


def _not_colored(
    a: Word, n: tuple[Words, bool] | None = None, w: Word | None = None
) -> Term | None:
    words = n[0] if n else words_of(w, text="block")
    return term_of(words, Kind.EVERY, but=(term_of(words_of(a), Kind.EVERY),))


def _it(w: Word) -> Term:
    return term_of(words_of(w, text="it"))


def _they(w: Word) -> Term:
    exact = None if w.text in ("they", "them", "these", "those", "themselves") else 2
    return term_of(words_of(w, text="they"), Kind.EVERY, exact=exact, bare=True)


def _all_of_them(w: Word) -> Term:
    exact = int(w.means) if w.means.isdigit() else None
    return term_of(words_of(w, text="they"), Kind.EVERY, exact=exact, bare=True)


# Places


def _numbered(n: Word, k: Word) -> Term:
    noun = n.text if n.text in PLACE_NOUNS else "stack"
    return term_of(words_of(n, k, text=f"{noun} {k.means}"))


def _some_place(n: Word) -> Term:
    """Asked back with the places that there are."""
    return term_of(words_of(n))


def _digit(k: Word) -> Term | None:
    return term_of(words_of(k, text=f"stack {k.text}")) if k.text.isdigit() else None


def _side_one(s: Word) -> Term:
    return term_of(words_of(s, text=f"{s.means} stack"))


def _numbered_in_one(w: Word) -> Term | None:
    letters = w.text.rstrip("0123456789").rstrip("_-")
    if letters in ("s", "st", "stck", "stk"):
        return term_of(words_of(w, text=f"stack {w.text.removeprefix(letters)}"))
    return term_of(words_of(w))


def _at_side(s: Word) -> Term | None:
    return term_of(words_of(s, text=f"{s.means} stack"))


def _from_left(o: Word) -> Term | None:
    number = int(o.means)
    return term_of(words_of(o, text=f"stack {number - 1}")) if number > 0 else None


def _from_right(o: Word) -> Term | None:
    number = int(o.means)
    return term_of(words_of(o, text=f"stack {number - 1} from right")) if number > 0 else None


def _all_places(w: Word) -> Term:
    return term_of(words_of(w, text="stack"), Kind.EVERY)


def _per_place(w: Word) -> Term | None:
    return None if w.text == "a" else _all_places(w)


def _any_place(w: Word) -> Term | None:
    if w.text in ("some", "another"):
        return None
    return term_of(words_of(w, text="stack"), Kind.COUNT)


def _no_place(w: Word) -> Term:
    return term_of(words_of(w, text="stack"), Kind.NO, least=0, most=0)


# Those that are told by how they stand now


def described(how: str, words: Words, place: bool = False, **more: object) -> Term:
    """A term of the one of which something is true now."""
    return Term(words, described=Described(how, place, **more))  # type: ignore[arg-type]


def _standing(to: Link, n: tuple[Words, bool] | None = None, o: Word | None = None) -> Term | None:
    words = n[0] if n else words_of(o, text="block")
    if (n and n[1]) or to.names is None or to.denied or to.how or to.adjacent:
        return None
    return described("related", words, phrase=to.phrase, others=to.names.terms)


def _topmost(w: Word, p: Term | None = None) -> Term:
    return described("top", words_of(w, text="block"), others=(p,) if p else ())


def _bottommost(w: Word, p: Term | None = None) -> Term:
    return described("bottom", words_of(w, text="block"), others=(p,) if p else ())


def _what_stands(to: Link) -> Term | None:
    if to.names is None or to.how or to.phrase is None:
        return None
    return described(
        "related", replace(to.words, text="block"), phrase=to.phrase, others=to.names.terms
    )


def _by_height(w: Word) -> Term:
    how = "tallest" if w.text in "tallest highest biggest largest longest fullest" else "shortest"
    return described(how, words_of(w, text="stack"), place=True)


def _empty_place(w: Word) -> Term:
    return described("empty", words_of(w, text="stack"), place=True)


def _other_place(w: Word) -> Term:
    return described("other", words_of(w, text="stack"), place=True)


def _place_with(w: Word, who: Names) -> Term | None:
    if (
        who.either
        or who.denied
        or any(one.kind is not Kind.THE or one.is_place for one in who.terms)
    ):
        return None
    return described("with", words_of(w, text="stack"), place=True, others=who.terms)


def _place_of(t: Term, w: Word) -> Term:
    return described("with", words_of(w, text="stack"), place=True, others=(t,))


def _block(n: tuple[Words, bool]) -> Term | None:
    return None if n[1] else term_of(n[0])


# Several names


def _one(t: Term) -> Names:
    return Names((t,))


def _pair(t: Term, u: Term) -> Names | None:
    return _joined((t, u))


def _either(t: Term, u: Term) -> Names:
    return Names((t, u), either=True)


def _series(t: Term, r: Names) -> Names | None:
    joined = _joined((t, *r.terms))
    return joined and replace(joined, either=r.either)


def _last_two(t: Term, u: Term, o: Word | None = None) -> Names | None:
    joined = _joined((t, u))
    return joined and replace(joined, either=o is not None)


def _enumerated(t: Term, u: Term) -> Names | None:
    return _joined((t, u))


def _neither(t: Term, u: Term, v: Term | None = None) -> Names | None:
    terms = (t, u) if v is None else (t, u, v)
    return Names(terms, denied=True) if all(one.kind is Kind.THE for one in terms) else None


def _colors_of(a: Word, b: Word, h: tuple[Word, bool]) -> Names | None:
    if not h[1]:
        return None
    return Names(tuple(term_of(words_of(one, h[0])) for one in (a, b)))


def _three_colors_of(a: Word, b: Word, c: Word, h: tuple[Word, bool]) -> Names | None:
    if not h[1]:
        return None
    return Names(tuple(term_of(words_of(one, h[0])) for one in (a, b, c)))


def _either_color(h: tuple[Word, bool], a: Word, b: Word) -> Names | None:
    if not h[1]:
        return None
    return Names(tuple(term_of(words_of(one, h[0])) for one in (a, b)))


def _places(n: Word, i: Word, j: Word, o: Word | None = None) -> Names | None:
    if n.means == n.text and not j.text.isdigit():
        return None  # "two in stack 0 and one in stack 1"
    places = tuple(term_of(words_of(n, k, text=f"stack {k.means}")) for k in (i, j))
    return Names(places, either=o is not None)


def _range(p: Term | Word, q: Term | Word) -> Names | None:
    ends = [one.means if isinstance(one, Word) else (one.words.base or "")[5:] for one in (p, q)]
    if not all(end.isdigit() for end in ends) or int(ends[0]) >= int(ends[1]):
        return None
    words = p.words if isinstance(p, Term) else words_of(p)
    numbers = range(int(ends[0]), int(ends[1]) + 1)
    return Names(tuple(term_of(replace(words, text=f"stack {number}")) for number in numbers))


def _sides(i: Word, j: Word) -> Names:
    return Names(tuple(term_of(words_of(k, text=f"{k.means} stack")) for k in (i, j)))


def _outer() -> Names:
    return Names(tuple(Term(Words(f"{side} stack", 0, 0)) for side in ("left", "right")))


def _apposed(who: Names) -> Names | None:
    """ "the blocks red and green"."""
    return who if all(one.kind is Kind.THE and not one.is_place for one in who.terms) else None


def _corrected(m: Term) -> Names:
    return Names((m,))


def _to_correct(t: Term) -> Names:
    return Names((t,))


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
