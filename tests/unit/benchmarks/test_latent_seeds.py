# SPDX-License-Identifier: Apache-2.0
"""Rows of several seeds as one each."""

from latent.seeds import together
from results_file import Row


def test_what_several_seeds_have_is_their_mean_and_what_one_has_stays() -> None:
    one = [Row("a", "x", 0.5, "", 10, note="first"), Row("b", "x", 0.25, "", 10)]
    joined, alone = together([one, [Row("a", "x", 0.7, "", 10)]])
    assert (joined.value, joined.spread) == (0.6, (0.5, 0.7))
    assert joined.note == "2 seeds: 0.5, 0.7; of the first: first"
    assert alone == one[1]
