# SPDX-License-Identifier: Apache-2.0
"""What campaigns say: reasons in classes, a table of failures that adds up, rows with bounds."""

from __future__ import annotations

from typing import Any

import pytest
from hypothesis import given
from hypothesis import strategies as st
from results_file import Row, wilson_interval
from scipy.stats import binomtest
from tasks.draw import draw_task
from tasks.failures import AXES, Axis, failure_table, sentence_class
from tasks.family import FAMILIES, Family, family_named
from tasks.record import INTERRUPTED, OPERATOR
from tasks.report import command_of, make_details, make_rows, progress_text
from write_results_page import failure_table as failure_page

SIX, VARIED = family_named("six"), family_named("varied")


def result(seed: int, reason: str = "", module: str = "perception", **others: Any) -> dict:
    timing = {"perceive": 0.1, "plan": 0.001, "motion": 0.2, "execute": 4.0, "total": 4.5}
    return {
        "seed": seed, "state": "ended", "success": not reason, "commit": "abc",
        "failure": {"module": module, "reason": reason} if reason else None,
        "moves_planned": 9, "moves_executed": 9, "replans": 0, "timing_s": timing,
        "graph_seconds": [0.02, 0.03], "other_graph_seconds": {"OCCLUDED": [0.001] * 6},
        "wall_seconds": 5.0, "simulated_seconds": 40.0, "real_time_factor": 8.0,
        "drawn": {"places": 3.0}, **others,
    }  # fmt: skip


def interrupted(seed: int) -> dict:
    failure = {"module": OPERATOR, "reason": INTERRUPTED}
    return {"seed": seed, "state": "interrupted", "success": False, "failure": failure, "drawn": {}}


def rows_of(results: list[dict], jobs: int = 1) -> dict[str, Row]:
    """The rows about all tasks, by their metric."""
    return {row.metric: row for row in make_rows(results, SIX, jobs) if row.set == SIX.what}


# Sentences


@pytest.mark.parametrize(
    ("sentence", "kind"),
    [
        ("red_box leans by 12 degrees; look again", "BLOCK leans by N degrees"),
        ("something hides 12% of stack1; look again", "something hides N% of PLACE"),
        ("a picture is 3.5 s old. Check the camera", "a picture is N s old"),
        ("red_box, blue_box and pink_box are gone", "BLOCK, … are gone"),
        ("read /tmp/run/1003/scene.yaml: no", "read PATH: no"),
        ("success was claimed, but the truth is (('red_box',), ())",
         "success was claimed, but the truth is"),
        ("no graph\nTraceback 12", "no graph"),
    ],
)  # fmt: skip
def test_a_sentence_loses_what_differs_from_task_to_task(sentence: str, kind: str) -> None:
    assert sentence_class(sentence) == kind


@given(st.integers(-999, 999), st.floats(0.0, 99.0, allow_nan=False), st.sampled_from("012345"))
def test_numbers_and_names_do_not_make_another_class(whole: int, part: float, place: str) -> None:
    one = f"cyan_box is {whole} mm beside stack{place}, confidence {part:.2f}"
    assert sentence_class(one) == "BLOCK is N mm beside PLACE, confidence N"


@given(st.text(max_size=300))
def test_a_class_is_a_short_line_and_its_own_class_whatever_was_said(sentence: str) -> None:
    kind = sentence_class(sentence)
    assert len(kind) <= 110 and "\n" not in kind


# The table


@given(
    st.lists(
        st.tuples(
            st.sampled_from(["", "red_box fell", "blue_box fell", "no graph"]),
            st.integers(2, 5),
            st.floats(-15.0, 15.0),
        ),
        max_size=30,
    )
)
def test_the_table_adds_up_along_every_axis(tasks: list[tuple[str, int, float]]) -> None:
    results = [
        result(seed, reason, drawn={"places": float(places), "camera angle": angle})
        for seed, (reason, places, angle) in enumerate(tasks)
    ]
    table = failure_table(results, {seed: f"again {seed}" for seed in range(len(tasks))})
    failed = [reason for reason, _, _ in tasks if reason]
    if not failed:
        assert table is None
        return
    assert table is not None
    assert sum(row["n"] for row in table["rows"]) == len(failed)
    falls = sum("fell" in reason for reason in failed)
    assert sum(row["n"] for row in table["rows"] if row["sentence"] == "BLOCK fell") == falls
    for axis in {column["axis"] for column in table["columns"]}:
        members = [i for i, column in enumerate(table["columns"]) if column["axis"] == axis]
        assert sum(table["columns"][i]["n"] for i in members) == len(tasks)
        for row in table["rows"]:
            assert sum(row["counts"][i] for i in members) == row["n"]
            assert all(row["counts"][i] <= table["columns"][i]["n"] for i in members)


