# SPDX-License-Identifier: Apache-2.0
"""Results of single cases, each in a file of its own: a run that was stopped can be taken up."""

from __future__ import annotations

import json
from collections.abc import Callable
from pathlib import Path
from typing import Any, Final

#: Of all benchmarks; git ignores it.
RUNS: Final = Path(__file__).parent.parent / "runs"


def kept(folder: str, case: str, resume: bool, measure: Callable[[], dict[str, Any]]) -> Any:
    """What ``measure`` says of a case, as JSON keeps it; its file says so if it may be used.

    Args:
        folder: of the benchmark, in ``runs``.
        case: the file's name without its end.
    """
    path = RUNS / folder / f"{case}.json"
    if not resume or not path.exists():
        path.parent.mkdir(parents=True, exist_ok=True)
        path.write_text(json.dumps(measure(), indent=1))
    return json.loads(path.read_text())
