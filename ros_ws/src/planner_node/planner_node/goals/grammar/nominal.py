# SPDX-License-Identifier: Apache-2.0
"""What names of blocks mean: which of them, and how many."""

from __future__ import annotations

from dataclasses import replace
from typing import Final

from scene_graph import ABOVE, PREDICATES, UP, Phrase

from ..terms import Kind, Term, Words
from .lattice import Word
from .meaning import Names

UPON: Final = Phrase(PREDICATES[UP])
INSIDE: Final = Phrase(PREDICATES[ABOVE], needs_place=True)


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


def _color_behind(a: Word, h: tuple[Word, bool]) -> tuple[Words, bool] | None:
    """ "block red", but not "the blocks red, …", which are told one by one."""
    return None if h[1] else _colored(a, h)


def _shaped(s: Word, a: Word | None = None) -> tuple[Words, bool]:
    """ "the spherical one"."""
    return words_of(a, s), False


def _can(w: Word, a: Word | None = None) -> tuple[Words, bool]:
    """ "the can", a cylinder."""
    return words_of(a, replace(w, means="cylinder")), False


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


def counted_after(k: Word, n: tuple[Words, bool], w: Word) -> Names:
    """ "two blocks at most"."""
    fewer = w.text not in ("or more", "at least", "or above", "at the very least")
    bounds = (0, int(k.means)) if fewer else (int(k.means), None)
    return Names((term_of(n[0], Kind.COUNT, least=bounds[0], most=bounds[1]),))


_counted_after: Final = counted_after


# A block, or blocks


def term_of(words: Words, kind: Kind = Kind.THE, **more: object) -> Term:
    """A term of words."""
    return replace(Term(words, kind), **more)  # type: ignore[arg-type]


def _the(n: tuple[Words, bool]) -> Term:
    return term_of(n[0], Kind.EVERY if n[1] else Kind.THE)


def _the_unknown(d: Word, u: Word, n: tuple[Words, bool]) -> Term | None:
    """ "the shabby red block", where there is only one that is red."""
    together = u.offset - d.end <= 1 and n[0].offset - u.end <= 1
    return _the(n) if together and not n[1] else None


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
    bare = w.text in (
        "the lot",
        "the whole lot",
        "the whole set",
        "the whole bunch",
        "all",
        "them all",
        "all of them",
        "all of it",
        "it all",
    )
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


def _number_of(q: tuple[int, int | None], n: tuple[Words, bool]) -> Term:
    """ "two of the boxes"."""
    return replace(_number(q, n), partitive=True)


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


def of_these(q: tuple[int, int | None], who: Names) -> Term | None:
    """ "two of red, blue and green"; None: there are not so many."""
    if q[0] > len(who.terms) or q[1] == 0:
        return None
    first = who.terms[0].words
    among = tuple(one.words for one in who.terms)
    return term_of(first, Kind.COUNT, least=q[0], most=q[1], among=among)


_of_these: Final = of_these


def _all_but(t: Term, who: Names) -> Term | None:
    if any(one.kind not in (Kind.THE, Kind.EVERY) for one in who.terms):
        return None
    if t.kind is Kind.NO and any(one.kind is Kind.THE for one in who.terms):
        if len(who.terms) > 1:
            return None
        return replace(who.terms[0], only=True)  # "nothing but red in stack1"
    return replace(t, but=who.terms, bare=False)


def _all(
    n: tuple[Words, bool] | None = None, w: Word | None = None, p: Term | None = None,
    o: tuple[Words, bool] | None = None,
) -> Term | None:  # fmt: skip
    if o is not None:
        return _none(o)
    if p is not None:
        return p
    if w is not None:
        return _nothing(w) if w.text.startswith("no") else _everything(w)
    assert n is not None
    return term_of(n[0], Kind.EVERY) if n[1] else None


def _others(o: Word) -> Term | None:
    if o.text in ("other", "remaining", "leftover", "left over"):
        return None
    return term_of(words_of(o, text="block"), Kind.EVERY, others=True)


def _noun_of_others(n: Word) -> Word | None:
    return None if n.text == "one" else n


def _other_ones(o: Word, n: Word) -> Term:
    text = n.means if n.text not in ("ones", "one") else "block"
    return term_of(words_of(o, text=text), Kind.EVERY, others=True)


def _number_of_others(q: tuple[int, int | None], n: Word) -> Term:
    """ "two of the other boxes"."""
    return replace(_number(q, (_other_ones(n, n).words, True)), others=True)


def _other_two(o: Word, k: Word) -> Term:
    exact = int(k.means)
    return term_of(words_of(o, text="block"), Kind.EVERY, others=True, exact=exact)


def _nothing_else(w: Word) -> Term | None:
    return term_of(words_of(w, text="block"), Kind.NO, least=0, most=0, others=True)


# Those that were named before


def _another(w: Word) -> Term:
    return term_of(words_of(w, text="block"), Kind.COUNT)


def _all_not(
    m: tuple[Words, bool], n: tuple[Words, bool] | None = None, w: Word | None = None
) -> Term | None:
    """ "every block that is not red", "all non-boxes"."""
    if n is None and w is None and not m[1]:
        return None  # "non box"
    words = (
        n[0]
        if n
        else Words("block", m[0].offset, m[0].end)
        if w is None
        else words_of(w, text="block")
    )
    return term_of(words, Kind.EVERY, but=(term_of(m[0], Kind.EVERY),))


def _it(w: Word) -> Term:
    return term_of(words_of(w, text="it"))


def _they(w: Word) -> Term:
    exact = None if w.text in ("they", "them", "these", "those", "themselves") else 2
    return term_of(words_of(w, text="they"), Kind.EVERY, exact=exact, bare=True)


def _all_of_them(w: Word) -> Term:
    exact = int(w.means) if w.means.isdigit() else None
    return term_of(words_of(w, text="they"), Kind.EVERY, exact=exact, bare=True)


def _block(n: tuple[Words, bool]) -> Term | None:
    return None if n[1] else term_of(n[0])
