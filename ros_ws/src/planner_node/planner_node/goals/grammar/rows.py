# SPDX-License-Identifier: Apache-2.0
"""Rules for towers and rows: several names in their order."""

from __future__ import annotations

from dataclasses import replace

from scene_graph import LEFT, UP

from ..terms import Term
from .lattice import Word
from .meaning import Row
from .nominal import rule


@rule("ORDER", "w:UPWARDS")
def _upwards(w: Word) -> tuple[str, bool]:
    return UP, True


@rule("ORDER", "w:DOWNWARDS")
def _downwards(w: Word) -> tuple[str, bool]:
    return UP, False


@rule("ORDER", "w:RIGHTWARDS")
def _rightwards(w: Word) -> tuple[str, bool]:
    return LEFT, True


@rule("ORDER", "w:LEFTWARDS")
def _leftwards(w: Word) -> tuple[str, bool]:
    return LEFT, False


@rule("INORDER", "b:BLOCK s:ORDERSEP r:INORDER", "b:BLOCK s:ORDERSEP c:BLOCK")
def _in_order(
    b: Term, s: str, r: tuple[Term, ...] = (), c: Term | None = None
) -> tuple[Term, ...]:
    return (b, *r) if c is None else (b, c)


@rule("INORDER", "b:BLOCK r:INORDER", "b:BLOCK c:BLOCK", cost=1.0)
def _unseparated(b: Term, r: tuple[Term, ...] = (), c: Term | None = None) -> tuple[Term, ...]:
    return (b, *r) if c is None else (b, c)


@rule("ORDERSEP", "COMMA AND?", "AND", "MARK", "COMMA COMES", "COMMA? AND? COMES")
def _order_sep() -> str:
    return ","


@rule("HEADING", "PUT? A? NUMBER? TOWERNOUN HEADINGMORE?", "PUT? THE TOWERNOUN HEADINGMORE?", "PUT? THE ROWNOUN HEADINGMORE?", "THE ROWNOUN 'of' THE TOWERNOUN HEADINGMORE?", "ROWNOUN PAUSE?", "PUT I A? TOWERNOUN HEADINGMORE?", "WHO WANT A? TOWERNOUN HEADINGMORE?", "PUT? A? ROWNOUN HEADINGMORE?", "PUT")
def _heading() -> str:
    return "heading"


@rule("HEADINGMORE", "BE", "MUST BE", "'of'", "BE 'of'", "'with'", "WHICH BE", "LIKE")
def _heading_more() -> str:
    return "more"


@rule("TOWERNOUN", "w:TOWER", "ADJ w:TOWER")
def _tower(w: Word) -> Word:
    return w


@rule("INPLACEOF", "INPLACE p:PLACE", "COMMA INPLACE p:PLACE", "PUT? p:PLACE", "'of' p:PLACE", "BOTTOMOF p:PLACE")
def _in_place(p: Term) -> Term:
    return p


@rule("ROW", "d:ORDER PAUSE? n:INORDER", "d:ORDER p:INPLACEOF PAUSE? n:INORDER", "p:INPLACEOF PAUSE? d:ORDER PAUSE? n:INORDER",
      "HEADING PAUSE? d:ORDER PAUSE? n:INORDER", "HEADING p:INPLACEOF PAUSE? d:ORDER PAUSE? n:INORDER",
      "HEADING PAUSE? d:ORDER p:INPLACEOF PAUSE? n:INORDER", "p:INPLACEOF PAUSE? HEADING d:ORDER PAUSE? n:INORDER",
      "d:ORDER PAUSE? HEADING n:INORDER", "d:ORDER WANTED n:INORDER", "d:ORDER p:INPLACEOF PAUSE? WANTED n:INORDER", "p:INPLACEOF PAUSE? WANTED d:ORDER PAUSE? n:INORDER",
      "n:INORDER PAUSE? d:ORDER", "HEADING n:INORDER PAUSE? d:ORDER", "HEADING PAUSE n:INORDER PAUSE? d:ORDER",
      "HEADING p:INPLACEOF PAUSE? n:INORDER PAUSE? d:ORDER", "p:INPLACEOF PAUSE? n:INORDER PAUSE? d:ORDER",
      "n:INORDER p:INPLACEOF PAUSE? d:ORDER", "HEADING n:INORDER p:INPLACEOF PAUSE? d:ORDER",
      "HEADING n:INORDER PAUSE? d:ORDER p:INPLACEOF", "n:INORDER PAUSE? d:ORDER p:INPLACEOF",
      "PUT n:INORDER PAUSE? d:ORDER", "p:INPLACEOF BE PAUSE? d:ORDER PAUSE? n:INORDER",
      "p:INPLACEOF MUST BE PAUSE? d:ORDER PAUSE? n:INORDER", "d:ORDER p:INPLACEOF MUST BE n:INORDER",
      "d:ORDER COMMA p:INPLACEOF MUST BE n:INORDER", "p:INPLACEOF MUST HAS COMMA? d:ORDER COMMA? n:INORDER",
      "n:INORDER MUST BE d:ORDER", "THE ROWNOUN p:INPLACEOF d:ORDER MUST BE n:INORDER", "THE ROWNOUN d:ORDER MUST? BE n:INORDER", "HEADING COMMA? d:ORDER COMMA? HEADINGMORE n:INORDER")  # fmt: skip
