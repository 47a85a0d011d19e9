# SPDX-License-Identifier: Apache-2.0
"""Rules for whole texts: wishes around clauses, several of them, corrections, what says nothing."""

from __future__ import annotations

from dataclasses import replace

from ..terms import Kind, Term
from .clausal import Verb, relate
from .lexicon import BAD
from .lattice import Word
from .meaning import Again, Change, Item, Mention, Names, Relate, Row, Take
from .nominal import UPON, rule, words_of

#: Ends of words that tell how something is, or was.
_TELLING = ("ed", "en", "ly", "less", "ing", "ful")

# Who wishes


@rule("WHO", "w:I", "w:PERSON")
def _who(w: Word | str) -> str:
    return "who"


@rule("OTHERWORD", "w:UNKNOWN", "w:PERSONNOUN", "w:SLIP")
def _other_word(w: Word) -> Word:
    return w


@rule("PERSON", "THE PERSONNOUN", "PERSONNOUN", "THE UNKNOWN PERSONNOUN", "A PERSONNOUN")
def _known_person() -> str:
    return "who"


@rule("PERSON", "THE? OTHERWORD", "THE? OTHERWORD OTHERWORD", "A OTHERWORD", "EVERY OTHERWORD", cost=1.0)
def _person() -> str:
    return "who"


# What stands in front of a wish


@rule("FRAME", "WHO WANT SEEING*", "WHO DO WANT SEEING*", "WHO MUST WANT SEEING*", "WHO MUST SEEING+", "WHO MUST MAKESURE SOTHAT?", "WHO MUST ASK YOU 'to'", "WHO ASK YOU 'to'", "MODAL WHO ASK YOU 'to'", "PUT IT COLON")
@rule("FRAME", "MODAL YOU", "MODAL YOU MIND", "MODAL YOU MAKESURE SOTHAT?", "MODAL YOU SEEING+", "MODAL YOU MIND MAKESURE SOTHAT?")
@rule("FRAME", "MIND", "MAKESURE COLON", "MAKESURE 'and'", "NUMBER HEADINGNOUNS COLON", "THANKSFOR", "MODAL WHO WANT SEEING*", "PUT 'it' LIKE A? OTHERWORD COLON", "THE ORDINAL TOWERNOUN? BE", "PUT? A? HEADINGNOUN 'of'", "THE GOAL")
@rule("FRAME", "MODAL WHO SEEING*", "YOU MUST", "YOU CAN", "YOU 'to'", "YOU MUST MAKESURE SOTHAT?")
@rule("FRAME", "MAKESURE SOTHAT?", "MAKESURE 'to'", "PUT MAKESURE SOTHAT")
@rule("FRAME", "'it' BE GOOD SEEING*", "'it' MUST BE GOOD SEEING*", "GOOD SOTHAT", "WHO BE GOOD SEEING*", "'it' MUST BE GOOD IFNICE YOU?", "'it' MUST BE GOOD IFNICE YOU CAN")
@rule("FRAME", "MODAL 'it' BE 'possible' SEEING*", "BE 'it' 'possible' SEEING*", "DO YOU THINK YOU MODAL", "DO YOU THINK 'it' MODAL BE 'possible' SEEING*")
@rule("FRAME", "THE? GOAL BE SEEING*", "THE? GOAL COLON", "THE? GOAL HAS", "WHO MUST BE GOOD IFNICE YOU? CAN?", "WHO BE GOOD IFNICE YOU? CAN?", "'it' MUST PLEASEME IFNICE YOU? CAN?", "THE? GOAL MUST SATISFY COLON?", "THE? GOAL GIVENS COLON", "THE? GOAL BE COLON", "THE? GOAL GIVENS BE SEEING*", "THE? GOAL WHO WANT BE COLON?")
@rule("FRAME", "WHO LOVEIT IFNICE YOU?", "WHO LOVEIT IFNICE YOU CAN", "WHO LOVEIT SEEING+", "WHO LOVEIT 'it' IFNICE YOU?")
@rule("FRAME", "WHO THINK SOTHAT?", "WHO THINK COMMA", "WHO THINK WHO CAN", "WHO THINK WHO WANT SEEING*", "WHO THINK WHO CAN SEEING+", "LETUS", "LETUS SEEING+", "LETUS MAKESURE SOTHAT?", "'how' 'about'", "'how' 'about' PUTTINGNOT")
@rule("FRAME", "WHATIWANT BE? COLON?", "WHATIWANT BE SEEING+", "WHATIWANT GIVENS? COLON", "WHO BE 'wondering' IFNICE YOU CAN", "WHO PAST 'wondering' IFNICE YOU MODAL", "WHO THINK IFNICE YOU MODAL")
@rule("FRAME", "MODAL YOU SHOWTHAT", "THE? STEP k:NUMBER COLON?", "k:NUMBER MARK", "STEP k:NUMBER COMMA", "ORDINALLY COMMA?", "PUT 'it' SOTHAT", "'try' 'to'", "PUT THE? PLURALS SOTHAT")
@rule("FRAME", "GIVENS COMMA?", "GIVENS COLON", "WHO WANT A? HEADINGNOUN 'where'", "WHO WANT A? HEADINGNOUN WHEREIN", "PUT A? HEADINGNOUN WHEREIN", "PUT A? HEADINGNOUN COLON", "A? HEADINGNOUN COLON", "PUT A? HEADINGNOUN 'with'", "WHO WANT A? HEADINGNOUN 'with'", "PUT NUMBER HEADINGNOUNS COLON", "WHO WANT A? HEADINGNOUN COLON")
def _frame(k: Word | None = None) -> bool:
    return False


