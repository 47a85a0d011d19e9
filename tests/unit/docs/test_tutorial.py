# SPDX-License-Identifier: Apache-2.0
"""The tutorial does what it says: its code blocks run, in order, and the goal is reached."""

import re
from pathlib import Path
from typing import Any

TUTORIAL = Path(__file__).parents[3] / "docs" / "tutorial.md"


def test_the_tutorial_s_code_runs_and_reaches_its_goal() -> None:
    blocks = re.findall(r"```python\n(.*?)```", TUTORIAL.read_text(), re.DOTALL)
    assert len(blocks) >= 5
    names: dict[str, Any] = {}
    for block in blocks:
        exec(block, names)
    assert names["goal"].holds(names["truth"].stacks())
    names["world"].close()
