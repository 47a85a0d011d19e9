# SPDX-License-Identifier: Apache-2.0
"""Rules for towers and rows: several names in their order."""

from __future__ import annotations

from dataclasses import replace

from scene_graph import LEFT, UP

from ..terms import Term
from .lattice import Word
from .meaning import Row


def _in_order(b: Term, r: tuple[Term, ...] = (), c: Term | None = None) -> tuple[Term, ...]:
    return (b, *r) if c is None else (b, c)


def _row(d: tuple[str, bool], n: tuple[Term, ...], p: Term | None = None) -> Row | None:
    return row_of(d[0], n if d[1] else n[::-1], p)


def row_of(predicate: str, names: tuple[Term, ...], place: Term | None = None) -> Row | None:
    """A row of different blocks; a row from the left is in no place."""
    if len({term.words.text for term in names}) < len(names):
        return None
    if predicate == LEFT and place is not None:
        return None
    return Row(predicate, names, place)


# "red at the bottom, then blue, green on top"


def _bottom_of(b: Term, p: Term) -> tuple[Term, Term]:
    return b, p


def _row_from(
    a: tuple[Term, Term],
    levels: tuple[tuple[str, Term], ...] = (),
    b: tuple[str, Term] | None = None,
) -> Row | None:
    return _leveled((("bottom", a[0]), *(levels or (b,))), a[1])  # type: ignore[arg-type]


def _floor_number(o: Word | None = None, w: Word | None = None) -> str | None:
    """``bottom``, ``top``, or the number of the floor, from 0 for the ground."""
    if w is not None:
        lowest = w.text.split()[0]
        return (
            "0" if lowest == "ground" else "top" if "up" in w.text or "top" in w.text else "bottom"
        )
    assert o is not None
    return o.means if int(o.means) >= 0 else "top"


def _floor(o: str, b: Term) -> tuple[str, Term]:
    return o, b


def _levels(
    a: tuple[str, Term], r: tuple[tuple[str, Term], ...] = (), b: tuple[str, Term] | None = None
) -> tuple[tuple[str, Term], ...]:
    return (a, *r) if b is None else (a, b)


def _leveled(
    levels: tuple[tuple[str, Term], ...] = (), p: Term | None = None, n: tuple[Term, ...] = (),
    e: tuple[str, Term] | None = None, h: str | None = None
) -> Row | None:  # fmt: skip
    if e is not None:
        # In the order that was told, from the end that was named.
        if e[0] not in ("bottom", "top") or e[1].words.text not in (
            n[0].words.text,
            n[-1].words.text,
        ):
            return None
        first = n[0].words.text == e[1].words.text
        if len(n) > 2 and not first:
            return None
        upwards = first == (e[0] == "bottom")
        return row_of(UP, n if upwards else n[::-1], p)
    where = [how for how, _ in levels]
    if h is None and ("upon" in where or "first" in where):
        return None  # "red at the bottom, blue on it": of which tower?
    if "under" in where and where[0] != "top":
        return None
    same = {"upon": "then", "under": "then", "first": "bottom"}
    where = [same.get(how, how) for how in where]
    blocks = [block for _, block in levels]
    ordered = _ordered(where, blocks)
    if ordered is None:
        return None
    if n and len(n) == 3 and set(where) == {"top", "bottom"} and len(levels) == 2:
        middle = [one for one in n if one.words.text not in {two.words.text for two in ordered}]
        if len(middle) == 1:
            ordered = (ordered[0], middle[0], ordered[1])
    if n and {term.words.text for term in n} != {term.words.text for term in ordered}:
        return None
    row = row_of(UP, ordered, p)
    return row and replace(row, footed="bottom" in where)


def _formed(
    n: tuple[Term, ...], levels: tuple[tuple[str, Term], ...] = (),
    e: tuple[str, Term] | None = None, d: tuple[str, bool] | None = None,
) -> Row | None:  # fmt: skip
    """ "white, brown and purple form a tower with white at the bottom"."""
    return _row(d, n) if d is not None else _leveled(levels, n=n, e=e, h="tower")


def _sandwich(b: Term, c: Term, d: Term, e: tuple[str, Term]) -> Row | None:
    """ "red between blue and green, with blue on top"."""
    outer = (c, d) if e[1].words.text == c.words.text else (d, c)
    return _leveled(n=(outer[0], b, outer[1]), e=e, h="tower")


def _ordered(where: list[str], blocks: list[Term]) -> tuple[Term, ...] | None:
    """Blocks from the bottom, by where each is said to be."""
    if where.count("bottom") > 1 or where.count("top") > 1 or where.count("middle") > 1:
        return None
    floors = [int(how) for how in where if how.isdigit()]
    if floors and floors == list(range(floors[0], floors[0] + len(floors))):
        if floors[0] > 1 + (where[0] == "bottom"):
            return None  # what is below?
        where = ["then" if how.isdigit() else how for how in where]
        where[0] = "bottom"
    if "bottom" not in where and "top" not in where:
        return None
    if "middle" in where:
        if sorted(where) != ["bottom", "middle", "top"]:
            return None
        return tuple(blocks[where.index(how)] for how in ("bottom", "middle", "top"))
    if where[0] == "bottom" and where[-1] in ("top", "then") and set(where[1:-1]) <= {"then"}:
        return tuple(blocks)
    if where[0] == "top" and where[-1] in ("bottom", "then") and set(where[1:-1]) <= {"then"}:
        return tuple(reversed(blocks))
    return None
