# SPDX-License-Identifier: Apache-2.0
"""What several names mean: "red and blue", "stacks 0 and 1", "neither"."""

from __future__ import annotations

from dataclasses import replace
from typing import Final

from scene_graph import SHAPES

from ..language import NOUNS
from ..terms import Kind, Term, Words
from .lattice import Word
from .lexicon import HUES
from .meaning import Names
from .nominal import term_of, words_of

#: What names are made of.
_NAMING: Final = HUES | frozenset(SHAPES) | NOUNS | {"one"}


def _one(t: Term) -> Names:
    return Names((t,))


def _unjoined(t: Term, u: Term) -> Names | None:
    """ "red blue", but not where one of them may be another word with a slip."""
    return _joined((t, u)) if not any(map(_slipped, (t.words, u.words))) else None


def _slipped(words: Words) -> bool:
    return words.stop - words.offset != len(words.text)


def _pair(t: Term, u: Term, c: Word | None = None) -> Names | None:
    return None if _announced(t, c) else _joined((t, u))


def _announced(t: Term, c: Word | None) -> bool:
    """ "two things: red …" are not one with another."""
    return c is not None and c.text != "," and t.kind is not Kind.THE


def _contrast(t: Term, u: Term, c: Word | None = None) -> Names | None:
    """ "blue, not green"; not "blue, not quite", which is no name, nor "the red not box"."""
    words = u.words.text.split()
    named = all(word in _NAMING or "_" in word for word in words)
    apart = c is not None or not HUES.isdisjoint(words)
    return _one(t) if named and apart and words != t.words.text.split() else None


def _only_it(t: Term, u: Term) -> Names | None:
    """ "yellow, and only yellow"."""
    return _one(replace(t, only=True)) if t.words.text == u.words.text else None


def _either_of(w: Word) -> Names:
    """ "nothing on either": of the two that were named, each."""
    return Names((term_of(words_of(w, text="they"), Kind.EVERY, bare=True),), either=True)


def _both(who: Names) -> Names:
    return replace(who, both=True)


def _either(t: Term, u: Term) -> Names:
    return Names((t, u), either=True)


def _series(t: Term, r: Names, c: Word | None = None) -> Names | None:
    if _announced(t, c):
        return None
    joined = _joined((t, *r.terms))
    return joined and replace(joined, either=r.either)


def _last_two(t: Term, u: Term, o: Word | None = None) -> Names | None:
    joined = _joined((t, u))
    return joined and replace(joined, either=o is not None)


def _neither(t: Term, u: Term, v: Term | None = None) -> Names | None:
    terms = (t, u) if v is None else (t, u, v)
    return Names(terms, denied=True) if all(one.kind is Kind.THE for one in terms) else None


def _colors_of(
    a: Word, b: Word, h: tuple[Word, bool], c: Word | None = None
) -> Names | None:  # fmt: skip
    """ "the red and blue boxes"."""
    colors = (a, b) if c is None else (a, b, c)
    return Names(tuple(term_of(words_of(one, h[0])) for one in colors)) if h[1] else None


def _places(n: Word, i: Word, j: Word, o: Word | None = None) -> Names | None:
    if n.means == n.text and not j.text.isdigit():
        return None  # "two in stack 0 and one in stack 1"
    places = tuple(term_of(words_of(n, k, text=f"stack {k.means}")) for k in (i, j))
    return Names(places, either=o is not None)


def _place_series(n: Word, i: Word, j: Word, k: Word) -> Names:
    return Names(tuple(term_of(words_of(n, one, text=f"stack {one.means}")) for one in (i, j, k)))


def _range(p: Term | Word, q: Term | Word) -> Names | None:
    ends = [one.means if isinstance(one, Word) else (one.words.base or "")[5:] for one in (p, q)]
    if not all(end.isdigit() for end in ends) or int(ends[0]) >= int(ends[1]):
        return None
    words = p.words if isinstance(p, Term) else words_of(p)
    numbers = range(int(ends[0]), int(ends[1]) + 1)
    return Names(tuple(term_of(replace(words, text=f"stack {number}")) for number in numbers))


def _ends(o: Word, k: Word) -> Names | None:
    """ "the last two stacks"."""
    if o.means not in ("1", "-1"):
        return None
    from_right = " from right" if o.means == "-1" else ""
    return Names(
        tuple(
            term_of(words_of(o, text=f"stack {number}{from_right}"))
            for number in range(int(k.means))
        )
    )


def _sides(i: Word, j: Word) -> Names:
    return Names(tuple(term_of(words_of(k, text=f"{k.means} stack")) for k in (i, j)))


def _outer() -> Names:
    return Names(tuple(Term(Words(f"{side} stack", 0, 0)) for side in ("left", "right")))


def _apposed(who: Names) -> Names | None:
    """ "the blocks red and green"."""
    return who if all(one.kind is Kind.THE and not one.is_place for one in who.terms) else None


def _named(who: Names) -> Names | None:
    """Some that are named one by one: "red, blue and green"."""
    return who if all(one.kind is Kind.THE for one in who.terms) and not who.denied else None


def _none_of(who: Names) -> Names | None:
    """ "none of the blocks red, yellow and green"."""
    named = _named(who)
    return named and replace(named, denied=True, either=False)


def _correction(w: Word) -> str:
    return w.text


def _joined(terms: tuple[Term, ...]) -> Names | None:
    if any(term.bare for term in terms[1:]) or (terms[0].bare and terms[0].kind is Kind.COUNT):
        return None  # "red, blue and green: at least one of them"
    if terms[0].partitive and any(term.kind is Kind.THE for term in terms):
        return None  # "one of the red, the blue and the green"
    if any(term.but or term.among for term in terms[:-1]):
        return None  # "all but red and blue"
    if any(term.kind is Kind.NO and not term.others for term in terms):
        return None
    if any(term.kind is Kind.NO for term in terms[:-1]):
        return None
    return Names(terms)
