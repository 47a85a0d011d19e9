# SPDX-License-Identifier: Apache-2.0
"""Every error can be asked for by a parameter; what is impossible is refused with a sentence."""

from __future__ import annotations

import dataclasses
from typing import Any

import pytest

from sim_node import SensorConfig
from sim_node.sensor.parameters import SENSOR_PARAMETERS, sensor_from_parameters

SPECS = {spec.name.removeprefix("sensor."): spec for spec in SENSOR_PARAMETERS}
DEFAULTS = {spec.name: spec.default for spec in SENSOR_PARAMETERS}

REFUSED: list[tuple[str, Any, str]] = [
    ("seed", -1, "sensor.seed = -1 is below its minimum 0"),
    ("depth.noise", -0.001, "below its minimum 0.0"),
    ("depth.noise", float("nan"), "sensor.depth.noise = nan"),
    ("depth.noise", 1.0, "above its maximum 0.1"),
    ("depth.noise_correlation", 21.0, "above its maximum 20"),
    ("depth.edge_dropout", 1.1, "above its maximum 1.0"),
    ("depth.edge_width", 0, "below its minimum 1"),
    ("depth.edge_step", 0.0, "below its minimum 0.001"),
    ("depth.dropout", -0.1, "below its minimum 0.0"),
    ("depth.step", 0.2, "above its maximum 0.1"),
    ("depth.shift", [1.0], "has 1 numbers; it needs those to the right and down"),
    ("depth.shift", [1.0, 0.0, 0.0], "has 3 numbers"),
    ("depth.shift", [float("nan"), 0.0], "sensor.depth.shift = nan"),
    ("depth.shift", [0.0, -101.0], "below its minimum -100"),
    ("depth.shift", [float("inf"), 0.0], "above its maximum 100"),
    ("depth.no_depth", "-1", "sensor.depth.no_depth = '-1' is none of: zero, nan"),
    ("depth.encoding", "mono16", "'mono16' is none of: 32FC1, 16UC1"),
    ("color.noise", 101.0, "above its maximum 100.0"),
    ("color.exposure", -1.0, "below its minimum 0.0"),
    ("color.cast", [1.0, 1.0], "has 2 numbers; it needs those of red, green and blue"),
    ("color.cast", [], "has 0 numbers"),
    ("color.cast", [1.0, 1.0, -1.0], "below its minimum 0.0"),
    ("color.cast", [1.0, float("nan"), 1.0], "sensor.color.cast = nan"),
    ("color.blur", -0.5, "below its minimum 0.0"),
    ("color.blur", float("nan"), "sensor.color.blur = nan"),
    ("color.blur", 21.0, "above its maximum 20.0"),
    ("color.jpeg_quality", -1, "below its minimum 0"),
    ("color.jpeg_quality", 101, "sensor.color.jpeg_quality = 101 is above its maximum 100"),
    ("segmentation.kind", "blurred", "'blurred' is none of: exact, off, eroded, dilated"),
    ("segmentation.strength", -1, "below its minimum 0"),
    ("segmentation.strength", 101, "above its maximum 100"),
    ("delivery.lost_pictures", 2.0, "above its maximum 1.0"),
    ("delivery.lost_messages", float("inf"), "above its maximum 1.0"),
    ("delivery.delay", 6.0, "above its maximum 5.0"),
    ("delivery.jitter", -0.1, "below its minimum 0.0"),
    ("delivery.reliability", "mostly", "'mostly' is none of: reliable, best_effort"),
]


@pytest.mark.parametrize(("name", "value", "sentence"), REFUSED)
def test_what_is_impossible_is_refused_with_a_sentence(
    name: str, value: Any, sentence: str
) -> None:
    problem = SPECS[name].problem(value)
    assert sentence in problem
    assert f"sensor.{name}" in problem


def test_every_parameter_but_a_switch_refuses_something() -> None:
    switches = {name for name, spec in SPECS.items() if isinstance(spec.default, bool)}
    assert {name for name, _, _ in REFUSED} == SPECS.keys() - switches


def test_by_default_nothing_is_wrong() -> None:
    assert sensor_from_parameters(DEFAULTS) == SensorConfig()
    assert not any(spec.problem(spec.default) for spec in SENSOR_PARAMETERS)


def test_every_setting_is_reached_by_the_parameter_of_its_name() -> None:
    changed: dict[str, Any] = {
        "seed": 9,
        "depth.no_depth": "nan",
        "depth.encoding": "16UC1",
        "segmentation.kind": "split",
        "delivery.reliability": "best_effort",
        "color.cast": [1.0, 0.9, 0.8],
        "depth.shift": [1.5, -2.0],
    }
    for name, spec in SPECS.items():
        if isinstance(spec.default, bool):
            changed[name] = not spec.default
        elif isinstance(spec.default, int | float):
            changed.setdefault(name, spec.minimum if spec.minimum else spec.maximum)
    assert changed.keys() == SPECS.keys()
    config = sensor_from_parameters({f"sensor.{name}": value for name, value in changed.items()})
    for name, value in changed.items():
        group, _, field = name.rpartition(".")
        owner = getattr(config, group) if group else config
        if field == "reliability":
            field, value = "reliable", False
        assert getattr(owner, field) == (tuple(value) if isinstance(value, list) else value)
    groups = ("depth", "color", "segmentation", "delivery")
    fields = sum(len(dataclasses.fields(getattr(config, group))) for group in groups)
    assert fields + 1 == len(SPECS), "a setting without a parameter"
