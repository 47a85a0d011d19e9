# SPDX-License-Identifier: Apache-2.0
"""Sentences that were written by hand and have been looked at since: none may be read wrong.

Five hundred that were held out until the reader was measured with them, and then used to improve
it. The benchmark has a hundred others.
"""

from __future__ import annotations

from collections import Counter
from pathlib import Path

import goal_sentences
import pytest
from goal_sentences import Sentence, by_hand, generated, holds, outcome

SEEN = by_hand(Path(__file__).with_name("seen_sentences.json"))
#: Written to develop the reader with, in the manner of many people, and harder on purpose.
DEVELOPED = by_hand(Path(__file__).with_name("developed_sentences.json"))


def test_none_is_read_wrong_and_few_are_asked_back() -> None:
    found = {sentence.text: outcome(sentence)[0] for sentence in SEEN}
    assert [text for text, result in found.items() if result == "wrong"] == []
    assert Counter(found.values())["asked back"] <= 0.04 * len(found)


def test_of_hard_sentences_none_is_read_wrong_either() -> None:
    found = {sentence.text: outcome(sentence)[0] for sentence in DEVELOPED}
    assert [text for text, result in found.items() if result == "wrong"] == []
    assert Counter(found.values())["asked back"] <= 0.15 * len(found)


def test_what_a_generator_writes_is_read_right() -> None:
    assert {outcome(sentence)[0] for sentence in generated(100)} == {"right"}


@pytest.mark.parametrize(
    ("text", "meaning", "expected"),
    [
        ("red on blue", [{"rel": ["red_box", "on", "blue_box"]}], "right"),
        ("red on blue", [{"rel": ["red_box", "above", "blue_box"]}], "wrong"),
        ("red on blue", None, "wrong"),
        ("red on red", None, "right"),
        ("red near blue", [{"rel": ["red_box", "beside", "blue_box"]}], "asked back"),
        ("red near blue", None, "right"),
    ],
)
def test_the_judge_tells_right_from_wrong(
    text: str, meaning: list[dict[str, object]] | None, expected: str
) -> None:
    scene = goal_sentences.SCENES["A"]
    assert outcome(Sentence(*scene, text, meaning))[0] == expected


def test_a_count_is_judged_by_its_bounds() -> None:
    count = {"least": 1, "most": 2, "subjects": ["a", "b", "c"], "predicate": "above",
             "object": "stack0"}  # fmt: skip
    stack = ("a", "b", "c")
    true = [holds([{"count": count}], (stack[:number], stack[number:])) for number in range(4)]
    assert true == [False, True, True, False]
