# SPDX-License-Identifier: Apache-2.0
"""Rules for whole texts: wishes around clauses, several of them, corrections, what says nothing."""

from __future__ import annotations

from dataclasses import replace

from scene_graph import LEFT

from ..terms import Kind, Term
from .claims import key_of
from .clausal import but
from .lattice import Word
from .lexicon import BAD
from .meaning import Again, Change, Item, Link, Mention, Names, Relate, Row, Take
from .nominal import UPON, words_of
from .verbal import Verb, asked, relate

#: Ends of words that tell how something is, or was.
_TELLING = ("ed", "en", "ly", "less", "ing", "ful")

# Who wishes


# What stands in front of a wish


def _under(c: Item, f: bool = False) -> Item | None:
    """A wish, or what is not wished."""
    item = c
    if not f:
        return item
    if not isinstance(item, Relate) or item.denied or item.subject is None:
        return None
    subject = item.subject
    if subject.denied or any(term.only or term.kind is Kind.NO for term in subject.terms):
        return None
    return relate(subject, item.links, Verb(denied=True))


def _tower_of(c: Item) -> Item | None:
    """ "a tower with red on blue", but not "a tower of red and blue": which of them on which?"""
    return None if _of_several(c) else c


def _of_several(item: Item) -> bool:
    return isinstance(item, Relate) and item.subject is not None and len(item.subject.terms) > 1


def _may(c: Item) -> Item | None:
    """ "can red be on blue?", a wish; but not "can stack 1 hold three blocks?", a question."""
    if not isinstance(c, Relate) or c.subject is None:
        return c
    place, block = c.links[0].names, c.subject.terms[0].words
    told_first = (
        place is not None
        and place.terms[0].is_place
        and (not block.stop or place.terms[0].words.stop <= block.offset)
    )
    return None if told_first else c


# What says nothing


def _spread(c: Row) -> Row | None:
    """ "from left to right: red, blue, each in its own stack"."""
    return c if c.predicate == LEFT else None


def _again(n: Names) -> Again | None:
    return None if n.either or n.denied else Again(n)


def _respectively(s: Names, w: Word, o: Names) -> tuple[Item, ...] | None:
    """ "red and blue in stacks 0 and 1 respectively"."""
    terms = (*s.terms, *o.terms)
    if len(s.terms) != len(o.terms) or any(term.kind is not Kind.THE for term in terms):
        return None
    pairs = zip(s.terms, o.terms, strict=True)
    return tuple(
        Relate(Names((one,)), (Link(words_of(w), w.phrase, Names((other,))),))
        for one, other in pairs
    )


def _but_those(
    s: Names, m: tuple[Link, ...], e: Names, to: tuple[Link, ...], v: Verb, u: Verb | None = None
) -> tuple[Item, ...] | None:
    """ "all in stack 0 except red, which goes to stack 1"."""
    names = but(s, e)
    if names is None or s.terms[0].kind is not Kind.EVERY:
        return None
    said = relate(names, m, u), relate(e, to, v)
    wished = asked(u, names, False) and asked(v, e, False)
    return said if wished and None not in said else None  # type: ignore[return-value]


def _again_but(n: Names, to: tuple[Link, ...]) -> tuple[Item, ...]:
    """ "the same for red, but on green"."""
    return (Relate(n, to, bare=True),)


def _again_not(n: Names, v: Verb) -> Again | None:
    one = len(n.terms) == 1 and n.terms[0].kind is Kind.THE
    return Again(n, contrary=True) if one and v == Verb(denied=True) else None


def _again_denied(n: Names) -> Again | None:
    return None if n.either or n.denied else Again(n, denied=True)


# Changes of what is there now


def _swap(w: Word, n: Names | None = None, m: object = None, o: object = None) -> Change | None:
    names = n or Names((m, o))  # type: ignore[arg-type]
    if names.either or names.denied:
        return None
    return Change("swap", words_of(w), names)


def _keep(n: Names, w: Word | None = None) -> Change | None:
    if n.either or n.denied or any(term.others for term in n.terms):
        return None
    return Change("keep", n.terms[0].words if w is None else words_of(w), n)


def _turn(n: Names, w: Word) -> Change | None:
    if n.either or n.denied or len(n.terms) > 1:
        return None
    return Change("turn", words_of(w), n)


def _turn_tower(w: Word) -> Change:
    return Change("turn", words_of(w))


def _same(w: Word) -> Change:
    return Change("same", words_of(w))


def _shift(n: Names, k: int, w: Word) -> Change | None:
    if n.either or n.denied:
        return None
    return Change("shift", words_of(w), n, k if w.text == "right" else -k)


def _steps(k: Word | None = None, w: Word | None = None) -> int | None:
    if w is not None and w.text not in ("a", "one"):
        return None
    return int(k.means) if k else 1


def _to_side_word(w: Word) -> Word | None:
    return w if w.text in ("left", "right") else None


# Several of them


def _mention(b: Term) -> tuple[Item, ...]:
    return (Mention(b),)


def _told(b: Term) -> tuple[Item, ...]:
    """ "red is lonely, so put blue next to it"."""
    return (Mention(b, told=True),)


#: An item, and how it is joined to what stands in front of it.
Joined = tuple[str, tuple[Item, ...]]


