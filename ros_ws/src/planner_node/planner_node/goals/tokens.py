# SPDX-License-Identifier: Apache-2.0
"""From a text to words: sentences, the parts that commas make of them, contractions, slips."""

from __future__ import annotations

import re
from collections.abc import Iterator
from dataclasses import dataclass, field
from typing import Final

from scene_graph import COLORS, PREDICATES

from ..errors import InvalidGoalError
from .language import CLEAR, NEGATION, SHORT_NEGATIONS
from .phrases import without_slip
from .terms import Words

#: Relations as they are written in logic: "on(red, blue)", "clear(red)".
_CALL: Final = re.compile(r"([a-z_]+)\(([\w ]+)(?:,([\w ]+))?\)", re.IGNORECASE)
_TOKEN: Final = re.compile(
    r"(?P<left_out>[:;]-?[)D(](?!\w)|[\"“”‘]|['’](?!\w)|(?<!\w)['’]"
    r"|(?<=\bmax)\.|(?<=\bmin)\.|(?<=\bno)\.(?=\s*\d)|(?<=\bnr)\.(?=\s*\d))"
    r"|(?P<word>[^\W_](?:\w|-(?=\w)|['’](?=\w))*)|(?P<sign>(?<!\w)!(?=\w)|[-=]+>|→|[<>≤≥]=|[≤≥]|[&+=#@])"
    r"|(?P<end>[.;!?…])|(?P<comma>[,:()]|(?<!\d)/(?!\d))|(?P<dash>[-–—]+(?=\s))|(?P<other>\S)",
    re.IGNORECASE,
)
#: What is written as a sign, as words.
_SIGNS: Final = {
    "&": "and", "+": "and", "=": "is", "#": "number", "@": "in", "!": "not", "<=": "at-most",
    ">=": "at-least", "≤": "at-most", "≥": "at-least",
}  # fmt: skip
#: What is written short, as words.
_SHORT: Final = {
    "u": "you", "n": "and", "nd": "and", "w": "with", "ur": "your", "gonna": "going to",
    "wanna": "want to", "gotta": "must", "im": "i am", "ive": "i have", "id": "i would",
    "mit": "with", "und": "and", "auf": "on",
}  # fmt: skip
#: Ask about what is there, at the start of a question.
_ASKING: Final = frozenset({
    "is", "are", "was", "were", "does", "did", "has", "have", "what", "which", "where", "who",
    "why", "when", "how",
})  # fmt: skip
#: Words that are written together with the colour beside them: "redon blue", "red onblue".
_GLUED: Final = frozenset({"on", "onto", "in", "to", "is"})


@dataclass
class Part:
    """The words up to a comma, and what is written behind them: ``,``, ``:``, a dash, or nothing.

    Attributes:
        end: the sentence ends behind it.
    """

    words: list[Words] = field(default_factory=list)
    mark: str = ""
    end: bool = False


def parts_of(text: str) -> Iterator[Part]:
    """The parts of a goal in their order; the last one ends a sentence.

    Raises:
        InvalidGoalError: for a character that goals do not have, and for questions.
    """
    part, first = Part(), True
    behind = 0
    for match in _TOKEN.finditer(text):
        if match["left_out"] or match.start() < behind:
            continue
        if (call := _CALL.match(text, match.start())) and (told := _relation(call)):
            part.words += told
            behind = call.end()
            continue
        if match["other"]:
            raise InvalidGoalError("unexpected character", match.start(), match["other"])
        if word := match["word"]:
            part.words += _words(word.lower().replace("’", "'"), match.start())
            if first and part.words:
                _asks = part.words[0] if part.words[0].text in _ASKING else None
                first = False
            if [item.text for item in part.words] == ["how", "about"]:
                _asks = None
        elif sign := match["sign"]:
            part.words.append(Words(_SIGNS.get(sign, "to"), match.start(), match.end()))
        elif match["end"]:
            if match["end"] == "?" and not first and _asks is not None:
                raise InvalidGoalError(
                    "this asks what is there; say what is to be", _asks.offset, _asks.text
                )
            part.end, first = True, True
            yield part
            part = Part()
        else:
            part.mark = match["comma"] or "-"
            yield part
            part = Part()
    part.end = True
    yield part


def _relation(call: re.Match[str]) -> list[Words]:
    """ "on(red, blue)" as "red on blue", "clear(red)" as it is; none for what is no relation."""
    name = tuple(call[1].lower().split("_"))
    if (name in PREDICATES.phrases) != bool(call[3]) or not (call[3] or name[0] in CLEAR):
        return []
    order = (2, 1, 3) if call[3] else (1, 2)
    return [
        Words(word[0].lower(), call.start(group) + word.start())
        for group in order
        for word in re.finditer(r"[^\W_]+", call[group])
    ]


def _words(word: str, offset: int) -> list[Words]:
    """A word as it is read, its contractions written out."""
    if word in SHORT_NEGATIONS:
        end = offset + len(word)
        return [Words(SHORT_NEGATIONS[word], offset, end), Words(NEGATION, offset, end)]
    end = offset + len(word)
    if word in _SHORT:
        return [Words(one, offset, end) for one in _SHORT[word].split()]
    head, mark, tail = word.partition("'")
    if not mark:
        return _apart(word, offset) or [Words(without_slip(word), offset, end)]
    if tail == "t":
        # "can't" and "won't" lose more than the others.
        verb = {"can": "could", "won": "will"}.get(head, head.removesuffix("n"))
        return [Words(verb, offset, end), Words(NEGATION, offset, end)]
    verb = {"d": "would", "ll": "will"}.get(tail, "is")
    return [Words(head, offset, end), Words(verb, offset, end)]


def _apart(word: str, offset: int) -> list[Words]:
    """ "redon" as two words; none where it is not written together."""
    for at in range(2, len(word) - 1):
        one, other = word[:at], word[at:]
        if (one in COLORS and other in _GLUED) or (one in _GLUED and other in COLORS):
            return [Words(one, offset), Words(other, offset + at)]
    return []
