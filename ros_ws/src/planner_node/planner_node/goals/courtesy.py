# SPDX-License-Identifier: Apache-2.0
"""What people say around a goal: "I'd be grateful if …", "… if you can", "good morning".

Only words that are known are left out; whoever adds one takes care that it never changes a goal.
"""

from __future__ import annotations

from collections.abc import Sequence
from typing import Final

from scene_graph import COLORS, PREDICATES, SHAPES

from .language import (
    BOTH,
    CLEAR,
    CORRECTION,
    EVERYONE,
    IT,
    MORE_COLORS,
    MUTE,
    NEGATION,
    NOUNS,
    NUMBERS,
    PLACE_NOUNS,
    PLURALS,
    POLITE,
    SIDES,
    SYNONYMS,
    TAKEN_BACK,
    TAKES,
    VERBS,
    meant,
)
from .terms import Words

#: May stand in front of "that" or "if" where these say only that a goal follows.
_FRAME: Final = POLITE | {
    "i", "we", "you", "it", "would", "could", "should", "may", "might", "must", "can", "will",
    "is", "be", "am", "are", "was", "make", "makes", "made", "see", "ensure", "check",
    "confirm", "verify", "like", "love", "prefer", "want", "wish", "need", "think", "guess",
    "hope", "suppose", "appreciate", "grateful", "glad", "happy", "pleased", "delighted",
    "nice", "great", "lovely", "cool", "perfect", "wonderful", "fine", "kind", "enough",
    "possible", "important", "necessary", "essential", "required", "most", "very", "really",
    "much", "also", "just", "then", "to", "do", "me", "us", "my", "ask", "trouble", "mind",
    "bother", "too", "certain", "such", "as", "by", "this", "that", "if", "out", "and",
    "arrange", "suggest", "request", "permission", "a", "an", "needful", "hereby", "requested",
    "with", "your", "rather", "sorry", "please", "wonder", "wondering", "asking",
}  # fmt: skip
#: In front of "if", they make a wish of it; without them it asks, or is a condition.
_WISHES: Final = frozenset({
    "like", "love", "prefer", "appreciate", "grateful", "glad", "happy", "pleased", "delighted",
    "nice", "great", "lovely", "cool", "perfect", "wonderful", "good", "best", "kind",
    "obliged", "appreciated",
})  # fmt: skip
#: May follow "if" where it is no condition: "if you can", "if it is not too much trouble".
_IF: Final = frozenset({
    "you", "can", "could", "would", "will", "please", "possible", "it", "is", "not", "too",
    "much", "trouble", "do", "mind", "may", "might", "so", "like", "kind", "be", "ok", "okay",
    "at", "all", "that", "convenient", "bother", "we", "i", "ask", "have", "time", "moment",
    "a", "as", "to", "wish", "want", "good", "enough", "no", "the", "was", "were",
})  # fmt: skip

#: Who talks, and to whom; what they say of themselves is no goal.
_PERSONS: Final = frozenset({
    "i", "me", "my", "we", "us", "our", "you", "your", "u", "he", "his", "she", "her", "who",
})  # fmt: skip
#: What a goal is about: a clause that has one of these is read, never left out.
_CONTENT: Final = frozenset().union(
    *PREDICATES.phrases, COLORS, MORE_COLORS, SHAPES, SYNONYMS, NOUNS, PLURALS, PLACE_NOUNS,
    SIDES, NUMBERS, CLEAR, TAKES, IT, BOTH, EVERYONE,
    {NEGATION, CORRECTION, TAKEN_BACK, "there", "here", "not-asked-for", "only", "others"},
) - {
    "of", "to", "over", "in", "at", "that", "this", "right", "one", "no", "get", "place",
}  # fmt: skip
_NAMES: Final = frozenset(COLORS) | frozenset(SHAPES)
#: They say more of the goal than that it follows, or the contrary.
_TELLING: Final = frozenset({
    "if", "unless", "when", "once", "until", "before", "while", "except", "without", "or",
    "hate", "dislike", "avoid", "prevent", "refuse", "forbid", "stop", "doubt", "deny", "undo",
    "cancel", "forget", "change", "changed", "mind", "opposite", "reverse", "swap", "exchange",
    "switch", "mirror", "turn", "flip", "rotate", "order", "way", "back", "instead", "wrong",
    "mistake", "joking", "kidding", "lied", "lying", "false", "ignore", "otherwise", "same",
    "different", "each-other", "neither", "nor", "afraid", "worried", "fear", "bad", "terrible",
    "pretend", "imagine", "anyone", "enough", "rather", "than", "last-one", "alone",
    "elsewhere", "apart",
})  # fmt: skip
#: What they ask for is the goal, so that a word behind them that nobody knows may be part of it.
_ASKING: Final = (VERBS | {
    "want", "wants", "need", "needs", "like", "love", "prefer", "wish", "should", "shall",
    "must", "would", "ask", "request", "suggest", "could",
}) - {"have", "let", "make"}  # fmt: skip
#: Begin the goal behind what is said of it.
_COMPLEMENTS: Final = frozenset({"that", "until"})
_SAYING: Final = frozenset({
    "say", "saying", "says", "said", "trying", "tried", "mean", "what", "insist", "insists",
    "propose", "proposes", "demand", "demands", "decided", "agreed", "idea", "point", "aim",
    "wants", "wish", "hoping", "asked", "asks", "hereby", "requested", "is", "it", "vote",
})  # fmt: skip
_MODALS: Final = frozenset({"should", "must", "shall", "needs", "be", "ought", "goes"})
_EVERYTHING: Final = frozenset({"blocks", "block", "things", "everything", "all", "around", "them"})


