# SPDX-License-Identifier: Apache-2.0
"""Several words of a goal that stand for others: "out of" is read as "not in"."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Final

from .language import ARTICLES, CORRECTION, HOLDS, MUTE, NOUN_VERBS, TAKEN_BACK, TAKES
from .orders import order_at
from .places import place_at
from .terms import Words, number_of

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
_NUMBERS: Final[dict[tuple[str, ...], tuple[str, ...]]] = {
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
    ("all", "two"): ("both",),
    ("all", "two", "of", "them"): ("both",),
    ("all", "three", "of", "them"): ("all", "three"),
    ("either", "of", "them"): ("either-of-them",),
    ("side", "by", "side"): ("next", "to", "each-other"),
    ("each", "other"): ("each-other",),
    ("one", "another"): ("each-other",),
}
#: Nothing: whatever they are said of, the goal is the same.
_NOTHING: Final[dict[tuple[str, ...], tuple[str, ...]]] = dict.fromkeys(
    (
        tuple(text.split())
        for text in (
            "i do not care which of both", "i do not care which ones", "i do not care which one",
            "i do not care which", "not necessarily directly", "it does not matter which", "no matter which ones",
            "no matter which", "no matter where", "in whatever order", "in any order",
            "order does not matter", "aswell", "as well", "let me think", "let me see", "let us see",
            "thanks a lot", "thank you", "thank you very much", "would you please",
            "would you mind", "at end", "in end", "at all", "whatsoever", "after that", "can you",
            "can i", "can we", "can u", "could u", "of course", "for me", "ends up", "end up",
            "ended up", "so kind and", "in a way that", "final arrangement",
            "final state", "goal state", "end state", "that is it", "that is all", "thats it",
            "thats all", "how about", "what about", "is it possible", "would it be possible",
            "what i want is", "what i need is", "what i would like is", "for now",
            "right now", "for today", "if possible", "before next run", "before next trial",
            "for next run", "for next trial", "neither more nor less", "no more and no less",
            "no more no less", "sorry for trouble", "sorry for bother", "sorry to bother you", "would you be so kind and",
        )
    ),
    (),
)  # fmt: skip
#: People who correct themselves.
_CORRECTIONS: Final[dict[tuple[str, ...], tuple[str, ...]]] = dict.fromkeys(
    (
        tuple(text.split())
        for text in (
            "no wait", "wait no", "wait", "no sorry", "sorry no", "sorry", "i mean", "i meant",
            "or rather", "no actually", "actually no", "actually", "make that", "oops", "correction",
            "no i mean", "no i meant", "sorry i mean", "sorry i meant", "oh wait", "oh no", "oops no",
            "no wait a moment", "rather", "no no", "hang on", "hold on", "wait a minute", "nope",
        )
    ),
    (CORRECTION,),
) | dict.fromkeys(
    (
        tuple(f"{verb} {what}".split())
        for verb in ("scratch", "forget", "cancel", "strike", "ignore")
        for what in ("that", "it", "this", "last one")
    ),
    (TAKEN_BACK,),
)  # fmt: skip
_REST: Final = frozenset({"rest", "others", "remainder", "remaining blocks", "other blocks",
                          "everything else", "all others"})  # fmt: skip
#: What is not asked for.
_UNASKED: Final[dict[tuple[str, ...], tuple[str, ...]]] = dict.fromkeys(
    (
        tuple(text.replace("REST", rest).split())
        for rest in sorted(_REST)
        for text in (
            "leave REST", "leave REST alone", "leave REST be", "leave REST as it is",
            "leave REST as they are", "leave REST where it is", "leave REST where they are",
            "i do not care about REST", "i do not care where REST goes",
            "i do not care where REST go", "do not care about REST", "REST does not matter",
            "REST do not matter", "REST anywhere", "REST can go anywhere", "REST wherever",
            "do not touch REST", "never mind REST",
        )
    ),
    (),
)  # fmt: skip
#: Several words that stand for others, the longest first; looked for everywhere.
MERGED: Final[dict[tuple[str, ...], tuple[str, ...]]] = {
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
    ("build", "a", "tower"): ("build",),
    ("make", "a", "tower"): ("build",),
    ("build", "a", "stack"): ("build",),
    ("make", "a", "stack"): ("build",),
}  # fmt: skip
_LONGEST: Final = max(map(len, MERGED))


def merged(words: Sequence[Words]) -> list[Words]:
    """With several words that stand for others replaced, the longest first; without articles."""
    words = list(_without_articles(words))
    result: list[Words] = []
    index, removing = 0, False
    while index < len(words):
        before = result[-1].text if result else ""
        removing = removing or words[index].text in ("remove", "removing", "removed")
        found, used = _at(words[index:], before, removing)
        result += found
        index += used
    return result


def _at(words: Sequence[Words], before: str, removing: bool) -> tuple[list[Words], int]:
    """What some words begin with, as it is read, and how many words it is.

    Args:
        before: the word in front.
        removing: "remove" is in front, so that "from" says where something is not to be.
    """
    for length in range(min(_LONGEST, len(words)), 0, -1):
        texts = tuple(item.text for item in words[:length])
        if texts in MERGED:
            offset, stop = words[0].offset, words[length - 1].stop
            return [Words(text, offset, stop) for text in MERGED[texts]], length
    texts = tuple(item.text for item in words)
    if order := order_at(texts, before):
        name, used = order
        return [Words(name, words[0].offset, words[used - 1].stop)], used
    if place := place_at(words, before):
        return place
    if between := _between(texts):
        text, used = between
        return [Words(text, words[0].offset, words[used - 1].stop)], used
    if away := _away(words, removing):
        return away
    if texts[:2] == ("up", "to") and number_of(" ".join(texts[2:3])) is not None:
        return [Words("at-most", words[0].offset, words[1].stop)], 2
    if texts[0] == "to" and len(texts) > 1 and _is_verb(texts[1:]):
        return [], 1  # "I want you to put red on blue"
    return [words[0]], 1


def _away(words: Sequence[Words], removing: bool) -> tuple[list[Words], int] | None:
    """ "off blue" as "not on blue", "off stack 1" as "not in stack 1"; None for other words."""
    texts = [item.text for item in words[:4]]
    used = 0
    if texts[0] == "off":
        used = 1 + (texts[1:2] == ["of"])
    elif texts[0] == "from" and removing:
        used = 3 if texts[1:3] == ["top", "of"] else 1
    if not used or used == len(words):
        return None
    behind = words[used : used + 3]
    named = place_at(behind) or any(
        Words(" ".join(item.text for item in behind[:last]), 0).is_place for last in (1, 2)
    )
    offset, stop = words[0].offset, words[used - 1].stop
    inside = "in" if named else "on"
    return [Words("not", offset, stop), Words(inside, offset, stop)], used


def _is_verb(texts: Sequence[str]) -> bool:
    """Whether "to" in front of these words is no relation."""
    if texts[0] in NOUN_VERBS:
        return len(texts) > 1 and number_of(texts[1]) is None and texts[1] != "number"
    return texts[0] in MUTE | TAKES | HOLDS


def _between(texts: Sequence[str]) -> tuple[str, int] | None:
    """ "between two and three", "two or three" as one number; None where it is none."""
    start = int(texts[0] == "between")
    if len(texts) < start + 3 or texts[start + 1] not in ("and", "or", "to"):
        return None
    low, high = number_of(texts[start]), number_of(texts[start + 2])
    if low is None or high is None or low >= high:
        return None
    if not start and (texts[start + 1] != "or" or high != low + 1):
        return None
    return f"{low}-to-{high}", start + 3


def _without_articles(words: Sequence[Words]) -> list[Words]:
    """ "the two boxes" as "all two boxes"; "the only box" keeps its article, all others go."""
    result: list[Words] = []
    for index, item in enumerate(words):
        if item.text not in ARTICLES:
            result.append(item)
            continue
        behind = words[index + 1].text if index + 1 < len(words) else ""
        if (number_of(behind) or 0) > 1:
            result.append(Words("all", item.offset, item.stop))
        elif behind == "only":
            result.append(Words("the-", item.offset, item.stop))
    return result
