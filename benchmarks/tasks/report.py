# SPDX-License-Identifier: Apache-2.0
"""Rows and details of a campaign, from the records of its tasks."""

from __future__ import annotations

from collections import Counter
from collections.abc import Mapping, Sequence
from statistics import median
from typing import Any, Final

from results_file import Row, wilson_interval

from tasks.failures import Result, failure_table, reason_of
from tasks.family import Family

TIMINGS: Final = ("perceive", "plan", "motion", "execute", "total")
#: From so many moves on a plan is one of the regime that the thesis reports.
LONG: Final = 6
CONFIDENT: Final = "CONFIDENT"


def progress_text(successes: int, n: int) -> str:
    """The running share of successes with its interval, for a progress bar."""
    if not n:
        return "none has ended"
    low, high = wilson_interval(successes, n)
    return f"{successes}/{n} succeeded, {successes / n:.0%} [{low:.3f}, {high:.3f}]"


def command_of(family: Family, seed: int, real_time_factor: float) -> str:
    """The one command that runs a task again."""
    return f"make eval-tasks FAMILY={family.name} SEED={seed} RTF={real_time_factor:g}"


def make_rows(results: Sequence[Result], family: Family, jobs: int = 1) -> list[Row]:
    """The published rows.

    Args:
        results: of all tasks, those that were interrupted too: they have no times.
        jobs: graphs that ran side by side; a bound on wall time holds for one.
    """
    done = [result for result in results if "timing_s" in result]
    rows = _success_rows(results, family)
    long = [result for result in done if result["moves_planned"] >= LONG]
    if long and family.blocks[0] >= LONG - 1:
        good = sum(result["success"] for result in long)
        rows.append(
            Row(
                f"{_short(family)}, plans of {LONG} and more moves",
                "success rate",
                good / len(long),
                "",
                len(long),
                wilson_interval(good, len(long)),
                note="the regime that the thesis reports as solved, without a rate (5.3.2)",
            )
        )
    if not done:
        return rows
    moves = [result["moves_planned"] for result in done]
    replans = [result["replans"] for result in done]
    rows += [
        Row(family.what, "moves planned", median(moves), "", len(done), _extremes(moves)),
        Row(family.what, "replans a task", sum(replans) / len(done), "", len(done),
            _extremes(replans)),
        *_frame_rows(done, family),
        *_time_rows(done, family, jobs),
    ]  # fmt: skip
    seconds = [result["timing_s"]["motion"] for result in long if not result["replans"]]
    if seconds and not family.has_own_scenes:
        rows.append(
            Row(
                f"{_short(family)}, plans of {LONG} and more moves",
                "motion optimisation, median",
                median(seconds),
                "s",
                len(seconds),
                _extremes(seconds),
                required="<= 1.5",
                note="asked for plans of 6 moves; longer ones are harder",
            )
        )
    return rows


def _success_rows(results: Sequence[Result], family: Family) -> list[Row]:
    n = len(results)
    successes = sum(result["success"] for result in results)
    interval = wilson_interval(successes, n)
    stopped = sum(result.get("state") == "interrupted" for result in results)
    note = "judged by the simulator's ground truth; 95% Wilson interval"
    if stopped:
        note += f"; {stopped} interrupted by the operator count as failed"
    rows = [
        Row(family.what, "success rate", successes / n, "", n, interval,
            required=None if family.success is None else f">= {family.success:g}", note=note)
    ]  # fmt: skip
    if family.low is not None:
        rows.append(
            Row(family.what, "success rate, lower end of the interval", interval[0], "", n,
                required=f">= {family.low:g}")
        )  # fmt: skip
    return rows


