# SPDX-License-Identifier: Apache-2.0
"""The words of a text by their kinds, with slips mended and with what says nothing left out."""

from __future__ import annotations

from collections.abc import Collection, Iterator, Sequence
from dataclasses import dataclass
from functools import lru_cache
from typing import Final

from scene_graph import PREDICATES, SHAPES, Phrase

from ..hashing import hashed_once
from ..slips import mended
from .courtesy import courtesies
from .lexicon import BAD, ENTRIES, FILLER, HUES, RELATED
from .skipping import EVERYDAY, is_bound, stretches
from .tokens import Token

#: What it costs to leave a word out, a comma beside such a word, to mend a word, and to take one
#: that is part of others for one that nobody knows.
_LEFT_OUT: Final = 0.1
_COMMA: Final = 0.3
_MENDED: Final = 1.0
_STRANGE: Final = 0.2
#: And an adverb that nobody knows.
_ADVERB: Final = 0.4


@hashed_once
@dataclass(frozen=True)
class Word:
    """An entry where it was found.

    Attributes:
        text: as it is in the lexicon.
        means: what it stands for.
        phrase: the relation that it is.
    """

    text: str
    means: str
    offset: int
    end: int
    phrase: Phrase | None = None


#: What a word must not be that gives a reason.
_REASON: Final = frozenset({
    "RELATION", "PLACENOUN", "PLACENOUNS", "NUMBERED", "MARK", "COMMA", "AND", "BUT", "OR",
    "INSTEADOF", "ALLBUT",
})  # fmt: skip
#: What a word may be that is part of a sentence which says nothing of blocks.
_CHAT: Final = frozenset({
    "UNKNOWN", "I", "YOU", "A", "THE", "BE", "MUST", "CAN", "MAY", "DO", "GOOD", "PERSONNOUN",
    "PAST", "PLEASEME", "POSSESSIVE", "NOW", "STEP", "GOAL", "ADJ", "HIGH", "MODAL", "HAS",
    "GIVENFOR", "INPLACE", "TOSIDE", "TOSPOT", "OFOF", "OF", "LIKE", "AS", "PER", "IN", "PLAINUP",
    "FIRST", "NEEDNOT", "END", "FINAL", "VIEW", "LET", "LETTING", "REASONWORD", "OUTER",
    "DEAR", "TELLTALE", "HEADWORD", "HAPPY", "FEELING",
})  # fmt: skip
_JOINING: Final = frozenset({"and", "then", "but", "while", "tomorrow", "later", "on", "onto"})
#: For every word, by kind: where what begins there ends, what it is, and at what cost.
Lattice = list[dict[str, list[tuple[int, Word, float]]]]
#: By first word: kind, all words, what they stand for, and the phrase that they are.
_Index = dict[str, list[tuple[str, tuple[str, ...], str, Phrase | None]]]


@lru_cache(maxsize=4)
def _index(phrases: tuple[tuple[tuple[str, ...], Phrase], ...]) -> _Index:
    index: _Index = {}
    known = dict(phrases)
    for kind, listed in ENTRIES.items():
        for words, means in listed:
            if kind == "AWAYFROM" and words in known:
                continue  # somebody's own predicate
            index.setdefault(words[0], []).append((kind, words, means, None))
    for color in HUES:
        index.setdefault(color, []).append(("COLOR", (color,), color, None))
    for words, means in RELATED:
        index.setdefault(words[0], []).append(
            ("RELATION", words, means, known[tuple(means.split())])
        )
    for words, phrase in phrases:
        index.setdefault(words[0], []).append(("RELATION", words, " ".join(words), phrase))
    return index


