# SPDX-License-Identifier: Apache-2.0
"""From a text to the words of its clauses: what is written together, and what stands for what."""

from __future__ import annotations

import re
from collections.abc import Iterator, Sequence
from typing import Final

from scene_graph import PREDICATES

from ..errors import InvalidGoalError
from .language import (
    ARTICLES,
    HEADING,
    JOINS,
    MUTE,
    NEGATION,
    NOUN_VERBS,
    NUMBERS,
    OPENINGS,
    ORDERS,
    PLACE_NOUNS,
    POLITE,
    SHORT_NEGATIONS,
    SIDES,
    meant,
)
from .merged import MERGED
from .phrases import RIGHT_WORDS, find, without_slip
from .terms import Words

_TOKEN: Final = re.compile(
    r"(?P<word>[^\W_](?:[\w-]|['’](?=\w))*|&)|(?P<end>[.;!?])|(?P<comma>[,:])"
    r"|(?P<arrow>[-=]+>|→)|(?P<dash>[-–—]+(?=\s))|(?P<other>\S)"
)
_YOU: Final = frozenset({"would", "could", "will", "can", "you"})
_DENYING: Final = frozenset({NEGATION, "nothing", "none"})
_LONGEST: Final = max(map(len, MERGED))


def sentences(text: str) -> Iterator[list[list[Words]]]:
    """The clauses of every sentence; those that say nothing are left out."""
    clauses: list[list[Words]] = [[]]
    for match in _TOKEN.finditer(text):
        if match["other"]:
            raise InvalidGoalError("unexpected character", match.start(), match["other"])
        if match["end"]:
            yield from _finished(clauses)
            clauses = [[]]
        elif match["arrow"]:
            clauses[-1].append(Words("to", match.start(), match.end()))
        elif match["comma"] == ":" and (place := _place_heading(_merged(clauses[-1]))):
            # "stack 1: red" is a sentence of its own.
            yield from _finished(clauses[:-1])
            clauses = [place, []]
        elif match["comma"] or match["dash"]:
            if match["comma"] == ":" and is_heading(_merged(clauses[-1])):
                clauses.pop()
            clauses.append([])
        else:
            clauses[-1] += _words(match["word"].lower().replace("’", "'"), match.start())
    yield from _finished(clauses)


def _finished(clauses: Sequence[list[Words]]) -> Iterator[list[list[Words]]]:
    """The sentence of these clauses; none where they say nothing."""
    if kept := [clause for clause in map(_merged, clauses) if not _says_nothing(clause)]:
        parts: list[list[Words]] = []
        denied = False
        for clause in _with_order(kept):
            parts += _split_negation(clause, denied)
            # "nothing on red, green or blue"
            denied = any(item.text in _DENYING for item in clause) or (
                denied and not _has_phrase(clause)
            )
        yield _as_tower(parts)


def _has_phrase(clause: Sequence[Words]) -> bool:
    return any(True for _ in find(clause, PREDICATES.phrases))


def _place_heading(clause: list[Words]) -> list[Words] | None:
    """ "in stack 1" for "stack 1" or "a tower in stack 1" before a colon; None for all else."""
    clause = [item for item in clause if item.text not in (HEADING | MUTE) - NOUN_VERBS]
    if len(clause) > 1 and clause[0].text in ("in", "on", "at"):
        clause = clause[1:]
    if clause and Words(" ".join(item.text for item in clause), clause[0].offset).is_place:
        return [Words("in", clause[0].offset, clause[0].offset), *clause]
    return None


def _with_order(clauses: Sequence[list[Words]]) -> list[list[Words]]:
    """ "in stack 1, from bottom to top: red, blue" with the order behind its place."""
    result: list[list[Words]] = []
    for clause in clauses:
        before = result[-1] if result else []
        ordered = any(item.text in ORDERS for item in clause)
        place = len(before) > 1 and before[0].text in ("in", "on", "at")
        if ordered and place and _place_heading(before[1:]):
            result[-1] = [*before, *clause]
        elif ordered and before and is_heading(before):
            result[-1] = clause  # "please stack, starting from the bottom"
        else:
            result.append(clause)
    return result


def _words(word: str, offset: int) -> list[Words]:
    """A word as it is read: without articles, and its contractions written out."""
    if word in ARTICLES:
        return []
    if word in SHORT_NEGATIONS:
        end = offset + len(word)
        return [Words(SHORT_NEGATIONS[word], offset, end), Words(NEGATION, offset, end)]
    if word == "lets":
        return [Words("let", offset)]
    head, mark, tail = word.partition("'")
    end = offset + len(word)
    if not mark:
        return [Words(without_slip(word), offset, end)]
    if tail == "t":
        # "can't" and "won't" lose more than the others.
        verb = {"can": "could", "won": "will"}.get(head, head.removesuffix("n"))
        return [Words(verb, offset, end), Words(NEGATION, offset, end)]
    verb = {"d": "would", "ll": "will"}.get(tail, "is")
    return [Words(head, offset, end), Words(verb, offset, end)]


