# SPDX-License-Identifier: Apache-2.0
"""docs/extending.md names files that exist, no more of them than promised; its code runs."""

from __future__ import annotations

import re
from pathlib import Path
from typing import Any

import pytest

from planner_node import ALGORITHMS
from scene_graph import PREDICATES

ROOT = Path(__file__).parents[3]
PAGE = (ROOT / "docs" / "extending.md").read_text()
#: Besides the new file.
MOST = 3

ROWS = [
    [cell.strip() for cell in line.strip("|").split("|")]
    for line in PAGE.splitlines()
    if line.startswith(("| a", "| places"))
][1:]


def paths(cell: str) -> list[str]:
    return re.findall(r"`([^`]+/[^`]+)`", cell)


def located(path: str) -> Path:
    package = path.partition("/")[0]
    return ROOT / (path if package == "examples" else f"ros_ws/src/{package}/{path}")


@pytest.mark.parametrize("row", ROWS, ids=[row[0] for row in ROWS])
def test_an_addition_touches_few_files_that_exist(row: list[str]) -> None:
    _, new, touched, shown = row
    assert 1 <= len(paths(touched)) <= MOST
    for path in paths(touched) + paths(shown):
        assert located(path).is_file(), path
    for path in paths(new):
        assert located(path).parent.is_dir(), path


def test_every_addition_that_was_asked_for_is_there() -> None:
    text = " ".join(row[0] for row in ROWS)
    for word in ("inside", "arm", "gripper", "no row", "camera", "solver", "collision", "grasp",
                 "search algorithm"):  # fmt: skip
        assert word in text


def test_the_code_of_the_page_runs() -> None:
    blocks = re.findall(r"```python\n(.*?)```", PAGE, re.DOTALL)
    assert len(blocks) >= 2
    names: dict[str, Any] = {}
    try:
        for block in blocks:
            exec(block, names)
    finally:
        PREDICATES.remove("level")
        ALGORITHMS.pop("depth_first", None)
