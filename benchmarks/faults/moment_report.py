# SPDX-License-Identifier: Apache-2.0
"""Rows and details of tasks that are disturbed at random moments, from their files."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from statistics import median
from typing import Any, Final

from results_file import Row, wilson_interval

from faults.fault import GOOD, Ending
from faults.random_moment import KINDS, NOTHING, SEEN

Record = Mapping[str, Any]

_GOOD: Final = {ending.value for ending in GOOD}
_BASE: Final = "end"
#: What can be seen twice, understood and told takes up to this long [s].
LEAD: Final = 1.0


def is_good(record: Record) -> bool:
    """Whether the goal was reached, or refused by a sentence that names what happened."""
    return record["ending"] in _GOOD and record["named"]


def was_felt(record: Record) -> bool:
    """Whether what happened made a difference: to blocks on the table, or to the task."""
    return record["happened"] and (record["effect"] or record["replans"] > 0 or bool(
        record["ending"] != Ending.REACHED.value))  # fmt: skip


def command_of(record: Record) -> str:
    """The one command that runs a task again."""
    return (
        f"make eval-disturbances KIND={record['kind']} VERIFY={record['verify']} "
        f"SEED={record['seed']}"
    )


def make_rows(records: Sequence[Record]) -> list[Row]:
    """The published rows: for each way to verify, those of disturbed tasks; then the others."""
    rows: list[Row] = []
    for verify in dict.fromkeys(record["verify"] for record in records):
        mine = [item for item in records if item["verify"] == verify and item["kind"] != NOTHING]
        happened = [item for item in mine if item["happened"]]
        if happened:
            rows += _disturbed_rows(happened, verify)
    return rows + _undisturbed_rows(records)


def _disturbed_rows(records: Sequence[Record], verify: str) -> list[Row]:
    good, n = sum(map(is_good, records)), len(records)
    false = sum(item["ending"] == Ending.FALSE_SUCCESS.value for item in records)
    reached = sum(item["ending"] == Ending.REACHED.value for item in records)
    name = f"disturbed at a random moment, verify {verify}"
    watched = verify == "watch"
    rows = [
        Row(name, "goal reached, or refused naming what happened", good / n, "", n,
            wilson_interval(good, n), ">= 1", note=f"{reached} reached; 95% Wilson interval"),
        Row(name, "false success", false, "", n, required="<= 0"),
    ]  # fmt: skip
    rows += _noticing_rows(name, records, ">= 0.95" if watched else None)
    for kind in KINDS:
        alike = [item for item in records if item["kind"] == kind]
        if alike:
            right = sum(map(is_good, alike))
            rows.append(
                Row(f"{kind}, verify {verify}", "goal reached, or refused naming what happened",
                    right / len(alike), "", len(alike), wilson_interval(right, len(alike)))
            )  # fmt: skip
            rows += _noticing_rows(f"{kind}, verify {verify}", alike, None)
    return rows


def _noticing_rows(name: str, records: Sequence[Record], required: str | None) -> list[Row]:
    felt = [item for item in records if was_felt(item) and item["in_time"] is not None]
    if not felt:
        return []
    in_time = sum(item["in_time"] for item in felt)
    any_felt = [item for item in records if was_felt(item) and item["in_time_of_any"] is not None]
    of_any = sum(item["in_time_of_any"] for item in any_felt)
    rows = [
        Row(name, "noticed before the next grasp", in_time / len(felt), "", len(felt),
            wilson_interval(in_time, len(felt)), required,
            note="before a block was taken in a grasp that began after it; of those that moved a "
            "block on the table or made a difference to the task"),
        Row(name, "noticed before the next grasp, one whose fingers were closing included",
            of_any / len(any_felt), "", len(any_felt), wilson_interval(of_any, len(any_felt))),
    ]  # fmt: skip
    could = [item for item in felt if item["in_time"] or (item["until_grasp"] or 0.0) >= LEAD]
    missed = sum(not item["in_time"] for item in could)
    rows.append(
        Row(name, f"missed though {LEAD:g} s or more was left before the next grasp", missed, "",
            len(could), note="simulated time; the camera takes a picture every 0.1 s")
    )  # fmt: skip
    seen = [item["latency"] for item in felt if item["kind"] in SEEN and item["latency"]]
    if seen:
        rows.append(
            Row(name, "until it was noticed, median", median(seen), "s", len(seen),
                (min(seen), max(seen)), note="simulated time; what a camera sees")
        )  # fmt: skip
    return rows


def _undisturbed_rows(records: Sequence[Record]) -> list[Row]:
    """Tasks that nobody disturbs, of which each seed was run in each way to verify."""
    by_way: dict[str, dict[int, Record]] = {}
    for record in records:
        if record["kind"] == NOTHING:
            by_way.setdefault(record["verify"], {})[record["seed"]] = record
    rows = []
    base = by_way.get(_BASE, {})
    for verify, mine in by_way.items():
        seeds = sorted(mine.keys() & base.keys()) if base else sorted(mine)
        if not seeds:
            continue
        others = [base[seed] for seed in seeds] if base else []
        rows += _quiet_rows(verify, [mine[seed] for seed in seeds], others)
    return rows


def _quiet_rows(verify: str, records: Sequence[Record], base: Sequence[Record]) -> list[Row]:
    n, name = len(records), f"undisturbed, verify {verify}"
    compare = bool(base) and verify == "watch"
    reached = sum(item["ending"] == Ending.REACHED.value for item in records)
    lost, bound = _lost(records), f"<= {_lost(base)}" if compare else None
    seconds = [item["simulated_seconds"] for item in records]
    rows = [
        Row(name, "goal reached", reached / n, "", n, wilson_interval(reached, n)),
        Row(name, "grasps lost or blocks knocked: tasks that planned anew", lost, "", n,
            required=bound, note="not more than with verify end" if compare else None),
        Row(name, "motions stopped", sum(item["stops"] for item in records), "", n),
        Row(name, "time of a task, median", median(seconds), "s", n, (min(seconds), max(seconds)),
            note="simulated, from the request to the answer"),
    ]  # fmt: skip
    if base and verify != _BASE:
        ratio = sum(seconds) / sum(item["simulated_seconds"] for item in base)
        rows.append(
            Row(name, "time of all tasks over that with verify end", ratio, "", n,
                required="<= 1.05" if compare else None, note="the same tasks, in turns")
        )  # fmt: skip
    return rows


def _lost(records: Sequence[Record]) -> int:
    return sum(item["grasps_lost"] > 0 or item["replans"] > 0 for item in records)


def details(records: Sequence[Record]) -> dict[str, Any]:
    """What the result file keeps of single tasks: those that are not good, or noticed late."""
    odd = [
        item for item in records
        if not (is_good(item) or (item["kind"] == NOTHING and item["ending"] in _GOOD))
    ]  # fmt: skip
    late = [item for item in records if was_felt(item) and item["in_time"] is False]
    return {
        "not_as_wanted": [_brief(item) for item in odd],
        "noticed_late": [_brief(item) for item in late],
        "did_not_come_about": sum(not r["happened"] for r in records if r["kind"] != NOTHING),
    }


def _brief(record: Record) -> dict[str, Any]:
    keys = ("kind", "verify", "seed", "ending", "step", "blocks", "latency", "status", "message")
    return {**{key: record[key] for key in keys}, "again": command_of(record)}
