# SPDX-License-Identifier: Apache-2.0
"""A text as words and signs, contractions written out."""

from __future__ import annotations

import re
from dataclasses import dataclass
from typing import Final

from scene_graph import PREDICATES

from ...errors import InvalidGoalError
from .lexicon import HUES

_TOKEN: Final = re.compile(
    r"(?P<left_out>[:;]-?[)D(](?!\w)|[\"“”‘*]|['’](?!\w)|(?<!\w)['’]|(?<![\w.])(?:\d+|[a-e])\)(?=\s)"
    r"|(?<!\w)p\.? ?s\.|(?<!\w)(?:req|rule|item|point|spec|todo|task|job)[-_ ]?\d+:"
    r"|(?<=\bmax)\.|(?<=\bmin)\.|(?<=\bno)\.(?=\s*\d)|(?<=\bnr)\.(?=\s*\d))"
    r"|(?P<word>[^\W_](?:\w|-(?=\w)|['’](?=\w))*)"
    r"|(?P<sign>(?<!\w)!\(?(?=\w)|[-=]+>|→|[<>≤≥=!]=|>|[≤≥]|&+|[+=#@])"
    r"|(?P<end>[.;!?…\n]+|\.\.\.)|(?P<comma>[,()\[\]]|(?<!\d)/(?!\d))|(?P<colon>:=?)"
    r"|(?P<dash>[-–—]+(?=\s|$))|(?P<other>\S)",
    re.IGNORECASE,
)
_THAT_IS: Final = re.compile(r"\bi\.e\.", re.IGNORECASE)
#: "stack[0]".
_INDEXED: Final = re.compile(r"([a-z]+)\[(\d+)\]", re.IGNORECASE)
#: Relations as they are written in logic: "on(red, blue)", "clear(red)".
_CALL: Final = re.compile(r"([a-z_]+)\(([\w ]+)(?:,([\w ]+))?\)", re.IGNORECASE)
#: Of a place in a call: "count(stack0) <= 2".
_COUNTED: Final = frozenset({"count", "len", "length", "size", "height", "num", "number"})
_SIGNS: Final = {
    "+": "and", "=": "is", "==": "is", "#": "number", "@": "to", "!": "not", "!=": "is not",
    ">": ">", "<=": "at most", ">=": "at least", "≤": "at most", "≥": "at least",
}  # fmt: skip
#: What is written short, as words.
_SHORT: Final = {
    "idc": "i do not care", "ze": "the", "zee": "the", "da": "the", "dat": "that", "dis": "this",
    "u": "you", "n": "and", "nd": "and", "adn": "and", "w": "with", "w/": "with", "ur": "your",
    "gonna": "going to", "wanna": "want to", "gotta": "must", "gimme": "give me", "im": "i am",
    "ive": "i have", "id": "i would", "lets": "let us", "mit": "with", "und": "and", "auf": "on",
    "dont": "do not", "dnt": "do not", "doesnt": "does not", "didnt": "did not", "cant": "can not",
    "cannot": "can not", "wont": "will not", "isnt": "is not", "arent": "are not",
    "shouldnt": "should not", "mustnt": "must not", "wouldnt": "would not", "neednt": "need not",
    "shan't": "shall not", "can't": "can not", "won't": "will not", "ain't": "is not",
    "thats": "that is", "its": "its", "let's": "let us", "ontop": "on top", "inbetween": "between",
    "there's": "there is", "theres": "there is", "youd": "you would", "teh": "the", "hte": "the",
    "th": "the", "thats it": "that is it", "y'all": "you", "d'you": "do you", "atleast": "at least",
    "alot": "a lot", "infront": "in front", "upside-down": "upside down", "nr": "number",
    "der": "the", "die": "the", "das": "the", "upto": "up to", "pt": "put", "topof": "top of",
    "whats": "what is", "itll": "it will", "hes": "he is", "whos": "who is",
    "nonempty": "not empty", "outta": "out of", "smth": "something", "sth": "something",
    "btw": "by the way", "b4": "before", "cud": "could", "shud": "should", "wud": "would",
    "shoud": "should", "ty": "thank you", "em": "them", "rite": "right",
}  # fmt: skip
_TAILS: Final = {"d": "would", "ll": "will", "re": "are", "ve": "have", "m": "am", "s": "is"}
#: Words that are written together with the one beside them: "redon blue", "putthe red".
_GLUED: Final = frozenset({"on", "onto", "in", "to", "is", "the", "put"})
_NOUNS: Final = frozenset({"box", "block", "one", "cube", "cylinder"})