@rule("FRAME", "WHO DO NOT WANT SEEING*", "WHO MUST NOT WANT SEEING*", "WHO NOT WANT SEEING*", "AVOID SOTHAT", "MAKESURE NOT 'to'?", "MAKESURE 'to' NOT",
      "WHO MUST WANT YOU 'to' NOT", "WHO WANT YOU NOT 'to'", "WHO WANT YOU 'to' NOT", "'it' BE NOT PERMITTED SEEING*", "'it' MUST NOT BE SEEING+", "DO NOT LETTING", "YOU MUST NOT", "YOU MAY NOT",
      "NOT LETTING", "'it' BE NOTTHECASE SOTHAT", "'it' MUST BE NOTTHECASE SOTHAT", "WHO DO NOT THINK SOTHAT", "WHO DO NOT 'like' SEEING+", "WHO MUST NOT 'like' SEEING*", "'without'", "'it' BE GOOD SOTHAT NOT", "'it' BE GOOD NOT 'to'", "DO NOT PUT 'it' SOTHAT", "NEVERMAY", "NOTTIME MUST", "NOTTIME CAN")  # fmt: skip
def _frame_denied() -> bool:
    return True


@rule("LETTING", "'let'", "'allow'", "'permit'")
def _letting() -> str:
    return "let"


@rule("NEVERMAY", "NOT MAY", "NOT MUST")
def _never_may() -> str:
    return "never"


@rule("SEEING", "w:TOSEE", "w:SOTHAT", "w:IFNICE", "'for'", "'to'", "w:PUTTINGNOT", "YOU 'to'", "'for' YOU 'to'", "'it'", "'you'", "'of' 'you'")
def _seeing(w: Word | None = None) -> str:
    return "see"


@rule("PUTTINGNOT", "'seeing'", "'having'", "'getting'")
def _putting_not() -> str:
    return "see"


@rule("HEADINGNOUN", "ADJ? w:TOWER", "ADJ? w:GOAL", "ADJ? w:ROWNOUN")
def _heading_noun(w: Word) -> Word:
    return w


@rule("HEADINGNOUNS", "ADJ? w:PLACENOUNS")
def _heading_nouns(w: Word) -> Word:
    return w


@rule("WHEREIN", "'where'", "'in' WHICH", "'so' 'that'", "WHICH HAS", "SOTHAT")
def _wherein() -> str:
    return "where"


@rule("GIVENS", "GIVENFOR THE? FILLABLE* OTHERWORD+", "GIVENFOR DISCUSSED", "GIVENFOR THE? FILLABLE* OTHERWORD* STEP NUMBER?", cost=0.8)
def _givens() -> str:
    return "given"


@rule("FILLABLE", "'next'", "'last'", "'first'", "'final'")
def _fillable() -> str:
    return ""


@rule("ORDINALLY", "w:ORDINAL", "w:FIRST")
def _ordinally(w: Word) -> Word:
    return w


@rule("PLURALS", "w:NOUNS", "w:SHAPES")
def _plurals(w: Word) -> Word:
    return w


