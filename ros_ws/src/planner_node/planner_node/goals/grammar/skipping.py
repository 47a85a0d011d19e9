# SPDX-License-Identifier: Apache-2.0
"""Stretches of a text that say nothing of how blocks shall stand: what is read around them.

Where a text is not read whole, these may be skipped. They are told by words alone, and a word that
can change what is meant is bound, that is never skipped: whatever has a meaning for the grammar
(``FREEKIND`` are the kinds that have none), and what is like such a word with a slip. So a stretch
is made of words nobody knows and of ``FREE`` ones, and it is

* a clause of its own, between signs or at an end: "go go", "the kids are watching";
* a clause of purpose, time or reason, or a likeness, behind an ``OPENER``: "like a crown";
* a wish that holds a clause: "the goal is a configuration in which …" (``WISHWORD``);
* what nobody cares for: "order doesn't matter" (``CAREWORD``), "not necessarily touching";
* a remark behind a goal or in front, in words of every day: ", the baby crawls over there"
  (``REMARK``, ``EVERYDAY``);
* a time in front: "by lunch …" (``FRONT``), and a heading: "acceptance criterion: …" (``LABEL``).

The last four may have bound words, too, so they have no others than those that are listed.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from functools import lru_cache
from typing import Final

from scene_graph import SHAPES

from ..language import NOUNS, NUMBERS, PLACE_NOUNS, SYNONYMS
from ..slips import edits, mended
from .lexicon import BAD, ENTRIES, HUES, NO_SLIPS, RELATED, SKIPPED

#: What a stretch costs, and each of its words: it is left out only where nothing else helps.
_COST: Final = 0.8
_WORD: Final = 0.1
#: How many words a stretch may have.
_LONGEST: Final = 16
_SIGNS: Final = frozenset(",.:-?")
_ASKING: Final = frozenset({
    "is", "are", "do", "does", "what", "which", "who", "where", "if", "can", "could", "would",
    "will", "shall", "should", "must",
})  # fmt: skip
_MODALS: Final = frozenset({"would", "should", "must", "will", "shall", "'d"})
#: How words begin that deny others: "unacceptable".
_DENYING: Final = ("un", "dis", "mis", "non", "anti", "counter", "contra")
#: Names: what is like one of them is bound as well.
_NAMES: Final = (
    HUES | frozenset(SHAPES) | NOUNS | PLACE_NOUNS
    | frozenset(SYNONYMS) | frozenset(NUMBERS)
)  # fmt: skip


def _words_of(kind: str) -> frozenset[str]:
    return frozenset(" ".join(entry) for entry in SKIPPED[kind])


def _bound() -> frozenset[str]:
    """The words of all kinds that mean something."""
    free = _words_of("FREEKIND")
    listed = [entry for kind, found in ENTRIES.items() if kind not in free for entry, _ in found]
    listed += [entry for entry, _ in RELATED]
    words = {word for entry in listed for word in entry}
    return frozenset(words - _words_of("FREE")) | _words_of("BOUND") | BAD | _NAMES


_BOUND: Final = _bound()
_FREE: Final = _words_of("FREE") - _words_of("BOUND")
#: Words of every day that say nothing of how blocks stand.
EVERYDAY: Final = _words_of("EVERYDAY") - _BOUND
_KNOWN: Final = _FREE | NO_SLIPS | EVERYDAY | {
    word for found in ENTRIES.values() for entry, _ in found for word in entry
}  # fmt: skip
_CARE, _CARELESS, _CARE_DENIAL, _CARE_WORDS = map(
    _words_of, ("CARECORE", "CARELESS", "CAREDENIAL", "CAREWORD")
)
_NEED_NOT, _NEED_NOT_CORE = map(_words_of, ("NEEDNOTWORD", "NEEDNOTCORE"))
_WISH, _WISHES, _GOOD, _OPENS = map(_words_of, ("WISHWORD", "WISHCORE", "WISHGOOD", "WISHOPENS"))
_REMARK, _LABELS = map(_words_of, ("REMARK", "LABEL"))
_UNSAID: Final = _words_of("UNSAID")
_STARTING: Final = _words_of("STARTING")
_VERBS: Final = frozenset(
    entry[0] for kind in _words_of("VERBKIND") for entry, _ in ENTRIES[kind] if len(entry) == 1
) - (_words_of("BOUND") | _NAMES)
#: What a word must not be like.
_NEAR: Final = (_BOUND - _VERBS) | _NAMES
#: Words of a wish, with which what is not known may be what is wished for.
_WISHING: Final = frozenset({
    "want", "wants", "need", "needs", "like", "make", "makes", "get", "gets", "try", "show", "see",
    "finish", "start", "begin",
})  # fmt: skip
_IN_REASONS: Final = _words_of("REASONED") | _VERBS
_CAUSES: Final = frozenset({"because", "since", "cause", "cuz", "coz", "cos"})
_WHY: Final = _words_of("WHY")
_IN_STORIES: Final = _words_of("STORY") | _words_of("REASONED")
_TELLERS: Final = frozenset({"the", "my", "our", "i", "we", "it", "he", "she", "they", "there"})


@lru_cache(maxsize=4096)
def is_bound(word: str) -> bool:
    """Whether a word may change what is meant, or be one that does, with a slip."""
    if len(word) == 1 and word not in "aidms":
        return True  # "R/Y/G in one stack"
    if word in _BOUND or not word.replace("'", "").replace("-", "").isalpha():
        return True
    if word in _KNOWN:
        return False
    if word.startswith(_DENYING):
        return True
    if "-" in word:
        return any(map(is_bound, word.split("-")))
    limit = 0 if len(word) < 4 else 1 if len(word) < 7 else 2
    near = any(
        edits(word, name) <= limit if len(name) > 3 else sorted(word) == sorted(name)
        for name in _NEAR
    )
    return near or bool(mended(word, _NAMES))


def stretches(words: Sequence[str], start: int) -> Iterator[tuple[int, float]]:
    """Where a stretch may end that begins at a word, and what it costs to skip it."""
    if words[start] in _SIGNS:
        return
    apart = start == 0 or words[start - 1] in _SIGNS
    ends = [*_opened(words, start)]
    if apart:
        ends += [*_clause(words, start), *_cares(words, start), *_wishes(words, start)]
        ends += [*_remark(words, start)]
        if start == 0 or words[start - 1] == ".":
            ends += [*_time(words, start), *_heading(words, start)]
        if start == 0:
            ends += [*_takes_back(words), *_story(words)]
    elif words[start] in _CARELESS or tuple(words[start : start + 2]) == ("no", "matter"):
        ends += _cares(words, start)
    for end in sorted(set(ends)):
        if 0 < end - start <= _LONGEST and end - start < len(words):
            yield end, _COST + _WORD * (end - start)


def _end(words: Sequence[str], start: int) -> int:
    """Where the next sign is."""
    return next((at for at in range(start, len(words)) if words[at] in _SIGNS), len(words))


def _clause(words: Sequence[str], start: int) -> Iterator[int]:
    """A clause of free words, at an end of a sentence: "yellow, broken, on red" tells which."""
    end = _end(words, start)
    if start and end < len(words) and words[end] != ".":
        return
    said = [word for word in words[start:end] if start or word not in _UNSAID]
    strange = any(word not in _KNOWN for word in said)
    if said and not any(map(is_bound, said)) and not (strange and _WISHING & set(said)):
        yield from _with_sign(words, start, end)


def _remark(words: Sequence[str], start: int) -> Iterator[int]:
    """A clause of words of every day, at an end of a sentence: "the baby crawls over there".

    A word that is not listed might take back what was said: "the boss cancelled this".
    """
    end = start
    while end < len(words) and words[end] != ".":
        if words[end] in ",:-" and (start == 0 or words[end] != ","):
            break  # in front of all, a goal may follow
        end += 1
    if start and end < len(words) and words[end] != ".":
        return
    said = [word for word in words[start:end] if word != ","]
    telling = [word for word in said if word not in _REMARK | _FREE]
    if not telling or not EVERYDAY.issuperset(telling):
        return
    yield from _with_sign(words, start, end)


def _time(words: Sequence[str], start: int) -> Iterator[int]:
    """A time in front of all: "by lunch", "upon completion,", "when the inspector comes,"."""
    if not any(tuple(words[start : start + len(entry)]) == entry for entry in SKIPPED["FRONT"]):
        return
    told = False
    for at in range(start + 1, len(words)):
        if words[at] == ",":
            if told:
                yield at + 1
            return
        if told and words[at] == "the":
            yield at
        if words[at] in _SIGNS or words[at] not in EVERYDAY | _FREE | {"'s"}:
            return
        told |= words[at] in EVERYDAY


def _heading(words: Sequence[str], start: int) -> Iterator[int]:
    """What stands in front of a colon: "acceptance criterion:"."""
    end = _end(words, start)
    if end == len(words) or words[end] != ":" or end - start > 4:
        return
    named = [word for word in words[start:end] if word in _LABELS]
    if named and all(word in named or word in EVERYDAY | _FREE for word in words[start:end]):
        yield end + 1


def _story(words: Sequence[str]) -> Iterator[int]:
    """Why something is wished, in front of all: "it gets unloaded first, so red on blue"."""
    for at, word in enumerate(words):
        if at > 1 and word == "so" and words[0] in _TELLERS:
            yield at
        if word in _SIGNS - {","} or (word not in _IN_STORIES and word != "," and is_bound(word)):
            return


def _with_sign(words: Sequence[str], start: int, end: int) -> Iterator[int]:
    """The sign behind may belong to it."""
    yield end
    if end < len(words) and (start == 0 or words[end] in ":-"):
        yield end + 1


def _opened(words: Sequence[str], start: int) -> Iterator[int]:
    """A clause of purpose, time or reason, or a likeness, up to the next sign."""
    for kind, more in (("OPENER", _VERBS), ("REASON", _IN_REASONS)):
        for entry in SKIPPED[kind]:
            behind = start + len(entry)
            if tuple(words[start:behind]) != entry:
                continue
            end = _end(words, behind)
            allowed = more if entry != ("for",) else frozenset[str]()
            if kind == "REASON" and entry != ("to",):
                allowed = allowed | _WHY
            if entry[0] in _CAUSES:
                behind = _named(words, behind)
            if end > behind and all(
                word in allowed or not is_bound(word) for word in words[behind:end]
            ):
                yield from _with_sign(words, start, end)


def _named(words: Sequence[str], start: int) -> int:
    """Behind the block that a reason is told of: "because the red one is fragile"."""
    at = start + (words[start : start + 1] == ["the"])
    if at < len(words) and words[at] in HUES:
        at += 1
        at += at < len(words) and words[at] in NOUNS | {"one", *SHAPES}
        if words[at : at + 1] and words[at] in ("is", "'s", "has"):
            return at
    return start


def _cares(words: Sequence[str], start: int) -> Iterator[int]:
    """What is said not to matter: "idc where exactly", "of whatever colour"."""
    end = _end(words, start)
    said = frozenset(words[start:end])
    if said <= _CARE_WORDS | _CARE | _CARELESS | _CARE_DENIAL:
        denied = len([word for word in words[start:end] if word in _CARE_DENIAL]) == 1
        if (said & _CARE and denied) or (said & _CARELESS and not said & _CARE_DENIAL):
            yield from _with_sign(words, start, end)
    upright = {"on", "onto", "atop", "upon", "top", "next", "beside"} & set(words[:start])
    if said <= _NEED_NOT and "not" in said and said & _NEED_NOT_CORE and not upright and start:
        yield end


def _wishes(words: Sequence[str], start: int) -> Iterator[int]:
    """A wish up to the clause that it holds; no question, and nothing about how it is."""
    if words[start] in _ASKING or "?" in words:
        return
    core = good = modal = False
    for at in range(start, len(words)):
        word = words[at]
        core |= word in _WISHES
        good |= word in _GOOD
        modal |= word in _MODALS
        if word not in _WISH | _WISHES | _GOOD:
            return
        wished = (core or (good and modal)) and (word != "if" or words[at - 1] in _GOOD)
        if wished and word in _OPENS and at > start + 1:
            yield at + 1


def _takes_back(words: Sequence[str]) -> Iterator[int]:
    """ "no no, …" where nothing was said before."""
    end = _end(words, 0)
    if end < min(len(words), 5) and all(word in _STARTING for word in words[:end]):
        yield end + 1
