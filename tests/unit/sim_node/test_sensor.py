# SPDX-License-Identifier: Apache-2.0
"""By default a picture stays what it is; errors are the same whenever the numbers are."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from sensor_frames import table

from sim_node import (
    ColorConfig,
    DeliveryConfig,
    DepthConfig,
    Frame,
    SegmentationConfig,
    SensorConfig,
    sense,
)
from sim_node.sensor.segmentation import ERRORS, KINDS

ALL = SensorConfig(
    depth=DepthConfig(
        noise=0.002, noise_correlation=1.0, edge_dropout=0.3, dropout=0.01, shift=(1.0, 0.0)
    ),
    color=ColorConfig(noise=4.0, blur=0.8, jpeg_quality=90),
    segmentation=SegmentationConfig("boundary", 2),
)


def same(first: Frame, second: Frame) -> tuple[bool, bool, bool]:
    """Whether colours, depths and labels are equal."""
    return (
        np.array_equal(first.rgb, second.rgb),
        np.array_equal(first.depth, second.depth, equal_nan=True),
        np.array_equal(first.labels, second.labels),
    )


@pytest.mark.parametrize(
    "config",
    [
        SensorConfig(),
        SensorConfig(seed=7),
        SensorConfig(depth=DepthConfig(encoding="16UC1", edge_width=5, noise_correlation=2.0)),
        SensorConfig(segmentation=SegmentationConfig("exact", 9)),
        SensorConfig(segmentation=SegmentationConfig("off")),
        SensorConfig(delivery=DeliveryConfig(delay=1.0, lost_pictures=0.5, reliable=False)),
        *(SensorConfig(segmentation=SegmentationConfig(kind, 0)) for kind in ERRORS),
    ],
)
def test_without_errors_it_is_the_very_same_picture(config: SensorConfig) -> None:
    frame = table()
    assert config.is_exact
    assert sense(frame, config) is frame


def test_the_same_numbers_give_the_same_picture_and_others_another() -> None:
    frame = table()
    first = sense(frame, ALL, (3, 0, 11))
    assert same(first, sense(frame, ALL, (3, 0, 11))) == (True, True, True)
    for other in [(4, 0, 11), (3, 1, 11), (3, 0, 12)]:
        assert same(first, sense(frame, ALL, other)) == (False, False, False)
    reseeded = sense(frame, replace(ALL, seed=1), (3, 0, 11))
    assert same(first, reseeded) == (False, False, False)


@pytest.mark.parametrize("kind", KINDS)
def test_every_kind_of_labels_is_the_same_for_the_same_numbers(kind: str) -> None:
    frame, config = table(), SensorConfig(segmentation=SegmentationConfig(kind, 2))
    exact = frame.labels.copy()
    first, second = (sense(frame, config, (3, 0, 11)) for _ in range(2))
    assert (first.labels == second.labels).all()
    assert first.labels.dtype == np.uint16
    assert (frame.labels == exact).all(), "the exact picture was written to"
    assert (first.labels == exact).all() == config.is_exact


def test_one_stage_draws_the_same_whether_others_are_on_or_off() -> None:
    frame = table()
    together = sense(frame, ALL)
    alone = [
        sense(frame, replace(SensorConfig(), **{name: getattr(ALL, name)}))
        for name in ("color", "depth", "segmentation")
    ]
    assert [same(together, one) for one in alone] == [
        (True, False, False),
        (False, True, False),
        (False, False, True),
    ]
