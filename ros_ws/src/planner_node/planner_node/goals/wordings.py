# SPDX-License-Identifier: Apache-2.0
"""Several words of a goal that stand for others: "out of" is read as "not in"."""

from __future__ import annotations

from collections.abc import Iterable
from itertools import permutations
from typing import Final

from .language import BYGONE, CORRECTION, INSTEAD, NUMBERS, TAKEN_BACK

Wordings = dict[tuple[str, ...], tuple[str, ...]]


def _all_as(meaning: tuple[str, ...], texts: Iterable[str]) -> Wordings:
    """Each of some texts with the same meaning."""
    return {tuple(text.split()): meaning for text in texts}


#: "in the stack directly to the left of".
_SIDE_BY_SIDE: Final = {
    (*stack, how, *to, side, "of"): (f"just-{side}-of",)
    for stack in ((), ("in", "stack"), ("in", "place"), ("in", "tower"))
    for how in ("directly", "immediately", "just", "right")
    for to in ((), ("to",))
    for side in ("left", "right")
    if (how, *to) != ("right",)
}
#: A number of blocks, or what is left out of them.
_NUMBERS: Final[Wordings] = {
    ("no", "more", "then"): ("at-most",),
    ("no", "more", "than"): ("at-most",),
    ("not", "more", "than"): ("at-most",),
    ("not", "more", "then"): ("at-most",),
    ("not", "more", "as"): ("at-most",),
    ("at", "most"): ("at-most",),
    ("atmost",): ("at-most",),
    ("max",): ("at-most",),
    ("maximum",): ("at-most",),
    ("maximum", "of"): ("at-most",),
    ("at", "max"): ("at-most",),
    ("more", "than"): ("more-than",),
    ("more", "then"): ("more-than",),
    ("fewer", "than"): ("fewer-than",),
    ("less", "than"): ("fewer-than",),
    ("less", "then"): ("fewer-than",),
    ("no", "fewer", "than"): ("at-least",),
    ("no", "less", "than"): ("at-least",),
    ("not", "less", "than"): ("at-least",),
    ("at", "least"): ("at-least",),
    ("at", "lest"): ("at-least",),
    ("atleast",): ("at-least",),
    ("min",): ("at-least",),
    ("minimum",): ("at-least",),
    ("precisely",): ("exactly",),
    ("per", "stack"): ("in", "every", "stack"),
    ("per", "place"): ("in", "every", "stack"),
    ("not", "a", "single"): ("no",),
    ("not", "one", "single"): ("no",),
    ("no", "single"): ("no",),
    ("no", "one"): ("nothing",),
    ("nobody",): ("nothing",),
    ("neither", "of"): ("no",),
    ("except", "for"): ("except",),
    ("other", "than"): ("except",),
    ("besides",): ("except",),
    ("no", "more", "blocks"): ("no", "blocks"),
    ("no", "more", "block"): ("no", "block"),
    ("all", "by", "itself"): ("alone",),
    ("all", "by", "themselves"): ("alone",),
    ("all", "alone"): ("alone",),
    ("apart", "from"): ("except",),
    ("that", "are", "not"): ("except", "all"),
    ("that", "is", "not"): ("except",),
    ("which", "are", "not"): ("except", "all"),
    ("somewhere", "else"): ("elsewhere",),
    ("anywhere", "else"): ("elsewhere",),
    ("immediately", "on"): ("directly", "on"),
    ("nothing", "but"): ("only",),
    ("nothing", "except"): ("only",),
    ("nothing", "other", "than"): ("only",),
    ("by", "itself"): ("alone",),
    ("by", "themselves"): ("alone",),
    ("on", "its", "own"): ("alone",),
    ("both", "of", "them"): ("both",),
    ("them", "both"): ("both",),
    ("them", "all"): ("all",),
    ("all", "of", "them"): ("all",),
    ("all", "two"): ("both",),
    ("all", "two", "of", "them"): ("both",),
    **{("all", number, "of", "them"): ("all", number) for number in NUMBERS},
    ("either", "of", "them"): ("either-of-them",),
    ("side", "by", "side"): ("next", "to", "each-other"),
    ("each", "other"): ("each-other",),
    ("one", "another"): ("each-other",),
}
#: Nothing: whatever they are said of, the goal is the same.
_NOTHING: Final = _all_as(
    (),
    (
        "i do not care which of all two", "i do not care which ones", "i do not care which one",
        "i do not care which", "not necessarily directly", "it does not matter which",
        "no matter which ones", "no matter which", "no matter where", "in whatever order",
        "in any order", "order does not matter", "aswell", "as well", "let me think",
        "let me see", "let us see", "thanks a lot", "thank you", "thank you for", "thanks for",
        "thank you very much", "would you please", "would you mind", "at end", "in end", "at all",
        "whatsoever", "after that", "can you", "can i", "can we", "can u", "could u", "of course",
        "for me", "ends up", "end up", "ended up", "so kind and", "in a way that",
        "final arrangement", "final state", "goal state", "end state", "that is it",
        "that is all", "thats it", "thats all", "how about", "what about", "is it possible",
        "would it be possible", "what i want is", "what i need is", "at last", "at first",
        "at all times", "be a dear and", "be an angel and", "many thanks", "pardon me",
        "excuse me", "if i may", "with your permission", "what i would like is", "for now",
        "right now", "for today", "if possible", "before next run", "before next trial",
        "for next run", "for next trial", "neither more nor less", "no more and no less",
        "no more no less", "sorry for trouble", "sorry for bother", "sorry to bother you",
        "would you be so kind and", "first of all", "second of all", "order irrelevant",
        "order is irrelevant", "order is not important", "order not important",
        "order unimportant", "while you is at it", "while we is at it", "while you are at it",
        "while at it", "this time", "here is what i want", "here is what i need",
        "if you do not mind",
    ),
)  # fmt: skip
#: People who correct themselves.
_CORRECTIONS: Final = _all_as(
    (CORRECTION,),
    (
        "no wait", "wait no", "wait", "no sorry", "sorry no", "sorry", "i mean", "i meant",
        "or rather", "no actually", "actually no", "actually", "make that", "oops",
        "correction", "no i mean", "no i meant", "sorry i mean", "sorry i meant", "oh wait",
        "oh no", "oops no", "no wait a moment", "rather", "no no", "hang on", "hold on",
        "wait a minute", "nope",
    ),
) | _all_as(
    (TAKEN_BACK,),
    (
        f"{verb} {what}"
        for verb in ("scratch", "forget", "cancel", "strike", "ignore")
        for what in ("that", "it", "this", "last one")
    ),
)  # fmt: skip
_REST: Final = frozenset({"rest", "others", "remainder", "remaining blocks", "other blocks",
"remaining ones",
                          "other ones", "everything else", "all others"})  # fmt: skip
