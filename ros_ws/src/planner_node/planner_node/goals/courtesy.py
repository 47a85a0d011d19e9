# SPDX-License-Identifier: Apache-2.0
"""What people say around a goal: "I'd be grateful if …", "… if you can", "good morning".

Only words that are known are left out; whoever adds one takes care that it never changes a goal.
"""

from __future__ import annotations

from collections.abc import Sequence
from typing import Final

from .language import POLITE, TAKES, VERBS
from .terms import Words

#: May stand in front of "that" or "if" where these say only that a goal follows.
_FRAME: Final = POLITE | {
    "i", "we", "you", "it", "would", "could", "should", "may", "might", "must", "can", "will",
    "is", "be", "am", "are", "was", "make", "makes", "made", "see", "ensure", "check", "confirm",
    "verify", "like", "love", "prefer", "want", "wish", "need", "think", "guess", "hope",
    "suppose", "appreciate", "grateful", "glad", "happy", "pleased", "delighted", "nice", "great",
    "lovely", "cool", "perfect", "wonderful", "fine", "kind", "enough", "possible", "important",
    "necessary", "essential", "required", "most", "very", "really", "much", "also", "just",
    "then", "to", "do", "me", "us", "my", "ask", "trouble", "mind", "bother", "too", "certain",
    "such", "as", "by", "this", "that", "if", "out", "and", "arrange", "suggest", "request",
    "permission", "with", "your", "rather", "sorry", "please", "wonder", "wondering", "asking",
}  # fmt: skip
#: In front of "if", they make a wish of it; without them it asks, or is a condition.
_WISHES: Final = frozenset({
    "like", "love", "prefer", "appreciate", "grateful", "glad", "happy", "pleased", "delighted",
    "nice", "great", "lovely", "cool", "perfect", "wonderful", "good", "best", "kind", "obliged",
    "appreciated",
})  # fmt: skip
#: May follow "if" where it is no condition: "if you can", "if it is not too much trouble".
_IF: Final = frozenset({
    "you", "can", "could", "would", "will", "please", "possible", "it", "is", "not", "too", "much",
    "trouble", "do", "mind", "may", "might", "so", "like", "kind", "be", "ok", "okay", "at", "all",
    "that", "convenient", "bother", "we", "i", "ask", "have", "time", "moment", "a", "as", "to",
    "wish", "want", "good", "enough", "no", "the", "was", "were",
})  # fmt: skip


def without_courtesy(words: Sequence[Words]) -> list[Words]:
    """A part of a goal without what only says that it follows, or that it is a wish."""
    kept = _without_if(list(words))
    texts = [item.text for item in kept]
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
    if all(text in POLITE for text in texts):
        return True
    spoken = (POLITE | {"you", "i", "we", "that", "would", "is"}) & set(texts)
    return bool(spoken) and all(text in _FRAME for text in texts)
