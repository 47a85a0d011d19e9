# SPDX-License-Identifier: Apache-2.0
"""A file of obstacles that makes no sense keeps motion_node from starting, in one sentence."""

from __future__ import annotations

from pathlib import Path

import pytest
from ros2_run import Start, finish


@pytest.mark.parametrize(
    ("text", "words"),
    [
        (None, "cannot be read: No such file or directory"),
        ("obstacles: [{name: wall, size: [1, 2]}]", "obstacles[0].size = [1, 2] is not a list"),
    ],
)
def test_obstacles_that_make_no_sense_are_told(
    start: Start, tmp_path: Path, text: str | None, words: str
) -> None:
    path = tmp_path / "scene.yaml"
    if text is not None:
        path.write_text(text)
    code, _, stderr = finish(
        start("motion_node", "motion_node", "--ros-args", "-p", f"obstacles:={path}")
    )
    assert code == 2
    assert words in stderr.strip().splitlines()[-1]