def is_talk(words: Sequence[Words]) -> bool:
    """Whether somebody says something of himself: "so I was thinking", "you did great".

    Such words name nothing that is on the table, relate nothing, and take nothing back; where they
    ask for something, every one of them is known.
    """
    texts = [item.text for item in words]
    if any(text in _CONTENT | _TELLING or _is_name(text) for text in texts):
        return False
    known = all(text in POLITE | MUTE | _FRAME | _PERSONS for text in texts)
    return bool(_PERSONS & set(texts)) and (known or not _ASKING & set(texts))


def _is_name(text: str) -> bool:
    """Whether it is a colour or a shape with a typo."""
    known = text in POLITE | MUTE | _FRAME | _PERSONS
    return not known and meant(text, _NAMES) is not None


def _without_frame(words: list[Words]) -> list[Words]:
    """Without "what I am trying to say is that", "all I want is for", "see whether you can"."""
    texts = [item.text for item in words]
    for at in range(len(words) - 2, -1, -1):
        # "all I want is …"
        said = [
            item for item, behind in zip(words[:at], texts[1:])
            if item.text != "all" or behind not in _PERSONS
        ]  # fmt: skip
        if not said and texts[at] != "whether":
            continue
        if texts[at] in _COMPLEMENTS and _is_of_all(texts, at):
            return words[at + 1 :]
        if texts[at] == "that" and is_talk(said):
            # What somebody says or wants is a goal; what he knows is one where it "should" be.
            spoken = all(item.text in _SAYING | _PERSONS | _FRAME | MUTE for item in said)
            if spoken or any(text in _MODALS for text in texts[at + 1 :]):
                return words[at + 1 :]
        able = texts[at + 1] in _PERSONS and texts[at + 2 : at + 3] in (["can"], ["could"])
        if texts[at] == "whether" and able and (not said or is_talk(said)):
            return words[at + 3 :]
        if texts[at] == "for" and said:
            # Of "for red to be" merging has left out the "to".
            verb = next((item for item in range(at + 2, len(texts)) if texts[item] in MUTE), at)
            named = any(_is_name(text) or text in _CONTENT for text in texts[at + 1 : verb])
            if named and (is_talk(said) or all(item.text in _FRAME for item in said)):
                return words[at + 1 :]
    return words


def _is_of_all(texts: Sequence[str], at: int) -> bool:
    """Whether "move things around" is in front of "until" or "so that"."""
    before = texts[:at] if texts[at] == "until" else texts[: at - 1]
    aimed = texts[at] == "until" or texts[at - 1 : at] == ["so"]
    moved = bool(before) and all(text in VERBS | _EVERYTHING for text in before)
    return moved and aimed and before[0] in VERBS


def without_courtesy(words: Sequence[Words]) -> list[Words]:
    """A part of a goal without what only says that it follows, or that it is a wish."""
    kept = _without_frame(_without_if(list(words)))
    texts = [item.text for item in kept]
    verb = next((at for at, text in enumerate(texts) if text in (VERBS | TAKES) - _FRAME), 0)
    if verb > 1 and texts[0] == "it" and all(text in _FRAME for text in texts[:verb]):
        return kept[verb:]  # "it is necessary to put red on blue"
    frame = next((at for at, text in enumerate(texts) if text not in _FRAME), len(texts))
    for at in range(min(frame, len(texts) - 1) - 1, 0, -1):
        wished = texts[at] == "if" and any(text in _WISHES for text in texts[:at])
        if wished or (texts[at] == "that" and "if" not in texts[:at]):
            return without_courtesy(kept[at + 1 :])
    return kept


def _without_if(words: list[Words]) -> list[Words]:
    """Without a condition that is none, in front or behind."""
    texts = [item.text for item in words]
    if "if" not in texts:
        return words
    start = texts.index("if")
    end = start + 1
    while end < len(texts) and texts[end] in _IF:
        end += 1
    if end == len(texts) and end > start + 1:
        return words[:start]
    if start == 0 and end > 1 and texts[end] in VERBS | TAKES:
        return words[end:]
    return words


def says_nothing(words: Sequence[Words]) -> bool:
    """Whether it is polite and nothing else: "thank you very much", "would you?"."""
    texts = [item.text for item in words]
    if all(text in POLITE for text in texts) or is_talk(words):
        return True
    spoken = (POLITE | {"you", "i", "we", "that", "would", "is"}) & set(texts)
    return bool(spoken) and all(text in _FRAME for text in texts)