def _row(
    d: tuple[str, bool], n: tuple[Term, ...], p: Term | None = None
) -> Row | None:
    return row_of(d[0], n if d[1] else n[::-1], p)


@rule("PAUSE", "COMMA", "COLON", "MARK", "COMMA COLON")
def _pause() -> str:
    return ":"


@rule("WANTED", "I WANT", "I WANT TOSEE", "PUT")
def _wanted() -> str:
    return "i want"


def row_of(predicate: str, names: tuple[Term, ...], place: Term | None = None) -> Row | None:
    """A row of different blocks; a row from the left is in no place."""
    if len({term.words.text for term in names}) < len(names):
        return None
    if predicate == LEFT and place is not None:
        return None
    return Row(predicate, names, place)


# "red at the bottom, then blue, green on top"


@rule("LEVEL", "b:BLOCK v:LEVELVERB? w:ATBOTTOM", "w:ATBOTTOM COMMA? v:LEVELVERB? b:BLOCK", "w:ATBOTTOM COMMA? I WANT b:BLOCK", "PUT? b:BLOCK w:ATBOTTOM", "w:ATBOTTOM PUT b:BLOCK",
      "b:BLOCK v:LEVELVERB? 'the' w:LOWEST", "THE w:LOWEST ONE? v:LEVELVERB b:BLOCK", "PUT b:BLOCK w:FIRST")  # fmt: skip
def _bottom(b: Term, w: Word, v: str | None = None) -> tuple[str, Term]:
    return "bottom", b


@rule("LEVELAT", "b:BLOCK LEVELVERB? BOTTOMOF p:PLACE", "PUT b:BLOCK BOTTOMOF p:PLACE", "BOTTOMOF p:PLACE COMMA? LEVELVERB? b:BLOCK", "b:BLOCK INPLACE p:PLACE ATBOTTOM", "b:BLOCK ATBOTTOM INPLACE p:PLACE")
def _bottom_of(b: Term, p: Term) -> tuple[Term, Term]:
    return b, p


@rule("ROW", "a:LEVELAT LEVELSEP l:LEVELS", "a:LEVELAT LEVELSEP b:LEVEL")
def _row_from(
    a: tuple[Term, Term], l: tuple[tuple[str, Term], ...] = (), b: tuple[str, Term] | None = None
) -> Row | None:
    return _leveled((("bottom", a[0]), *(l or (b,))), a[1])  # type: ignore[arg-type]


@rule("LEVEL", "b:BLOCK v:LEVELVERB? w:ATTOP", "w:ATTOP COMMA? v:LEVELVERB? b:BLOCK", "w:ATTOP COMMA? I WANT b:BLOCK", "PUT? b:BLOCK w:ATTOP", "w:ATTOP PUT b:BLOCK",
      "b:BLOCK v:LEVELVERB? 'the' w:TOPMOST", "THE w:TOPMOST ONE? v:LEVELVERB b:BLOCK")  # fmt: skip
def _top(b: Term, w: Word, v: str | None = None) -> tuple[str, Term]:
    return "top", b


@rule("LEVEL", "b:BLOCK v:LEVELVERB? w:INMIDDLE", "w:INMIDDLE COMMA? v:LEVELVERB? b:BLOCK", "w:INMIDDLE COMMA? I WANT b:BLOCK", "PUT? b:BLOCK w:INMIDDLE")
def _middle(b: Term, w: Word, v: str | None = None) -> tuple[str, Term]:
    return "middle", b


