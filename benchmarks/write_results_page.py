# SPDX-License-Identifier: Apache-2.0
"""``make results``: docs/results.md, tables and plots, from the result files of the benchmarks."""

from __future__ import annotations

import json
import sys
from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import Any, Final

from replay.report import differences_table
from result_plots import plot_result
from results_file import RESULTS_FOLDER

PAGE: Final = Path(__file__).resolve().parent.parent / "docs" / "results.md"

_HEAD: Final = """\
<!-- Written by `make results` from benchmarks/results/*.json; nothing here is typed by hand. -->

# Results

Each section is one result file, with the command that regenerates it. *Required* is the bound that
the work was asked to hold, *thesis* the thesis' number for the same thing, *spread* an interval or
the extremes, *n* the number of cases behind a value."""

_VERDICTS: Final[Mapping[bool | None, str]] = {None: "", True: "yes", False: "**no**"}


class ResultFileError(ValueError):
    """A result file that cannot be published; ``path`` names it."""

    def __init__(self, path: Path, problem: str) -> None:
        super().__init__(f"{path}: {problem}")
        self.path = path


def load_results(folder: Path) -> list[dict[str, Any]]:
    """The contents of the result files, sorted by file name; quick runs are left out.

    Raises:
        ResultFileError: for a file that is no result, or a quick run under the name of a full one.
    """
    results = []
    for path in sorted(folder.glob("*.json")):
        if path.name.endswith(".quick.json"):
            continue
        try:
            result = json.loads(path.read_text())
        except ValueError as error:
            raise ResultFileError(path, f"is not JSON: {error}") from error
        missing = {"name", "command", "commit", "date", "machine", "rows"} - set(result)
        if missing:
            raise ResultFileError(path, f"lacks {', '.join(sorted(missing))}")
        if result.get("quick"):
            raise ResultFileError(path, "is a quick run; repeat it without QUICK=1")
        results.append(result)
    return results


def summary(results: Sequence[Mapping[str, Any]]) -> str:
    """How many of the required bounds hold, and which do not."""
    bounded = [
        (result["name"], row)
        for result in results
        for row in result["rows"]
        if row["holds"] is not None
    ]
    if not bounded:
        return "No required bound has been measured yet."
    short = [(name, row) for name, row in bounded if not row["holds"]]
    lines = [f"{len(bounded) - len(short)} of {len(bounded)} required bounds hold."]
    if short:
        lines += ["These do not:", ""]
        lines += [
            f"- {name}: {row['metric']} ({row['set']}) is {_number(row['value'])}{_unit(row)}, "
            f"required {row['required']}"
            for name, row in short
        ]
    return "\n".join(lines)


def table(rows: Sequence[Mapping[str, Any]]) -> list[str]:
    """A Markdown table of the rows of one file, in their order."""
    lines = [
        "| set | metric | value | unit | n | spread | required | holds | thesis | note |",
        "|---|---|---:|---|---:|---|---|---|---:|---|",
    ]
    for row in rows:
        spread = row.get("spread")
        thesis = row.get("thesis")
        cells = (
            row["set"],
            row["metric"],
            _number(row["value"]),
            row["unit"],
            str(row["n"]),
            f"{_number(spread[0])} to {_number(spread[1])}" if spread else "",
            row["required"] or "",
            _VERDICTS[row["holds"]],
            "" if thesis is None else _number(thesis),
            row.get("note") or "",
        )
        lines.append("| " + " | ".join(_cell(cell) for cell in cells) + " |")
    return lines


def section(result: Mapping[str, Any], plots: Sequence[str]) -> list[str]:
    """The section of one result file; ``plots`` are addresses relative to the page."""
    machine = result["machine"]
    origin = [
        f"commit {result['commit']}",
        result["date"],
        f"{machine['cpu']}, {machine['cores']} cores, {machine['memory_gib']} GiB",
    ]
    if "seconds" in result:
        origin.append(f"took {_duration(result['seconds'])}")
    lines = [
        f"## {result['name']}",
        "",
        f"`{result['command']}` · {' · '.join(origin)}",
        "",
        *table(result["rows"]),
    ]
    for plot in plots:
        lines += ["", f"![{result['name']}]({plot})"]
    details = result.get("details", {})
    for picture in details.get("pictures", []):
        lines += ["", picture["text"], "", f"![{picture['text']}]({picture['file']})"]
    if failures := details.get("failure_table"):
        lines += ["", *failure_table(failures)]
    if refused := details.get("refused"):
        lines += ["", *refusal_table(refused)]
    if numbered := details.get("numbered"):
        lines += ["", *numbered_table(numbered)]
    if entries := details.get("dictionary"):
        lines += ["", *dictionary_table(entries)]
    if differences := details.get("differences"):
        lines += ["", *differences_table(differences)]
    return lines