@rule("FRAMED", "f:FRAME c:FRAMED")
def _more_frames(f: bool, c: Item | tuple[Item, ...]) -> Item | tuple[Item, ...] | None:
    return _under(f, c)


def _under(denied: bool, item: Item) -> Item | None:
    if not denied:
        return item
    if not isinstance(item, Relate) or item.denied or item.subject is None:
        return None
    subject = item.subject
    if subject.denied or any(term.only or term.kind is Kind.NO for term in subject.terms):
        return None
    return relate(subject, item.links, Verb(denied=True))


@rule("FRAMED", "f:FRAME c:CLAUSE", "f:FRAME c:WISHED", "f:FRAME c:ROW")
def _framed(f: bool, c: Item) -> Item | None:
    return _under(f, c)


@rule("FRAMED", "c:CLAUSE", "c:ROW", "c:CHANGE")
def _clause(c: Item) -> Item:
    return c


@rule("FRAMED", "MODAL c:WISHED")
def _question(c: Item) -> Item:
    return c


@rule("FRAMED", "c:FRAMED2 COMMA? SUFFIX")
def _with_suffix(c: Item) -> Item:
    return c


@rule("FRAMED2", "f:FRAME c:CLAUSE", "f:FRAME c:WISHED", "c:CLAUSE", "c:WISHED", "f:FRAME c:ROW", "c:ROW", "IFNICE YOU? CAN? c:CLAUSE", "IFNICE YOU MODAL c:CLAUSE", "IFNICE c:WISHED")
def _to_suffix(c: Item, f: bool = False) -> Item | None:
    return _under(f, c)


@rule("SUFFIX", "MUST BE GOOD", "'that' MUST BE GOOD", "'it' MUST BE GOOD", "BE WHATIWANT", "AND WHO MUST BE GOOD", "COMMA AND WHO MUST BE GOOD", "'that' BE WHATIWANT", "AND WHO MUST BE OTHERWORD", "BE THE? GOAL", "'that' BE THE? GOAL", "WHO LOVEIT", "WHO MUST BE GOOD", "ANYORDER", "WHO WANT", "WHO THINK", "'that' MUST BE OTHERWORD", "BE MUST", "'if' 'it' BE GOOD", "'that' BE GOOD")
def _suffix() -> str:
    return ""


# What says nothing


@rule("IDLE", "FILLEDOUT", "OTHERS DONTCARE", "w:ANYORDER", "'i' DONTCARE OTHERS", "DONTCARE OTHERS", "KEEP BLOCK DONTCARE", "SUFFIX", "KEEPING", "SPREADOUT")
def _idle(w: Word | None = None) -> str:
    return "idle"


@rule("FILLEDOUT", "GIVENS")
def _filled() -> str:
    return ""


@rule("LETSBUILD", "LETUS PUT A? HEADINGNOUN", "PUT A? HEADINGNOUN", "WHO WANT A? HEADINGNOUN", "PUT NUMBER HEADINGNOUNS", "WHO WANT NUMBER HEADINGNOUNS", "NUMBER HEADINGNOUNS")
def _lets_build() -> str:
    return ""


@rule("OTHERS", "THE? OTHER NOUNS?", "EVERYTHING ELSE", "WHERE THE? OTHER NOUNS? BE", "EVERY? THE? OTHER NOUNS?")
def _others() -> str:
    return ""


@rule("KEEPING", "KEEP OTHERS ASIS?", "OTHERS MUST? BE ASIS", "OTHERS ASIS", "KEEP OTHERS 'out'")
def _keeping_others() -> str:
    """The planner moves no more than it has to."""
    return ""


@rule("AGAINSAID", "'so' MUST n:LISTED", "AND n:LISTED LIKEWISE", "SAMEFOR n:LISTED", "n:LISTED LIKEWISE")
def _again(n: Names) -> Again | None:
    return None if n.either or n.denied else Again(n)


@rule("AGAINSAID", "'nor' MUST n:LISTED", "'neither' MUST n:LISTED", "'nor' MAY n:LISTED", "'neither' MAY n:LISTED", "'nor' DO n:LISTED")
def _again_denied(n: Names) -> Again | None:
    return None if n.either or n.denied else Again(n, denied=True)


@rule("SPREADOUT", "PUT? THE BLOCKSOUT")
def _spread_out() -> str:
    return ""


