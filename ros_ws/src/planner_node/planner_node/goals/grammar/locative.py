# SPDX-License-Identifier: Apache-2.0
"""What names of places mean, and of what is told by how the blocks stand now."""

from __future__ import annotations

from dataclasses import replace

from ..language import PLACE_NOUNS
from ..terms import Described, Kind, Term, Words
from .lattice import Word
from .meaning import Link, Names
from .nominal import term_of, words_of


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


def _outer_side(s: Word) -> Term | None:
    return _side_one(s) if s.means != "middle" else None  # of the places, or of the tower?


def _numbered_in_one(w: Word) -> Term | None:
    letters = w.text.rstrip("0123456789").rstrip("_-")
    if letters in ("s", "st", "stck", "stk"):
        return term_of(words_of(w, text=f"stack {w.text.removeprefix(letters)}"))
    return term_of(words_of(w))


def _at_side(s: Word) -> Term | None:
    return term_of(words_of(s, text=f"{s.means} stack"))


def _ordinal_alone(o: Word) -> Term | None:
    """ "in the first"."""
    return _ordinal(o, replace(o, text="stack"))


def _from_left(o: Word) -> Term | None:
    number = int(o.means)
    return term_of(words_of(o, text=f"stack {number - 1}")) if number > 0 else None


def _ordinal(o: Word, n: Word) -> Term | None:
    """ "the first stack", "the last"; the second may be the one that is called stack 2."""
    number = int(o.means)
    if number > 1 or n.text not in ("stack", "pile", "column", "slot", "spot", "bay", "bin"):
        return None
    side = f"stack {-number - 1} from right" if number < 0 else f"stack {number - 1}"
    return term_of(words_of(o, text=side))


def _from_right(o: Word) -> Term | None:
    number = int(o.means)
    return term_of(words_of(o, text=f"stack {number - 1} from right")) if number > 0 else None


def _all_places(w: Word, k: Word | None = None) -> Term:
    exact = int(k.means) if k else None
    return term_of(words_of(w, text="stack"), Kind.EVERY, exact=exact)


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
