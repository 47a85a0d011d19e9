# SPDX-License-Identifier: Apache-2.0
"""Pictures and the graphs made of them are counted and timed by when they were published."""

from __future__ import annotations

import pytest
from bench_perception import rows_of
from frame_watch import Frames

CONFIDENT, OCCLUDED = 1, 5
MS = 1_000_000


def of_a_task(lost: int, slow: int) -> Frames:
    """Pictures every 100 ms, of which the arm moves in the middle ones; graphs after 20 ms."""
    frames = Frames()
    for number in range(21):
        written = 100 * MS * number + 7
        frames.pictures[number] = written
        late = 90 if number == slow else 20
        if number != lost:
            frames.graphs[number] = (written + late * MS, CONFIDENT, 0.018)
    frames.moves += [(500 * MS, True), (1500 * MS, False)]
    return frames


def test_each_picture_has_its_own_graph() -> None:
    found = of_a_task(lost=8, slow=9).to_json()
    frames = found["frames"]
    assert len(frames) == 20, "whether the last one gets a graph is not known"
    assert [frame["moving"] for frame in frames] == [5 <= number < 15 for number in range(20)]
    assert frames[8]["status"] is None and frames[8]["seconds"] is None
    assert frames[9]["seconds"] == pytest.approx(0.09)
    assert found["moving_seconds"] == pytest.approx(1.0)


def test_a_graph_that_was_never_published_lowers_the_rate_and_not_the_time() -> None:
    task = {"success": True, "cpu_seconds": 0.38, **of_a_task(lost=8, slow=9).to_json()}
    rows = {row.metric: row for row in rows_of("256x256", 30.0, [task])}
    middle = rows["picture published to graph published, median over all frames"]
    assert middle.value == pytest.approx(20.0) and middle.n == 19 and middle.holds
    assert middle.spread == pytest.approx((20.0, 90.0))
    assert rows["graphs a second while the arm moves"].value == pytest.approx(9.0)
    assert not rows["graphs a second while the arm moves"].holds
    assert rows["pictures that became a graph while the arm moves"].value == pytest.approx(0.9)
    assert rows["perception_node, CPU time a graph"].value == pytest.approx(20.0)