def failure_table(failures: Mapping[str, Any]) -> list[str]:
    """Reason × parameter bin: of how many tasks in a bin how many failed so."""
    columns, rows = failures["columns"], failures["rows"]
    failed = sum(row["n"] for row in rows)
    names = [f"{column['axis']} {column['bin']}" for column in columns]
    lines = [
        f"{failed} of {failures['n']} tasks failed. By reason (module and sentence, with N for a "
        "number and BLOCK for a name) and by what the task was like; the first line says how many "
        "tasks were like that.",
        "",
        "| " + " | ".join(_cell(name) for name in ("reason", "all", *names, "again")) + " |",
        "|---|" + "---:|" * (1 + len(names)) + "---|",
    ]
    lines.append(_counts_line("tasks", failures["n"], [column["n"] for column in columns], ""))
    for row in rows:
        reason = f"**{row['module']}**: {row['sentence']}"
        lines.append(_counts_line(reason, row["n"], row["counts"], f"`{row['again']}`"))
    return lines


def refusal_table(refused: Mapping[str, Mapping[str, int]]) -> list[str]:
    """Set × sentence: why graphs were refused, with N for a number and BLOCK for a name."""
    lines = [
        "<details><summary>What was said of graphs that were refused</summary>",
        "",
        "| set | n | status and sentence |",
        "|---|---:|---|",
    ]
    for name, sentences in refused.items():
        for sentence, count in sentences.items():
            cells = (name, str(count), _shortened(sentence))
            lines.append("| " + " | ".join(_cell(cell) for cell in cells) + " |")
    return [*lines, "", "</details>"]


def numbered_table(numbered: Sequence[Mapping[str, Any]]) -> list[str]:
    """The faults that trials by hand had found: what each was and is, and how many tests it has."""
    lines = [
        "Faults that trials by hand had found; the tests of each have `fault_NUMBER` in their "
        "names.",
        "",
        "| fault | was | is | trials here | tests |",
        "|---:|---|---|---|---:|",
    ]
    for item in numbered:
        cells = (item["number"], item["was"], item["now"], item["trials"], len(item["tests"]))
        lines.append("| " + " | ".join(_cell(str(cell)) for cell in cells) + " |")
    return lines


def dictionary_table(entries: Sequence[Mapping[str, Any]]) -> list[str]:
    """Fault × phase × outcome × sentence, folded; what a person sees when something goes wrong."""
    kinds = len({entry["fault"] for entry in entries})
    lines = [
        f"<details><summary>What becomes of a task: {kinds} kinds of faults by phase, and the "
        "sentence that the one who asks gets</summary>",
        "",
        "| fault | phase | outcome | n | status | sentence |",
        "|---|---|---|---:|---|---|",
    ]
    before = ""
    for entry in entries:
        fault = f"**{entry['fault']}**: {entry['what']}" if entry["fault"] != before else ""
        before = entry["fault"]
        first = "; ".join(entry["causes"])
        sentence = f"{entry['sentence']} (first cause: {first})" if first else entry["sentence"]
        again = f" `{entry['again']}`" if entry["again"] else ""
        bad = f"**{', '.join(entry['bad'])}** " if entry["bad"] else ""
        cells = (
            fault,
            entry["phase"],
            bad + entry["ending"],
            str(entry["n"]),
            entry["status"],
            _shortened(sentence) + again,
        )
        lines.append("| " + " | ".join(_cell(cell) for cell in cells) + " |")
    return [*lines, "", "</details>"]


def write_page(results_folder: Path, page: Path) -> None:
    """Writes the page, and its plots into a folder beside it that has the page's name.

    Raises:
        ResultFileError: see :func:`load_results`; nothing is written then.
    """
    results = load_results(results_folder)
    plot_folder = page.with_suffix("")
    page.parent.mkdir(parents=True, exist_ok=True)
    written: set[Path] = set()
    lines = [_HEAD, "", summary(results)]
    for result in results:
        plots = plot_result(result, plot_folder)
        written.update(plots)
        addresses = [plot.relative_to(page.parent).as_posix() for plot in plots]
        lines += ["", *section(result, addresses)]
    for plot in set(plot_folder.glob("*.svg")) - written:  # of results that are no more
        plot.unlink()
    page.write_text("\n".join(lines) + "\n")


def _counts_line(reason: str, n: int, counts: Sequence[int], again: str) -> str:
    cells = (reason, str(n), *(str(count) if count else "" for count in counts), again)
    return "| " + " | ".join(_cell(cell) for cell in cells) + " |"


def _shortened(sentence: str, length: int = 240) -> str:
    return sentence if len(sentence) <= length else f"{sentence[: length - 1]}…"


def _number(value: float) -> str:
    return str(value) if isinstance(value, int) else f"{value:.4g}"


def _unit(row: Mapping[str, Any]) -> str:
    return f" {row['unit']}" if row["unit"] else ""


def _duration(seconds: float) -> str:
    return f"{seconds:.0f} s" if seconds < 120.0 else f"{seconds / 60.0:.0f} min"


def _cell(text: str) -> str:
    return text.replace("|", "\\|").replace("\n", " ")


def main() -> int:
    try:
        write_page(RESULTS_FOLDER, PAGE)
    except ResultFileError as error:
        print(f"results: {error}", file=sys.stderr)
        return 1
    print(f"written {PAGE}")
    return 0


if __name__ == "__main__":
    sys.exit(main())