def _frame_rows(done: Sequence[Result], family: Family) -> list[Row]:
    """Image to graph over all frames, and how many of them were not confident."""
    confident = [seconds for result in done for seconds in result["graph_seconds"]]
    others: Counter[str] = Counter()
    frames = list(confident)
    for result in done:
        for status, seconds in result.get("other_graph_seconds", {}).items():
            others[status] += len(seconds)
            frames += seconds
    if not frames:
        return []
    kinds = ", ".join(f"{count} {status}" for status, count in others.most_common())
    return [
        Row(family.what, "image to graph, median over all frames", 1e3 * median(frames), "ms",
            len(frames), _extremes([1e3 * seconds for seconds in frames]), required="<= 100",
            note=f"{len(confident)} {CONFIDENT}" + (f", {kinds}" if kinds else "")),
        *([Row(family.what, "image to graph, median over confident frames",
               1e3 * median(confident), "ms", len(confident),
               _extremes([1e3 * seconds for seconds in confident]))] if confident else []),
        Row(family.what, "share of frames with a confident graph", len(confident) / len(frames),
            "", len(frames)),
    ]  # fmt: skip


def _time_rows(done: Sequence[Result], family: Family, jobs: int) -> list[Row]:
    rows = []
    for timing in TIMINGS:
        values = [result["timing_s"][timing] for result in done]
        bounded = timing == "plan" and family.blocks == (6, 6) and not family.has_own_scenes
        note = "wall time, from the request to its answer" if timing == "total" else None
        rows.append(
            Row(family.what, f"{timing}, median", median(values), "s", len(done),
                _extremes(values), required="<= 0.5" if bounded else None, note=note)
        )  # fmt: skip
    timed = [result for result in done if "wall_seconds" in result]
    if not timed:
        return rows
    wall = [result["wall_seconds"] for result in timed]
    simulated = [result["simulated_seconds"] for result in timed]
    factors = [result["real_time_factor"] for result in timed]
    bound = f"<= {family.seconds:g}" if family.seconds is not None and jobs == 1 else None
    side_by_side = f"; {jobs} graphs side by side" if jobs > 1 else ""
    note = "from the reset of the scene to the judgement" + side_by_side
    rows += [
        Row(family.what, "wall time of a task, median", median(wall), "s", len(timed),
            _extremes(wall), required=bound, note=note),
        Row(family.what, "simulated time of a task, median", median(simulated), "s", len(timed),
            _extremes(simulated)),
        Row(family.what, "real-time factor reached, median", median(factors), "", len(timed),
            _extremes(factors), note=f"simulated over wall time of a task{side_by_side}"),
    ]  # fmt: skip
    return rows


def make_details(
    results: Sequence[Result], family: Family, real_time_factor: float
) -> dict[str, Any]:
    """What the result file keeps of single tasks."""
    failures = [result for result in results if not result["success"]]
    commands = {
        result["seed"]: command_of(family, result["seed"], real_time_factor) for result in failures
    }
    modules = Counter(reason_of(result)[0] for result in failures)
    table = failure_table(results, commands)
    commits = sorted({result["commit"] for result in results if "commit" in result})
    return {
        "failures_by_module": dict(modules),
        "failures": [
            {"seed": result["seed"], **(result["failure"] or {}), "again": commands[result["seed"]]}
            for result in failures
        ],
        **({"failure_table": table} if table else {}),
        **({"commits": commits} if len(commits) > 1 else {}),
        "tasks": [_short_record(result) for result in results if "timing_s" in result],
    }


def _short_record(result: Result) -> dict[str, Any]:
    keys = ("seed", "success", "moves_planned", "moves_executed", "replans", "timing_s",
            "wall_seconds", "simulated_seconds", "real_time_factor", "drawn")  # fmt: skip
    return {key: result[key] for key in keys if key in result}


def campaign_seconds(results: Sequence[Mapping[str, Any]], jobs: int, elapsed: float) -> float:
    """How long a campaign took, also if it was stopped and resumed [s]."""
    return max(elapsed, sum(result.get("wall_seconds", 0.0) for result in results) / jobs)


def _short(family: Family) -> str:
    return family.what.split(",")[0]


def _extremes(values: Sequence[float]) -> tuple[float, float]:
    return min(values), max(values)