# Changes of what is there now


@rule("CHANGE", "w:SWAP n:LISTED", "w:SWAP n:LISTED 'around'", "n:LISTED MUST? w:SWAPPED", "n:LISTED BE w:SWAPPED", "w:SWAP m:TERM 'with' o:TERM", "w:SWAP m:TERM 'for' o:TERM", "PUT n:LISTED w:SWAPPED", "PUT m:TERM SWAPPEDWITH w:SWAPPED 'with' o:TERM", "m:TERM MUST? w:SWAPPED 'with' o:TERM")
def _swap(w: Word, n: Names | None = None, m: object = None, o: object = None) -> Change | None:
    names = n or Names((m, o))  # type: ignore[arg-type]
    if names.either or names.denied:
        return None
    return Change("swap", words_of(w), names)


@rule("CHANGE", "w:KEEP n:LISTED ASIS", "n:LISTED MUST? BE ASIS", "w:DONTTOUCH n:LISTED", "n:LISTED w:ASIS")
def _keep(n: Names, w: Word | None = None) -> Change | None:
    if n.either or n.denied or any(term.others for term in n.terms):
        return None
    return Change("keep", n.terms[0].words if w is None else words_of(w), n)


@rule("CHANGE", "w:TURN n:LISTED UPSIDEDOWN", "'reverse' THE? ROWNOUN 'of' w:HEADINGWORD n:LISTED", "w:REVERSE n:LISTED", "w:REVERSE THE ROWNOUN 'of' THE? HEAD? 'in' n:LISTED", "w:REVERSE THE ROWNOUN OFOF n:LISTED")
def _turn(n: Names, w: Word) -> Change | None:
    if n.either or n.denied or len(n.terms) > 1:
        return None
    return Change("turn", words_of(w), n)


@rule("CHANGE", "w:TURN THE w2:TOWER UPSIDEDOWN", "w:REVERSE THE w2:TOWER")
def _turn_tower(w: Word, w2: Word) -> Change:
    return Change("turn", words_of(w))


@rule("CHANGE", "w:SAMENOW", "KEEP w:SAMENOW", "KEEP EVERYTHING w:ASIS", "PUT w:SAMENOW", "EVERYTHING MUST? BE w:ASIS")
def _same(w: Word) -> Change:
    return Change("same", words_of(w))


@rule("CHANGE", "PUT n:LISTED k:STEPS w:TOSIDEWORD", "PUT n:LISTED w:TOSIDEWORD 'by' k:STEPS")
def _shift(n: Names, k: int, w: Word) -> Change | None:
    if n.either or n.denied:
        return None
    return Change("shift", words_of(w), n, k if w.text == "right" else -k)


@rule("STEPS", "k:NUMBER PLACENOUN", "k:NUMBER PLACENOUNS", "k:NUMBER STEP", "w:A PLACENOUN")
def _steps(k: Word | None = None, w: Word | None = None) -> int | None:
    if w is not None and w.text not in ("a", "one"):
        return None
    return int(k.means) if k else 1


@rule("TOSIDEWORD", "'to' THE w:SIDE", "w:SIDE", "'further' w:SIDE", "'over' 'to' THE w:SIDE")
def _to_side_word(w: Word) -> Word | None:
    return w if w.text in ("left", "right") else None


# Several of them


@rule("ITEM", "c:FRAMED", "c:AGAINSAID", "PREAMBLE COMMA? c:FRAMED")
def _item(c: Item) -> tuple[Item, ...]:
    return (c,)


@rule("ITEM", "INSTEADOF LINK COMMA? c:FRAMED", "'not' LINK COMMA 'but' c:FRAMED", cost=0.3)
def _instead(c: Item) -> tuple[Item, ...]:
    return (c,)


@rule("ITEM", "INPLACE b:PLACE COLON", cost=0.5)
@rule("ITEM", "b:BLOCK FIRST", "b:BLOCK COMMA", "FIRST b:BLOCK", "b:BLOCK", "b:BLOCK 'comes' FIRST", cost=1.0)
def _mention(b: Term) -> tuple[Item, ...]:
    return (Mention(b),)


@rule("ITEM", "IDLE")
def _idle_item() -> tuple[Item, ...]:
    return ()


@rule("PREAMBLE", "IDLE COMMA", cost=0.3)
def _preamble() -> str:
    return ""