def test_the_most_frequent_reason_comes_first_with_the_command_of_its_first_task() -> None:
    results = [
        result(1000, "no graph", drawn={"places": 2.0}),
        result(1001, "red_box fell", "motion", drawn={"places": 3.0}),
        result(1002, "blue_box fell", "motion", drawn={"places": 3.0}),
        result(1003, drawn={"places": 2.0}),
    ]
    table = make_details(results, VARIED, 0.0)["failure_table"]
    assert table["columns"] == [
        {"axis": "places", "bin": "2", "n": 2}, {"axis": "places", "bin": "3", "n": 2},
    ]  # fmt: skip
    first, second = table["rows"]
    assert (first["module"], first["sentence"], first["n"], first["counts"]) == (
        "motion", "BLOCK fell", 2, [0, 2],
    )  # fmt: skip
    assert first["again"] == "make eval-tasks FAMILY=varied SEED=1001 RTF=0"
    assert second["counts"] == [1, 0]
    page = "\n".join(failure_page(table))
    assert "3 of 4 tasks failed" in page
    assert "| reason | all | places 2 | places 3 | again |" in page
    assert "| tasks | 4 | 2 | 2 |  |" in page
    assert f"| **motion**: BLOCK fell | 2 |  | 2 | `{first['again']}` |" in page


def test_what_is_the_same_in_all_tasks_makes_no_column() -> None:
    table = failure_table([result(0, "no graph"), result(1)], {0: ""})
    assert table is not None and table["columns"] == []


def test_a_value_on_an_edge_is_in_the_upper_bin() -> None:
    axis = Axis("smallest block", (3.5, 4.0), " cm")
    assert [axis.bin_of(value) for value in (3.49, 3.5, 4.0)] == [
        "< 3.5 cm", "3.5 to 4 cm", "≥ 4 cm",
    ]  # fmt: skip
    assert axis.bins([5.0, 3.0]) == ["< 3.5 cm", "≥ 4 cm"]


def test_words_are_bins_of_their_own() -> None:
    axis = Axis("masks")
    assert axis.bins(["shifted", "eroded", "shifted"]) == ["eroded", "shifted"]
    assert axis.bin_of("eroded") == "eroded"


@pytest.mark.parametrize("family", FAMILIES, ids=lambda family: family.name)
def test_all_that_is_drawn_has_an_axis(family: Family) -> None:
    assert set(draw_task(family, 0).drawn) <= {axis.name for axis in AXES}


# Rows


def wilson_by_scipy(successes: int, n: int) -> tuple[float, float]:
    interval = binomtest(successes, n).proportion_ci(confidence_level=0.95, method="wilson")
    return interval.low, interval.high


@given(st.integers(1, 500).flatmap(lambda n: st.tuples(st.integers(0, n), st.just(n))))
def test_the_interval_is_wilson_s(counts: tuple[int, int]) -> None:
    assert wilson_interval(*counts) == pytest.approx(wilson_by_scipy(*counts), abs=1e-9)


def test_the_progress_bar_shows_share_and_interval() -> None:
    low, high = wilson_by_scipy(198, 200)
    assert progress_text(198, 200) == f"198/200 succeeded, 99% [{low:.3f}, {high:.3f}]"
    assert progress_text(0, 0) == "none has ended"


@pytest.mark.parametrize(("failures", "holds"), [(2, True), (3, False)])
def test_198_of_200_hold_and_197_do_not(failures: int, holds: bool) -> None:
    results = [result(seed, "no graph" if seed < failures else "") for seed in range(200)]
    rows = rows_of(results)
    assert rows["success rate"].holds is holds
    low = rows["success rate, lower end of the interval"]
    assert low.value == pytest.approx(wilson_by_scipy(200 - failures, 200)[0])
    assert low.required == ">= 0.96"


def test_interrupted_tasks_count_as_failed_and_have_no_times() -> None:
    rows = rows_of([result(0), interrupted(1)])
    assert (rows["success rate"].value, rows["success rate"].n) == (0.5, 2)
    assert "1 interrupted by the operator count as failed" in (rows["success rate"].note or "")
    assert rows["wall time of a task, median"].n == 1
    details = make_details([result(0), interrupted(1)], SIX, 0.0)
    assert details["failures"][0]["reason"] == INTERRUPTED
    assert [task["seed"] for task in details["tasks"]] == [0]


def test_rows_of_nothing_but_interrupted_tasks_can_be_made() -> None:
    rows = make_rows([interrupted(0)], SIX)
    assert rows[0].value == 0.0 and len(rows) == 2


def test_all_frames_count_and_the_others_are_named() -> None:
    rows = rows_of([result(0), result(1)])
    every = rows["image to graph, median over all frames"]
    assert (every.n, every.value) == (16, pytest.approx(1.0))
    assert every.note == "4 CONFIDENT, 12 OCCLUDED"
    assert rows["image to graph, median over confident frames"].value == pytest.approx(25.0)
    assert rows["share of frames with a confident graph"].value == pytest.approx(0.25)


def test_wall_and_simulated_time_stand_beside_the_factor_reached() -> None:
    rows = rows_of([result(0)])
    wall = rows["wall time of a task, median"]
    assert (wall.value, wall.required, wall.holds) == (5.0, "<= 6", True)
    assert rows["simulated time of a task, median"].value == 40.0
    assert rows["real-time factor reached, median"].value == 8.0
    busy = rows_of([result(0)], jobs=2)
    assert busy["wall time of a task, median"].required is None
    assert "2 graphs side by side" in (busy["wall time of a task, median"].note or "")


def test_details_say_if_the_code_changed_in_between() -> None:
    assert "commits" not in make_details([result(0), result(1)], SIX, 0.0)
    mixed = make_details([result(0), result(1, commit="def")], SIX, 0.0)
    assert mixed["commits"] == ["abc", "def"]


def test_the_command_names_family_seed_and_speed() -> None:
    assert command_of(SIX, 1003, 2.5) == "make eval-tasks FAMILY=six SEED=1003 RTF=2.5"
