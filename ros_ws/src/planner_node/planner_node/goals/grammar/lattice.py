# SPDX-License-Identifier: Apache-2.0
"""The words of a text by their kinds, with slips mended and with what says nothing left out."""

from __future__ import annotations

from collections.abc import Collection, Iterator, Sequence
from dataclasses import dataclass
from functools import lru_cache
from typing import Final

from scene_graph import COLORS, PREDICATES, SHAPES, Phrase

from .lexicon import MORE_COLORS, NO_SLIPS, entries
from .slips import mended
from .tokens import Token

#: What it costs to leave a word out, to mend one, and to leave a comma out beside such a word.
_LEFT_OUT: Final = 0.1
_MENDED: Final = 1.0
_COMMA: Final = 0.3


@dataclass(frozen=True)
class Word:
    """An entry where it was found.

    Attributes:
        text: as it is in the lexicon.
        means: what it stands for.
    """

    text: str
    means: str
    offset: int
    end: int
    phrase: Phrase | None = None


#: By first word: kind, all words, what they stand for, and the phrase that they are.
_Index = dict[str, list[tuple[str, tuple[str, ...], str, Phrase | None]]]


@lru_cache(maxsize=4)
def _index(phrases: tuple[tuple[tuple[str, ...], Phrase], ...]) -> _Index:
    index: _Index = {}
    for kind, words, means in entries():
        index.setdefault(words[0], []).append((kind, words, means, None))
    for color in (*COLORS, *MORE_COLORS):
        index.setdefault(color, []).append(("COLOR", (color,), color, None))
    for words, phrase in phrases:
        index.setdefault(words[0], []).append(("RELATION", words, " ".join(words), phrase))
    return index


def lattice_of(
    tokens: Sequence[Token], literals: Collection[str]
) -> list[dict[str, list[tuple[int, Word, float]]]]:
    """For every word, by kind, what begins there, where it ends, and at what cost.

    What follows and may be left out belongs to the word in front of it, or does not.
    """
    index = _index(tuple(PREDICATES.phrases.items()))
    known = {word for listed in index.values() for _, words, _, _ in listed for word in words}
    known |= set(literals) | set(SHAPES)
    right = frozenset(known)
    costs: list[float] = []
    words: list[tuple[str, ...]] = []
    for token in tokens:
        better: tuple[str, ...] = ()
        if token.text not in known and token.text.isalpha() and token.text not in NO_SLIPS:
            better = mended(token.text, right)
        words.append(better or (token.text,))
        costs.append(_MENDED * bool(better))
    found: list[dict[str, list[tuple[int, Word, float]]]] = []
    fillers: list[list[tuple[int, float]]] = []
    for start, token in enumerate(tokens):
        here: dict[str, list[tuple[int, Word, float]]] = {}
        skips: list[tuple[int, float]] = []
        for kind, entry, means, phrase in (
            one for word in words[start] for one in index.get(word, ())
        ):
            end = _end(words, start, entry)
            if end is None:
                continue
            cost = sum(costs[start:end])
            if kind == "FILLER" and entry[:2] == ("if", "you") and end < len(words):
                if words[end][0].isalnum():
                    continue  # "if you can not put red on blue, …"
            if kind == "FILLER":
                skips.append((end, cost + _LEFT_OUT))
                continue
            text = " ".join(entry)
            word = Word(text, means, token.offset, tokens[end - 1].end, phrase)
            here.setdefault(kind, []).append((end, word, cost))
        if costs[start] and token.text[0].isalpha():
            word = Word(token.text, token.text, token.offset, token.end)
            here["UNKNOWN"] = [(start + 1, word, costs[start] + 0.2)]
        for said in words[start]:
            for kind, means in _kinds(said, known):
                word = Word(said, means, token.offset, token.end)
                here.setdefault(kind, []).append((start + 1, word, costs[start]))
            if said in literals:
                word = Word(said, said, token.offset, token.end)
                here[f"'{said}'"] = [(start + 1, word, costs[start])]
        found.append(here)
        fillers.append(skips)
    return _with_fillers(found, fillers, words)


def _end(words: Sequence[Sequence[str]], start: int, entry: Sequence[str]) -> int | None:
    """Where an entry ends that begins here; articles between its words do not matter."""
    at = start
    for number, word in enumerate(entry):
        if number and at < len(words) and words[at] == ("the",) and word != "the":
            at += 1
        if at >= len(words) or word not in words[at]:
            return None
        at += 1
    return at


def _kinds(word: str, known: Collection[str]) -> Iterator[tuple[str, str]]:
    """The kinds of a word that the lexicon cannot list."""
    if word.isdigit():
        yield "NUMBER", word
        yield "INDEX", word
    elif "_" in word and not word[-1].isdigit():
        yield "FULLNAME", word
    elif word[-1].isdigit() or ("-" in word and word.split("-")[-1].isdigit()):
        yield "NUMBERED", word
    elif word not in known and word[0].isalpha():
        yield "UNKNOWN", word


def _with_fillers(
    found: list[dict[str, list[tuple[int, Word, float]]]],
    fillers: list[list[tuple[int, float]]],
    words: Sequence[Sequence[str]],
) -> list[dict[str, list[tuple[int, Word, float]]]]:
    behind: list[dict[int, float]] = [{} for _ in range(len(words) + 1)]
    for start in range(len(words), -1, -1):
        reached = {start: 0.0}
        if start < len(words):
            openings = [(start, 0.0)]
            if words[start][0] in (",", "-", "."):
                openings = [(start + 1, _COMMA)]
            for first, extra in openings:
                if first >= len(words):
                    continue
                for end, cost in fillers[first]:
                    for last, more in behind[end].items():
                        _keep(reached, last, extra + cost + more)
                    if end < len(words) and words[end] == (",",):
                        for last, more in behind[end + 1].items():
                            _keep(reached, last, extra + cost + _COMMA + more)
        behind[start] = reached
    for here in found:
        for kind, listed in here.items():
            here[kind] = [
                (last, word, cost + more)
                for end, word, cost in listed
                for last, more in behind[end].items()
            ]
    start_here = behind[0] if behind else {}
    opening = Word("", "", 0, 0)
    found.insert(0, {"START": [(last + 1, opening, cost) for last, cost in start_here.items()]})
    for here in found[1:]:
        for kind, listed in here.items():
            here[kind] = [(end + 1, word, cost) for end, word, cost in listed]
    return found


def _keep(reached: dict[int, float], end: int, cost: float) -> None:
    reached[end] = min(cost, reached.get(end, 1e9))
