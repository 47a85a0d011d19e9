# SPDX-License-Identifier: Apache-2.0
"""A parameter's check refuses what its range excludes."""

import pytest
from tamp_runtime.parameters import ParameterSpec

SPEED = ParameterSpec("speed", 0.5, "share of the limit", minimum=0.0, maximum=1.0)
PLACES = ParameterSpec("places", [0.0, 1.0], "where", minimum=-1.0, maximum=1.0)


@pytest.mark.parametrize("value", [0.0, 0.5, 1.0, 1])
def test_a_value_in_range_is_fine(value: float) -> None:
    assert SPEED.problem(value) == ""


@pytest.mark.parametrize("value", [-0.1, 1.1, float("nan"), float("inf")])
def test_a_value_out_of_range_is_named_with_its_bound(value: float) -> None:
    assert "speed" in SPEED.problem(value)


def test_every_element_of_an_array_is_checked() -> None:
    assert PLACES.problem([0.0, 0.3]) == ""
    assert "-3.0" in PLACES.problem([0.0, -3.0])


def test_a_further_check_has_the_last_word() -> None:
    even = ParameterSpec("n", 2, "even", check=lambda n: "" if n % 2 == 0 else f"{n} is odd")
    assert even.problem(3) == "3 is odd"
    assert even.problem(4) == ""


def test_the_descriptor_says_the_range() -> None:
    descriptor = SPEED.descriptor()
    assert descriptor.floating_point_range[0].to_value == 1.0
    assert not descriptor.read_only