@rule("SEP", "COMMA? BUT", "MARK BUT", "BUT AND")
def _but_sep() -> str:
    return "but"


@rule("SEP", "MARK", "MARK AND COMMA?", "MARK MARK", "MARK COMMA", "COMMA MARK")
def _mark_sep() -> str:
    return "."


@rule("SEP", "COMMA", "COMMA? AND COMMA?", "COMMA COMMA", "COMMA? AND SOTHAT", "COMMA SOTHAT", "COMMA 'where'")
@rule("SEP", "SOTHAT", cost=0.3)
def _comma_sep() -> str:
    return ","


@rule("SEP", "COMMA? 'with'")
def _with_sep() -> str:
    return "with"


#: An item, and how it is joined to what stands in front of it.
Joined = tuple[str, tuple[Item, ...]]


@rule("ENDMARK", "w:MARK", "w:COMMA")
def _end_mark(w: Word) -> Word:
    return w


@rule("ITEMS", "i:ITEM", "i:ITEM ENDMARK+")
def _last(i: tuple[Item, ...]) -> tuple[Joined, ...]:
    return (("", i),)


@rule("ASIDEWORD", "w:UNKNOWN", "w:PERSONNOUN", "w:STEP", "w:GOAL", "w:NOUNS")
def _aside_word(w: Word) -> Word | None:
    """What names something else, not what says that it is, or is not, so."""
    return None if w.text in BAD or w.text.endswith(_TELLING) else w


@rule("ASIDE", "THE? ASIDEWORD", "A? ASIDEWORD ASIDEWORD?", "NUMBER ASIDEWORD", "THE? ASIDEWORD OFOF THE? ASIDEWORD", "ASIDEWORD AND ASIDEWORD")
def _aside() -> str:
    return ""


@rule("ITEMS", "ASIDE REALCOLON r:ITEMS", "ASIDE REALCOLON COMMA r:ITEMS", cost=1.0)
@rule("ITEMS", "PERSONNOUN COMMA r:ITEMS", cost=0.5)
@rule("ITEMS", "i:ITEM SEP ASIDE ENDMARK*", cost=1.5)
def _beside_aside(
    r: tuple[Joined, ...] = (), i: tuple[Item, ...] = ()
) -> tuple[Joined, ...]:
    return r or (("", i),)


@rule("ITEMS", "LETSBUILD s:SEP r:ITEMS")
def _heading_first(s: str, r: tuple[Joined, ...]) -> tuple[Joined, ...]:
    return r


@rule("ITEMS", "i:ITEM s:SEP r:ITEMS")
@rule("ITEMS", "i:ITEM r:ITEMS", cost=1.5)
def _more(i: tuple[Item, ...], r: tuple[Joined, ...], s: str = "") -> tuple[Joined, ...] | None:
    first = r[0][1][0] if r[0][1] else None
    if isinstance(first, Relate) and first.subject is None and i:
        if not s or (first.bare and isinstance(i[0], Take) and i[0].off is not None):
            return None
    return (("", i), (s or r[0][0], r[0][1]), *r[1:])


@rule("ITEMS", "i:ITEM MARK? c:CORRECTED MARK? r:ITEMS", cost=0.2)
def _replaced(
    i: tuple[Item, ...], c: str, r: tuple[Joined, ...]
) -> tuple[Joined, ...] | None:
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


@rule("ITEMS", "i:ITEM COMMA? INSTEADOF c:CLAUSE ENDMARK*", cost=0.2)
def _rather_than(i: tuple[Item, ...], c: Item) -> tuple[Joined, ...] | None:
    if not i or not isinstance(i[0], Relate):
        return None
    return (("", i),)


@rule("ITEMS", "i:ITEM COMMA? OR r:ITEMS")
def _or(i: tuple[Item, ...], r: tuple[Joined, ...]) -> tuple[Joined, ...]:
    return (("", i), ("or", r[0][1]), *r[1:])


@rule("TEXT", "START ENDMARK* AND? r:ITEMS", "START ENDMARK* 'sorry' COMMA? r:ITEMS", "START ENDMARK* 'oops' COMMA? r:ITEMS", "START ENDMARK* 'wait' COMMA? 'no'? COMMA? r:ITEMS")
def _text(r: tuple[Joined, ...]) -> tuple[Joined, ...]:
    return r

