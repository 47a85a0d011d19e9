# SPDX-License-Identifier: Apache-2.0
"""Goals as thirty very different people say them: read as they are meant, or asked back."""

from __future__ import annotations

from pathlib import Path
from typing import Final

import pytest
from told_meanings import Sentence, told_in

SAID: Final = tuple(told_in(Path(__file__).with_name("sentences_of_thirty.txt")))


@pytest.fixture(scope="module")
def outcomes() -> dict[Sentence, tuple[str, str]]:
    return {sentence: sentence.outcome() for sentence in SAID}


def test_none_is_read_wrong(outcomes: dict[Sentence, tuple[str, str]]) -> None:
    assert not {said.text: told for said, (found, told) in outcomes.items() if found == "wrong"}


def test_nine_of_ten_that_mean_something_are_read(
    outcomes: dict[Sentence, tuple[str, str]],
) -> None:
    meaning = [said for said in SAID if said.meaning != "?"]
    asked = [said.text for said in meaning if outcomes[said][0] != "right"]
    assert len(asked) <= 0.1 * len(meaning), asked