@dataclass(frozen=True)
class Token:
    """A word in lower case, or a sign: ``,`` ``.`` ``:`` ``-`` ``?``; where it stands."""

    text: str
    offset: int
    end: int


def tokens_of(text: str) -> list[Token]:
    """The words and signs of a text; raises InvalidGoalError for a sign that goals do not have."""
    text = _INDEXED.sub(r"\1 \2 ", text)
    text = _THAT_IS.sub("viz ", text)  # as long as it was
    found: list[Token] = []
    behind = 0
    for match in _TOKEN.finditer(text):
        if match["left_out"] or match.start() < behind:
            continue
        start, end = match.start(), match.end()
        if match["other"]:
            raise InvalidGoalError("unexpected character", start, match["other"])
        if (call := _CALL.match(text, start)) and (told := _relation(call)):
            found += told
            behind = call.end()
            continue
        if word := match["word"]:
            if word.lower() == "comma":
                found.append(Token(",", start, end))  # somebody dictates
                continue
            words = _words(word.lower().replace("’", "'"))
            if len(words) > 1 and "".join(words) == word.lower():
                at = start
                for one in words:
                    found.append(Token(one, at, at + len(one)))
                    at += len(one)
                continue
            found += [Token(one, start, end) for one in words]
        elif sign := match["sign"]:
            words = _SIGNS.get(sign.rstrip("("), "and" if "&" in sign else "->").split()
            found += [Token(one, start, end) for one in words]
        elif match["end"]:
            found.append(Token("?" if "?" in match["end"] else ".", start, end))
        elif match["colon"]:
            found.append(Token(":", start, end))
        else:
            found.append(Token("," if match["comma"] else "-", start, end))
    return found


def _relation(call: re.Match[str]) -> list[Token]:
    """ "on(red, blue)" as "red on blue", "clear(red)" as it is; none for what is no relation."""
    name = tuple(call[1].lower().split("_"))
    if name[0] in _COUNTED and not call[3]:
        words = ["height", "of", *call[2].lower().split()]
        return [Token(word, call.start(), call.end()) for word in words]
    if (name in PREDICATES.phrases) != bool(call[3]) or not (call[3] or name[0] == "clear"):
        return []
    found = []
    for group in (2, 1, 3) if call[3] else (1, 2):
        # The relation stands behind its subject, as it does in words.
        for word in re.finditer(r"[^\W_]+", call[group]):
            start, end = (call.start(group) + at for at in word.span())
            if group == 1 and call[3]:
                start = end = call.end(2)
            found.append(Token(word[0].lower(), start, end))
    return found


def _words(word: str) -> list[str]:
    """A word with its contractions written out."""
    if word in _SHORT:
        return _SHORT[word].split()
    head, mark, tail = word.partition("'")
    if mark and tail == "t":
        return [head.removesuffix("n"), "not"]
    if mark and tail in _TAILS:
        return [head, _TAILS[tail] if tail != "s" else "'s"]
    for at in range(2, len(word) - 1):
        one, other = word[:at], word[at:]
        behind = one in HUES and other in _GLUED | _NOUNS
        if behind or (one in _GLUED and other in HUES) or (one, other) == ("put", "the"):
            return [one, other]
    if "-" in word and word.partition("-")[0] in HUES | {"non"}:
        return word.split("-")  # "red-colored", "non-red"
    return [word]