#: What is not asked for.
_UNASKED: Final = _all_as(
    (),
    (
        text.replace("REST", rest)
        for rest in sorted(_REST)
        for text in (
            "leave REST", "leave REST alone", "leave REST be", "leave REST as it is",
            "leave REST as they are", "leave REST where it is", "leave REST where they are",
            "i do not care about REST", "i do not care where REST goes",
            "i do not care where REST go", "do not care about REST", "REST does not matter",
            "REST do not matter", "REST anywhere", "REST can go anywhere", "REST wherever",
            "do not touch REST", "never mind REST", "do not worry about REST", "ignore REST",
            "where REST go is up to you", "where REST goes is up to you", "REST is up to you",
            "REST are up to you", "REST wherever you like", "REST wherever you want",
            "REST as you like", "REST as you wish", "put REST wherever you like",
            "put REST wherever you want", "put REST anywhere", "do whatever you like with REST",
            "do whatever you want with REST", "do what you like with REST",
            "do what you want with REST",
        )
    ),
)  # fmt: skip
#: Nothing behind what they are said of; in front they make a condition of what follows.
PROVISOS: Final = frozenset({("as", "long", "as"), ("provided", "that")})
#: Several words that stand for others, the longest first; looked for everywhere.
MERGED: Final[Wordings] = {
    **_SIDE_BY_SIDE, **_NUMBERS, **_NOTHING, **_UNASKED, **_CORRECTIONS,
    ("right", "at", "bottom"): ("at", "bottom"),
    ("right", "at", "top"): ("at", "top"),
    ("at", "top", "of"): ("at-top-of",),
    ("at", "very", "top", "of"): ("at-top-of",),
    ("on", "very", "top", "of"): ("at-top-of",),
    ("ontop",): ("on", "top"),
    ("on", "top", "off"): ("on", "top", "of"),
    ("left", "off"): ("left", "of"),
    ("right", "off"): ("right", "of"),
    ("out", "of"): ("not", "in"),
    ("not", "allowed"): ("not",),
    ("not", "supposed"): ("not",),
    ("pick", "up"): ("take",),
    ("lift", "up"): ("take",),
    ("free", "up"): ("clear",),
    ("clear", "off"): ("clear",),
    ("clear", "out"): ("clear",),
    ("can", "be"): ("be",),
    ("has", "to"): ("must",),
    ("have", "to"): ("must",),
    ("lets",): ("let",),
    ("avoid",): ("do", "not"),
    ("rather", "not"): ("not",),
    ("everybody",): ("everything",),
    ("for", "you", "to"): (),
    ("instead", "of"): (INSTEAD,),
    ("rather", "than"): (INSTEAD,),
    ("as", "opposed", "to"): (INSTEAD,),
    ("is", "what", "i", "want"): ("must", "be"),
    ("is", "what", "i", "need"): ("must", "be"),
    ("is", "what", "should", "be"): ("must", "be"),
    ("is", "what", "i", "would", "like"): ("must", "be"),
    # What should have been is no goal.
    **{("have", done): (BYGONE,) for done in ("put", "placed", "moved", "stacked", "been")},
    ("back", "on"): ("on",),
    ("back", "onto"): ("on",),
    ("back", "in"): ("in",),
    **{
        (one, "and", other, noun): (f"{one} stack", "and", f"{other} stack")
        for one, other in permutations(("left", "middle", "right"), 2)
        for noun in ("stack", "stacks", "pile", "piles", "tower", "towers", "place", "places")
    },
    **{("to", "its", side): (side, "of", "it") for side in ("left", "right")},
    **{("on", "its", side): (side, "of", "it") for side in ("left", "right")},
    **{
        ("different", place, word): ("different", place, "as")
        for place in ("stack", "tower", "pile", "place", "column")
        for word in ("than", "from", "to")
    },
    ("under", "no", "circumstances"): ("not",),
    ("at", "no", "time"): ("not",),
    ("in", "no", "case"): ("not",),
    ("on", "no", "account"): ("not",),
    ("refrain", "from"): ("do", "not"),
    **dict.fromkeys(
        (
            ("not", "have", "to"),
            ("not", "need"),
            ("not", "need", "to"),
            ("need", "not"),
            ("neednt",),
            ("not", "necessarily"),
            ("not", "necessary"),
            ("not", "required"),
            ("no", "need", "for"),
            ("no", "need", "that"),
            ("no", "need", "to"),
            ("not", "mind"),
            ("not", "care"),
        ),
        ("not-asked-for",),
    ),
    ("including",): ("and",),
    ("next", "too"): ("next", "to"),
    ("anywhere", "but"): ("not", "in"),
    ("anywhere", "except"): ("not", "in"),
    ("anywhere", "but", "in"): ("not", "in"),
    ("anywhere", "except", "in"): ("not", "in"),
    ("in", "any", "stack", "but"): ("not", "in"),
    ("in", "any", "stack", "except"): ("not", "in"),
    ("make", "it", "so"): ("make",),
    ("pile", "up"): ("build",),
    ("stack", "up"): ("build",),
    ("build", "up"): ("build",),
    ("in", "stack", "next", "to"): ("next", "to"),
    ("in", "a", "stack", "next", "to"): ("next", "to"),
    ("in", "stack", "beside"): ("next", "to"),
    ("same", "for"): ("so", "should"),
    ("same", "goes", "for"): ("so", "should"),
    ("likewise",): ("so", "should"),
    ("in", "which"): ("where",),
    ("that", "one"): ("it",),
    ("this", "one"): ("it",),
    ("in", "neighbouring", "stacks"): ("next", "to", "each-other"),
    ("in", "neighboring", "stacks"): ("next", "to", "each-other"),
    ("in", "adjacent", "stacks"): ("next", "to", "each-other"),
    ("share", "a", "stack"): ("in", "same", "stack"),
    ("in", "one", "stack"): ("in", "same", "stack"),
    ("in", "one", "pile"): ("in", "same", "stack"),
    ("in", "one", "tower"): ("in", "same", "stack"),
    ("all", "way", "to", "left"): ("in", "left stack"),
    ("all", "way", "to", "right"): ("in", "right stack"),
    ("all", "way", "on", "left"): ("in", "left stack"),
    ("all", "way", "on", "right"): ("in", "right stack"),
    ("on", "table", "in"): ("on",),
    ("on", "table", "at"): ("on",),
    ("on", "floor", "of"): ("on",),
    ("on", "ground", "of"): ("on",),
    ("on", "ground", "in"): ("on",),
    ("such", "that"): ("where",),
    ("asked", "for"): ("want",),
    ("asks", "for"): ("want",),
    ("would", "like", "you"): ("want",),
    ("would", "like"): ("want",),
    ("want", "you"): ("want",),
    ("need", "you"): ("want",),
    ("like", "you"): ("want",),
    **{
        (verb, "a", noun, *of): ("build",)
        for verb in ("build", "make", "create", "construct", "form")
        for noun in ("tower", "stack")
        for of in ((), ("of",))
    },
    ("made", "of"): ("with",),
    ("consisting", "of"): ("with",),
    ("made", "up", "of"): ("with",),
    ("composed", "of"): ("with",),
}  # fmt: skip
