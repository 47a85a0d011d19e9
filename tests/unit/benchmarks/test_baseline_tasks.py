# SPDX-License-Identifier: Apache-2.0
"""Two codes are compared on the tasks that both have run, by the ratio of their medians."""

from __future__ import annotations

from typing import Any

import pytest
from baseline_tasks import ratio_rows


def result(seed: int, motion: float, frames: list[float]) -> dict[str, Any]:
    return {
        "seed": seed,
        "graph_seconds": frames,
        "timing_s": {"plan": 0.01, "motion": motion},
    }


def test_ratios_are_of_medians_over_the_common_tasks() -> None:
    ours = [result(1000, 0.2, [0.02]), result(1001, 0.4, [0.04, 0.06]), result(1002, 9.0, [9.0])]
    theirs = [result(1000, 0.2, [0.05]), result(1001, 0.2, [0.02])]
    rows = {row.metric.split(",")[0]: row for row in ratio_rows(ours, theirs, "abc")}
    assert rows["image to confident graph"].value == pytest.approx(0.04 / 0.035)
    assert rows["image to confident graph"].holds is False
    assert rows["motion"].value == pytest.approx(0.3 / 0.2)
    assert rows["plan"].value == pytest.approx(1.0)
    assert rows["plan"].holds is True
