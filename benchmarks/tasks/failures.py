# SPDX-License-Identifier: Apache-2.0
"""The failure table: reason × parameter bin, with the number of tasks in each bin."""

from __future__ import annotations

import bisect
import re
from collections import Counter
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import Any, Final

from scene_graph import COLORS

#: A task's record, see :mod:`tasks.record`.
Result = Mapping[str, Any]

_LONGEST: Final = 110
_NAME: Final = re.compile(rf"\b(?:{'|'.join(sorted(COLORS))})_[a-z]+\b")
_BASE: Final = re.compile(r"\bstack\d+\b")
_PATH: Final = re.compile(r"(?<![\w/])(?:[\w.~-]+)?/[\w./~-]*\w")
_NUMBER: Final = re.compile(r"(?<![\w.])[-+]?\d+(?:\.\d+)?(?:e[-+]?\d+)?")
_SEVERAL: Final = re.compile(r"\b(BLOCK|PLACE|N)\b(?:(?:,| and|, and| or) \1\b)+")
_PARENTHESES: Final = re.compile(r" ?\([^()]*\)| ?\[[^\[\]]*\]")
#: Where the first statement of a message ends; what follows is advice, or a consequence.
_END: Final = re.compile(r"[;\n]|[.!?](?:\s|$)|: (?=\()")


@dataclass(frozen=True)
class Axis:
    """A parameter of tasks, and the bins that its values are put into.

    Attributes:
        name: key in a task's ``drawn``.
        edges: between the bins; empty: every value, a number or a word, is a bin of its own.
        unit: behind the numbers.
    """

    name: str
    edges: tuple[float, ...] = ()
    unit: str = ""

    def bins(self, values: Sequence[Any]) -> list[str]:
        """The bins of some values, in order; only those that have any value."""
        return list(dict.fromkeys(self.bin_of(value) for value in sorted(values)))

    def bin_of(self, value: Any) -> str:
        """The bin of a value; one on an edge is in the upper bin."""
        if isinstance(value, str):
            return value
        if not self.edges:
            return f"{value:g}{self.unit}"
        return self._name(bisect.bisect_right(self.edges, value))

    def _name(self, number: int) -> str:
        edges = self.edges
        if number == 0:
            return f"< {edges[0]:g}{self.unit}"
        if number == len(edges):
            return f"≥ {edges[-1]:g}{self.unit}"
        return f"{edges[number - 1]:g} to {edges[number]:g}{self.unit}"


AXES: Final = (
    Axis("places"),
    Axis("blocks"),
    Axis("smallest block", (3.5, 4.0), " cm"),
    Axis("camera angle", (-5.0, 5.0), "°"),
    Axis("farthest place", (0.5, 0.6), " m"),
    Axis("masks"),
    Axis("disturbance"),
    Axis("highest stack of the start", (4.0, 6.0)),
    Axis("highest stack of the goal", (4.0, 6.0)),
)


def sentence_class(sentence: str) -> str:
    """The first statement of a sentence, without what differs from task to task.

    ``"red_box leans by 12 degrees; look again"`` becomes ``"BLOCK leans by N degrees"``.
    """
    text = sentence.strip()
    text = _PATH.sub("PATH", text)
    while (without := _PARENTHESES.sub("", text)) != text:  # from the innermost ones on
        text = without
    text = _NAME.sub("BLOCK", text)
    text = _BASE.sub("PLACE", text)
    text = _NUMBER.sub("N", text)
    text = _SEVERAL.sub(r"\1, …", text)
    text = _END.split(text, maxsplit=1)[0].strip()
    return text if len(text) <= _LONGEST else f"{text[: _LONGEST - 1]}…"


def reason_of(result: Result) -> tuple[str, str]:
    """Module and sentence class of a task that failed."""
    failure = result["failure"] or {"module": "", "reason": "no reason was given"}
    return failure["module"] or "unknown", sentence_class(failure["reason"])


def failure_table(results: Sequence[Result], commands: Mapping[int, str]) -> dict[str, Any] | None:
    """Reason × parameter bin, the most frequent reason first; None if nothing failed.

    Args:
        results: of all tasks, those that succeeded too: they make n.
        commands: what runs a task again, by its seed.

    Returns:
        ``columns``: of each bin its axis, name and ``n``, the tasks in it; ``rows``: of each
        reason module, sentence, n, ``counts`` in the order of the columns, and the command that
        runs its first task again.
    """
    failed = [result for result in results if not result["success"]]
    if not failed:
        return None
    columns: list[dict[str, Any]] = []
    members: list[set[int]] = []
    for axis in AXES:
        values = {
            result["seed"]: result["drawn"][axis.name]
            for result in results
            if axis.name in result.get("drawn", {})
        }
        bins = axis.bins(list(values.values()))
        if len(bins) < 2:  # what is the same in all tasks explains nothing
            continue
        for name in bins:
            seeds = {seed for seed, value in values.items() if axis.bin_of(value) == name}
            columns.append({"axis": axis.name, "bin": name, "n": len(seeds)})
            members.append(seeds)
    reasons = {result["seed"]: reason_of(result) for result in failed}
    rows = []
    for (module, sentence), n in sorted(
        Counter(reasons.values()).items(), key=lambda item: (-item[1], item[0])
    ):
        seeds = {seed for seed, reason in reasons.items() if reason == (module, sentence)}
        rows.append(
            {
                "module": module,
                "sentence": sentence,
                "n": n,
                "counts": [len(seeds & others) for others in members],
                "again": commands[min(seeds)],
            }
        )
    return {"n": len(results), "columns": columns, "rows": rows}