def _merged(words: Sequence[Words]) -> list[Words]:
    """With several words that stand for others replaced."""
    result: list[Words] = []
    index = 0
    while index < len(words):
        for length in range(min(_LONGEST, len(words) - index), 0, -1):
            texts = tuple(item.text for item in words[index : index + length])
            if texts in MERGED:
                whole = words[index : index + length]
                result += [Words(text, whole[0].offset, end_of(whole)) for text in MERGED[texts]]
                index += length
                break
        else:
            if side := _side_of_the_row(words[index : index + 3]):
                result.append(side)
                index += 1
            else:
                result.append(words[index])
            index += 1
    return result


def _side_of_the_row(words: Sequence[Words]) -> Words | None:
    """ "left stack" as the name of a place; in "left stack 1", left is a relation."""
    if len(words) < 2 or words[0].text not in SIDES or words[1].text not in PLACE_NOUNS:
        return None
    if len(words) == 3 and (words[2].text.isdigit() or words[2].text in NUMBERS):
        return None
    return Words(f"{words[0].text} {words[1].text}", words[0].offset, words[1].stop)


def _says_nothing(clause: Sequence[Words]) -> bool:
    if clause and clause[0].text == "for" and is_heading(clause):
        return True  # "for the experiment"
    if any(item.text == "you" for item in clause):
        return all(item.text in POLITE | _YOU for item in clause)  # "would you?"
    return all(item.text in POLITE for item in clause)


def _split(clauses: Sequence[list[Words]]) -> Iterator[list[Words]]:
    """Once more, at words that join relations."""
    for clause in clauses:
        part: list[Words] = []
        for item in clause:
            if item.text in OPENINGS and all(word.text in MUTE for word in part):
                # What is before is no relation, and none is missing.
                part = []
            elif item.text not in JOINS and not (item.text in OPENINGS and _has_phrase(part)):
                part.append(item)
            else:
                if part and not _says_nothing(part):
                    yield part
                part = []
        if part and not _says_nothing(part):
            yield part


def _split_negation(clause: list[Words], denied: bool) -> Iterator[list[Words]]:
    """Once more, with "neither … nor" and "not … or" as a list that is denied.

    Args:
        denied: whether the clause before is.
    """
    texts = [item.text for item in clause]
    neither = "neither" in texts and "nor" in texts
    nothing = "or" in texts and "nothing" in texts[: texts.index("or")]
    if nothing or (denied and "or" in texts and NEGATION not in texts and not _has_phrase(clause)):
        # What is not on red or blue is on none of them.
        yield from _split(
            [
                [
                    Words("and", item.offset, item.stop) if item.text == "or" else item
                    for item in clause
                ]
            ]
        )
        return
    if not neither and not (NEGATION in texts and "or" in texts[texts.index(NEGATION) :]):
        yield from _split([clause])
        return
    start = texts.index("neither" if neither else NEGATION)
    denial = Words(NEGATION, clause[start].offset, clause[start].stop)
    joined = [
        Words("and", item.offset, item.stop) if item.text in ("nor", "or") else item
        for item in clause
        if item.text not in ("neither", NEGATION)
    ]
    parts = list(_split([joined]))
    with_phrase = [_has_phrase(part) for part in parts]
    if neither and start == 0 and with_phrase[0] and not all(with_phrase):
        # "neither red on blue nor green": on green, or the green one?
        yield clause
        return
    for index, part in enumerate(parts):
        # What denies is with every relation, or with the last part.
        last = index == len(parts) - 1 and not any(with_phrase)
        yield [denial, *part] if with_phrase[index] or last else part


def _as_tower(clauses: list[list[Words]]) -> list[list[Words]]:
    """ "in stack 0: red at the bottom, then blue, green on top" as "from bottom to top"."""
    ends: dict[tuple[str, ...], int] = {
        ("at", "bottom"): 0,
        ("on", "bottom"): 0,
        ("on", "top"): 1,
        ("at", "top"): 1,
    }
    last_two = [tuple(item.text for item in clause[-2:]) for clause in clauses]
    told = [index for index, texts in enumerate(last_two) if texts in ends]
    if len(told) != 2 or told[1] != len(clauses) - 1:
        return clauses
    first, second = (ends[last_two[index]] for index in told)
    if first == second:
        return clauses
    heading, name = _heading_before(clauses[told[0]][:-2])
    if told[0] == 1 and not heading:
        heading = clauses[0]
    elif told[0] != 0:
        return clauses
    order = Words("bottom-to-top" if first == 0 else "top-to-bottom", name[0].offset)
    middle = [
        clause[:-2] if texts == ("in", "middle") else clause
        for clause, texts in zip(clauses[told[0] + 1 : -1], last_two[told[0] + 1 : -1])
    ]
    return [[*heading, order], name, *middle, clauses[-1][:-2]]


def _heading_before(words: list[Words]) -> tuple[list[Words], list[Words]]:
    """What is before "with", and what is behind."""
    for index, item in enumerate(words):
        if item.text in OPENINGS and index:
            return words[:index], words[index + 1 :]
    return [], words


def is_heading(words: Sequence[Words]) -> bool:
    """Whether it only says that a goal follows: "the goal for my class", "build a tower"."""
    known = HEADING | MUTE
    exact = [item.text in known for item in words]
    if len(words) > 1 and any(exact):
        exact = [meant(item.text, known, RIGHT_WORDS) is not None for item in words]
    return all(exact)


def end_of(words: Sequence[Words]) -> int:
    """Where the last of them ends in the goal."""
    return words[-1].stop
