# SPDX-License-Identifier: Apache-2.0
"""Results of single cases, each in a file of its own: a run that was stopped can be taken up."""

from __future__ import annotations

import json
from collections.abc import Callable
from pathlib import Path
from typing import Any, Final

#: Of all benchmarks; git ignores it.
RUNS: Final = Path(__file__).parent.parent / "runs"


def kept(folder: str, seed: int, resume: bool, measure: Callable[[int], dict[str, Any]]) -> Any:
    """What ``measure`` says of a seed, as JSON keeps it; its file says so if it may be used.

    Args:
        folder: of the cases, in ``runs``.
    """
    path = RUNS / folder / f"{seed}.json"
    if not resume or not path.exists():
        path.parent.mkdir(parents=True, exist_ok=True)
        path.write_text(json.dumps(measure(seed), indent=1))
    return json.loads(path.read_text())
