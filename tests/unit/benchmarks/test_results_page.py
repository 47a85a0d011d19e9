# SPDX-License-Identifier: Apache-2.0
"""The results page repeats the result files, and nothing else."""

from __future__ import annotations

import json
from pathlib import Path
from typing import Any

import pytest
from results_file import Row
from write_results_page import ResultFileError, write_page


def write_result_file(folder: Path, name: str, *rows: Row, **others: Any) -> Path:
    folder.mkdir(exist_ok=True)
    content = {
        "name": name,
        "command": f"make bench-{name}",
        "commit": "abc1234",
        "date": "2026-01-31",
        "machine": {"cpu": "Some CPU", "cores": 2, "memory_gib": 24},
        "seconds": 812.0,
        "quick": False,
        "rows": [{**vars(row), "holds": row.holds} for row in rows],
        **others,
    }
    path = folder / f"{name}.json"
    path.write_text(json.dumps(content))
    return path


def task(seed: int, success: bool = True) -> dict[str, Any]:
    timing = {"perceive": 0.2, "plan": 0.01, "motion": 0.9, "execute": 60.0 + seed, "total": 62.0}
    return {"seed": seed, "success": success, "moves_executed": 6, "timing_s": timing}


@pytest.fixture
def results(tmp_path: Path) -> Path:
    return tmp_path / "results_in"


@pytest.fixture
def page(tmp_path: Path) -> Path:
    return tmp_path / "docs" / "results.md"


def test_row_stands_in_the_table_with_bound_and_verdict(results: Path, page: Path) -> None:
    row = Row("K=6", "ratio", 0.12, "", 50, (0.1, 0.19), "<= 0.2", 0.5, "in turns")
    write_result_file(results, "motion", row)
    write_page(results, page)
    text = page.read_text()
    assert "| K=6 | ratio | 0.12 |  | 50 | 0.1 to 0.19 | <= 0.2 | yes | 0.5 | in turns |" in text
    assert "1 of 1 required bounds hold." in text


def test_why_graphs_were_refused_stands_under_their_table(results: Path, page: Path) -> None:
    refused = {"6 objects": {"OCCLUDED: something hides N%": 3}, "7 objects": {}}
    row = Row("6 objects", "graph right", 1.0, "", 9)
    write_result_file(results, "perception", row, details={"refused": refused})
    write_page(results, page)
    assert "| 6 objects | 3 | OCCLUDED: something hides N% |" in page.read_text()


def test_section_says_how_to_measure_again_and_where_it_was_measured(
    results: Path, page: Path
) -> None:
    write_result_file(results, "motion", Row("all", "time", 1.0, "s", 5))
    write_page(results, page)
    text = page.read_text()
    assert "## motion" in text
    assert "`make bench-motion`" in text
    assert "commit abc1234 · 2026-01-31 · Some CPU, 2 cores, 24 GiB · took 14 min" in text


def test_row_that_falls_short_stays_and_is_named_at_the_top(results: Path, page: Path) -> None:
    write_result_file(
        results,
        "tasks",
        Row("6 blocks", "success rate", 0.9, "", 20, required=">= 1.0"),
        Row("6 blocks", "plan", 0.1, "s", 20, required="<= 0.5"),
    )
    write_page(results, page)
    text = page.read_text()
    assert "1 of 2 required bounds hold." in text
    assert "- tasks: success rate (6 blocks) is 0.9, required >= 1.0" in text
    assert "| >= 1.0 | **no** |" in text


def test_row_without_bound_has_no_verdict(results: Path, page: Path) -> None:
    write_result_file(results, "tasks", Row("6 blocks", "moves", 7, "", 20))
    write_page(results, page)
    assert "| 6 blocks | moves | 7 |  | 20 |  |  |  |  |  |" in page.read_text()


def test_quick_runs_are_left_out(results: Path, page: Path) -> None:
    full = write_result_file(results, "motion", Row("all", "time", 1.0, "s", 5))
    full.rename(results / "motion.quick.json")
    write_page(results, page)
    assert "motion" not in page.read_text().split("# Results")[1]


@pytest.mark.parametrize(
    ("content", "reason"),
    [
        ("{", "is not JSON"),
        ('{"name": "motion"}', "lacks command"),
    ],
)
def test_unusable_file_is_refused_by_name_and_the_page_stays(
    results: Path, page: Path, content: str, reason: str
) -> None:
    results.mkdir()
    (results / "motion.json").write_text(content)
    page.parent.mkdir()
    page.write_text("as it was")
    with pytest.raises(ResultFileError, match=f"motion.json: {reason}"):
        write_page(results, page)
    assert page.read_text() == "as it was"


def test_quick_run_under_the_name_of_a_full_one_is_refused(results: Path, page: Path) -> None:
    write_result_file(results, "motion", quick=True)
    with pytest.raises(ResultFileError, match="quick run"):
        write_page(results, page)


def test_tasks_are_plotted_beside_the_page(results: Path, page: Path) -> None:
    tasks = [task(1000), task(1001, success=False)]
    write_result_file(results, "tasks_6", details={"tasks": tasks})
    write_page(results, page)
    assert "![tasks_6](results/tasks_6.svg)" in page.read_text()
    assert (page.parent / "results" / "tasks_6.svg").read_text().lstrip().startswith("<?xml")


def test_verdicts_on_tasks_that_were_not_timed_are_not_plotted(results: Path, page: Path) -> None:
    write_result_file(results, "replay", details={"tasks": [{"seed": 1000, "same": True}]})
    write_page(results, page)
    assert "## replay" in page.read_text()
    assert not (page.parent / "results" / "replay.svg").exists()


def test_equal_results_give_equal_files(results: Path, page: Path) -> None:
    write_result_file(results, "tasks_6", details={"tasks": [task(1000)]})
    plot = page.parent / "results" / "tasks_6.svg"
    write_page(results, page)
    before = page.read_bytes(), plot.read_bytes()
    write_page(results, page)
    assert (page.read_bytes(), plot.read_bytes()) == before


def test_plot_of_a_result_that_is_gone_goes_too(results: Path, page: Path) -> None:
    file = write_result_file(results, "tasks_6", details={"tasks": [task(1000)]})
    write_page(results, page)
    file.unlink()
    write_page(results, page)
    assert not (page.parent / "results" / "tasks_6.svg").exists()


def test_page_of_no_results_says_so(results: Path, page: Path) -> None:
    results.mkdir()
    write_page(results, page)
    assert "No required bound has been measured yet." in page.read_text()