def _last(i: tuple[Item, ...]) -> tuple[Joined, ...]:
    return (("", i),)


def _aside_word(w: Word) -> Word | None:
    """What names something else, not what says that it is, or is not, so."""
    return None if w.text in BAD or w.text.endswith(_TELLING) or len(w.text) == 1 else w


def _beside_aside(r: tuple[Joined, ...] = (), i: tuple[Item, ...] = ()) -> tuple[Joined, ...]:
    return r or (("", i),)


def _more(i: tuple[Item, ...], r: tuple[Joined, ...], s: str = "") -> tuple[Joined, ...] | None:
    first = r[0][1][0] if r[0][1] else None
    if i and isinstance(first, Relate) and first.subject is None:
        taken = isinstance(i[0], Take) and i[0].off is not None
        if not s or (first.bare and taken):
            return None
    return (("", i), (s or r[0][0], r[0][1]), *r[1:])


def _built(s: str, r: tuple[Joined, ...]) -> tuple[Joined, ...] | None:
    """ "let us build a tower: red on blue", but not "with red and blue": which on which?"""
    return None if s == "with" and any(map(_of_several, r[0][1])) else r


def _replaced(i: tuple[Item, ...], c: str, r: tuple[Joined, ...]) -> tuple[Joined, ...] | None:
    """What follows stands for what it was in front of: an "it" in it would not be clear."""
    if not i or not isinstance(i[0], Relate):
        return None
    if any(link.phrase == UPON and link.names and len(link.names.terms) > 1 for link in i[0].links):
        return None
    first = r[0][1]
    if len(first) != 1 or not isinstance(first[0], Relate | Row):
        return None
    if isinstance(first[0], Relate) and first[0].denied:
        return None
    if c in ("wait", "sorry") and not _overlap(i[0], first[0]):
        return None  # is it another wish?
    if isinstance(first[0], Relate) and first[0].subject is None:
        return ((r[0][0], (replace(first[0], subject=i[0].subject),)), *r[1:])
    return r


def _overlap(one: Relate, other: Item) -> bool:
    """Whether two are said of the same subject, or to the same object."""
    if not isinstance(other, Relate):
        return False
    if other.subject is None or one.subject is None:
        return True
    subjects = [{term.words.text for term in each.subject.terms} for each in (one, other)]  # type: ignore[union-attr]
    objects = [
        {term.words.text for link in each.links if link.names for term in link.names.terms}
        for each in (one, other)
    ]
    return bool(subjects[0] & subjects[1] or objects[0] & objects[1])


def _recounted(i: tuple[Item, ...], q: tuple[int, int | None]) -> tuple[Joined, ...] | None:
    """ "three blocks in stack 1, no, make it two"."""
    if len(i) != 1 or not isinstance(i[0], Relate) or i[0].subject is None:
        return None
    terms = i[0].subject.terms
    if len(terms) != 1 or terms[0].kind is not Kind.COUNT or terms[0].among:
        return None
    number = replace(terms[0], least=q[0], most=q[1])
    return (("", (replace(i[0], subject=replace(i[0].subject, terms=(number,))),)),)


def _not_that(i: tuple[Item, ...], b: Term, c: Term) -> tuple[Joined, ...] | None:
    """ "put green in stack 1, no, not the green one, the blue one"."""
    if len(i) != 1 or not isinstance(i[0], Relate) or i[0].subject is None:
        return None

    def corrected(names: Names) -> Names:
        terms = (c if key_of(term) == key_of(b) else term for term in names.terms)
        return replace(names, terms=tuple(terms))

    links = tuple(
        link if link.names is None else replace(link, names=corrected(link.names))
        for link in i[0].links
    )
    told = replace(i[0], subject=corrected(i[0].subject), links=links)
    return (("", (told,)),) if told != i[0] else None


def _rather_than(i: tuple[Item, ...]) -> tuple[Joined, ...] | None:
    if not i or not isinstance(i[0], Relate):
        return None
    return (("", i),)


def _turned_round(i: tuple[Item, ...], w: Word) -> tuple[Joined, ...] | None:
    """ "red on blue, no, the other way round": who was on whom is under him."""
    if len(i) != 1 or not isinstance(i[0], Relate) or len(i[0].links) != 1 or "other" not in w.text:
        return None
    (link,), subject = i[0].links, i[0].subject
    if link.phrase is None or link.names is None or link.how or subject is None or link.denied:
        return None
    terms = (*subject.terms, *link.names.terms)
    if len(terms) != 2 or any(term.kind is not Kind.THE or term.is_place for term in terms):
        return None
    turned = replace(i[0], subject=link.names, links=(replace(link, names=subject),))
    return (("", (turned,)),)


def _instead(i: tuple[Item, ...], j: tuple[Item, ...]) -> tuple[Joined, ...] | None:
    """ "red not on blue, put it on green instead"; of two wishes, is the first still one?"""
    return (("", i), (".", j)) if i and isinstance(i[0], Relate) and i[0].denied else None


def _or(i: tuple[Item, ...], r: tuple[Joined, ...]) -> tuple[Joined, ...]:
    return (("", i), ("or", r[0][1]), *r[1:])