def lattice_of(
    tokens: Sequence[Token], literals: Collection[str], skipping: bool = False
) -> Lattice:
    """What begins at every word, behind a START in front of all.

    What follows and may be left out belongs to the word in front of it, or does not.

    Args:
        skipping: what says nothing of blocks may be left out, too.
    """
    index = _index(tuple(PREDICATES.phrases.items()))
    listed = [entry for found in index.values() for _, entry, _, _ in found]
    known = frozenset(word for entry in listed for word in entry) | set(literals) | set(SHAPES)
    alone = {entry[0] for entry in listed if len(entry) == 1} | set(literals)
    written = [token.text for token in tokens]
    words = [_meant(word, known, alone) for word in written]
    found: Lattice = []
    fillers: list[list[tuple[int, float]]] = []
    for start, token in enumerate(tokens):
        here: dict[str, list[tuple[int, Word, float]]] = {}
        skips: list[tuple[int, float]] = []
        for kind, entry, means, phrase in (
            one for said in words[start] for one in index.get(said, ())
        ):
            matched = _matched(words, start, entry)
            if matched is None:
                continue
            end, cost = matched
            if kind == FILLER:
                # Not "if you can not put red on blue, …".
                verb = entry[:2] == ("if", "you") and end < len(tokens)
                if not (verb and tokens[end].text[0].isalnum()):
                    skips.append((end, cost + _LEFT_OUT))
                continue
            word = Word(" ".join(entry), means, token.offset, tokens[end - 1].end, phrase)
            here.setdefault(kind, []).append((end, word, cost))
        skips += [(end, _LEFT_OUT) for end in courtesies(written, start)]
        if skipping:
            skips += stretches(written, start)
        if token.text.endswith("ly") and token.text not in known | BAD:
            skips.append((start + 1, _ADVERB))  # how it is done
        for kind, said, cost in _kinds(token.text, words[start], literals, alone):
            word = Word(said, said, token.offset, token.end)
            here.setdefault(kind, []).append((start + 1, word, cost))
        itself = Word(token.text, token.text, token.offset, token.end)
        if token.text not in BAD | _JOINING:
            if _REASON.isdisjoint(here):
                here["REASONWORD"] = [(start + 1, itself, 0.0)]
            mends = words[start].keys() & BAD  # of "nver", that it may be "never"
            spoken = {
                kind
                for kind, listed in here.items()
                if not kind.startswith("'") and (mends or not all(cost for *_, cost in listed))
            }
            if token.text in ("in", "at", "to"):
                spoken.discard("RELATION")
            if spoken <= _CHAT and (len(token.text) > 1 or spoken - {"UNKNOWN", "REASONWORD"}):
                here["CHATWORD"] = [(start + 1, itself, 0.0)]
        # "still" says nothing of a block that is told of: "red is still wet, so …".
        if skipping and (token.text == "still" or not is_bound(token.text)):
            here["FREEWORD"] = [(start + 1, itself, 0.0)]
        if skipping and token.text in EVERYDAY:
            here["EVERYDAYWORD"] = [(start + 1, itself, 0.0)]
        found.append(here)
        fillers.append(skips)
    return _with_fillers(found, fillers, written)


def _meant(word: str, known: frozenset[str], alone: Collection[str]) -> dict[str, float]:
    """What a word may be, and at what cost."""
    found = {word: 0.0}
    if word not in alone:
        found |= dict.fromkeys(mended(word, known - {word}), _MENDED)
    return found


def _matched(
    words: Sequence[dict[str, float]], start: int, entry: Sequence[str]
) -> tuple[int, float] | None:
    """Where an entry ends that begins here; articles between its words do not matter."""
    at, cost = start, 0.0
    for number, word in enumerate(entry):
        if number and at < len(words) and "the" in words[at] and word != "the":
            at += 1
        if at >= len(words) or word not in words[at]:
            return None
        cost += words[at][word]
        at += 1
    return at, cost


def _kinds(
    word: str, meant: dict[str, float], literals: Collection[str], alone: Collection[str]
) -> Iterator[tuple[str, str, float]]:
    """The kinds of a word that the lexicon cannot list."""
    for said, cost in meant.items():
        if said in literals:
            yield f"'{said}'", said, cost
    if word.isdigit():
        yield "NUMBER", word, 0.0
        yield "INDEX", word, 0.0
    elif "_" in word and not word[-1].isdigit():
        yield "FULLNAME", word, 0.0
    elif word[-1].isdigit() or ("-" in word and word.split("-")[-1].isdigit()):
        yield "NUMBERED", word, 0.0
    elif word not in alone and word[0].isalpha():
        mends = len(meant) > 1
        yield "SLIP" if mends else "UNKNOWN", word, _STRANGE + _MENDED * mends


def _with_fillers(
    found: Lattice, fillers: Sequence[Sequence[tuple[int, float]]], words: Sequence[str]
) -> Lattice:
    """The lattice with what is left out behind every word, and a START."""
    behind: list[dict[int, float]] = [{} for _ in range(len(words) + 1)]
    for start in range(len(words), -1, -1):
        reached = {start: 0.0}
        first, extra = start, 0.0
        if start < len(words) and words[start] in (",", "-", "."):
            first, extra = start + 1, _COMMA
        for end, cost in fillers[first] if first < len(words) else ():
            comma = end < len(words) and words[end] == ","
            for after, more in ((end, 0.0), (end + 1, _COMMA)) if comma else ((end, 0.0),):
                for last, rest in behind[after].items():
                    total = extra + cost + more + rest
                    reached[last] = min(total, reached.get(last, total))
        behind[start] = reached
    opening = Word("", "", 0, 0)
    lattice: Lattice = [{"START": [(end + 1, opening, cost) for end, cost in behind[0].items()]}]
    for here in found:
        lattice.append(
            {
                kind: [
                    (last + 1, word, cost + more)
                    for end, word, cost in listed
                    for last, more in behind[end].items()
                ]
                for kind, listed in here.items()
            }
        )
    return lattice