@rule("LEVELVERB", "BE", "MUST BE", "BE 'the'", "'as'")
def _level_verb() -> str:
    return "be"


@rule("LEVEL", "COMES? b:BLOCK", "b:BLOCK BE? NEXTUP", "NEXTUP BE? b:BLOCK", "b:BLOCK ABOVETHAT", "ABOVETHAT COMES? b:BLOCK", cost=0.4)
def _then(b: Term) -> tuple[str, Term]:
    return "then", b


@rule("LEVEL", "STARTWITH b:BLOCK ATBOTTOM")
def _started(b: Term) -> tuple[str, Term]:
    return "bottom", b


@rule("LEVEL", "FINISHWITH b:BLOCK ATTOP?")
def _finished(b: Term) -> tuple[str, Term]:
    return "top", b


@rule("LEVEL", "ADD b:BLOCK ABOVETHAT", "ADD b:BLOCK NEXTUP")
def _added(b: Term) -> tuple[str, Term]:
    return "then", b


@rule("LEVEL", "b:BLOCK BE? ONIT", "ONIT COMES? b:BLOCK", cost=0.4)
def _upon(b: Term) -> tuple[str, Term]:
    return "upon", b


@rule("COMES", "BE", "'comes'", "MUST BE", "PUT")
def _comes() -> str:
    return "comes"


@rule("LEVELS", "a:LEVEL LEVELSEP r:LEVELS", "a:LEVEL LEVELSEP b:LEVEL")
def _levels(
    a: tuple[str, Term], r: tuple[tuple[str, Term], ...] = (), b: tuple[str, Term] | None = None
) -> tuple[tuple[str, Term], ...]:
    return (a, *r) if b is None else (a, b)


@rule("LEVELSEP", "COMMA AND?", "AND", "MARK AND?", "COMMA? 'with'", "COMMA BUT")
def _level_sep() -> str:
    return ","


@rule("ROW", "l:LEVELS", "h:HEADING PAUSE? l:LEVELS", "h:HEADING p:INPLACEOF PAUSE? l:LEVELS", "h:HEADING p:INPLACEOF COMMA? 'with' l:LEVELS", "p:INPLACEOF PAUSE? l:LEVELS",
      "p:INPLACEOF COMMA? h:HEADING PAUSE? l:LEVELS", "l:LEVELS COMMA? p:INPLACEOF", "p:INPLACEOF MUST? HAS l:LEVELS",
      "h:HEADING COMMA? 'with' l:LEVELS")  # fmt: skip
@rule("ROW", "h:HEADING n:INORDER COMMA? 'with' l:LEVELS", "h:HEADING n:INORDER COMMA? l:LEVELS", "h:HEADING p:INPLACEOF PAUSE? n:INORDER COMMA? 'with' l:LEVELS")
@rule("ROW", "'with' l:LEVELS COMMA? h:HEADING n:INORDER", "'with' e:LEVEL COMMA? h:HEADING n:INORDER", "h:HEADING n:INORDER COMMA? 'with' e:LEVEL",
      "h:HEADING n:INORDER COMMA? e:LEVEL",
      "h:HEADING p:INPLACEOF PAUSE? n:INORDER COMMA? 'with' e:LEVEL", "h:HEADING n:INORDER p:INPLACEOF COMMA? 'with' e:LEVEL")  # fmt: skip
def _leveled(
    l: tuple[tuple[str, Term], ...] = (), p: Term | None = None, n: tuple[Term, ...] = (),
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
    where = [how for how, _ in l]
    if "upon" in where and h is None:
        return None  # "red at the bottom, blue on it": of which tower?
    where = ["then" if how == "upon" else how for how in where]
    blocks = [block for _, block in l]
    ordered = _ordered(where, blocks)
    if ordered is None:
        return None
    if n and len(n) == 3 and set(where) == {"top", "bottom"} and len(l) == 2:
        middle = [one for one in n if one.words.text not in {two.words.text for two in ordered}]
        if len(middle) == 1:
            ordered = (ordered[0], middle[0], ordered[1])
    if n and {term.words.text for term in n} != {term.words.text for term in ordered}:
        return None
    row = row_of(UP, ordered, p)
    return row and replace(row, footed="bottom" in where)


def _ordered(where: list[str], blocks: list[Term]) -> tuple[Term, ...] | None:
    """Blocks from the bottom, by where each is said to be."""
    if where.count("bottom") > 1 or where.count("top") > 1 or where.count("middle") > 1:
        return None
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

