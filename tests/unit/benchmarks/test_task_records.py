# SPDX-License-Identifier: Apache-2.0
"""Records say of every task whether it has begun, whatever happens to who writes them."""

from __future__ import annotations

import json
import multiprocessing
from pathlib import Path

import pytest
from tasks.record import AlreadyBegunError, CampaignRunsError, Records, State, Tally


@pytest.fixture
def records(tmp_path: Path) -> Records:
    return Records(tmp_path / "campaign")


def begin_and_count(folder: Path, seeds: range, begun: multiprocessing.Queue[int]) -> None:
    records, count = Records(folder), 0
    for seed in seeds:
        try:
            records.begin(seed, {"by": 0})
            count += 1
        except AlreadyBegunError:
            pass
    begun.put(count)


def test_a_task_begins_once(records: Records) -> None:
    records.begin(1000, {"goal": "red on blue"})
    assert records.read(1000) == {"goal": "red on blue", "seed": 1000, "state": "begun"}
    with pytest.raises(AlreadyBegunError, match="1000"):
        records.begin(1000, {"goal": "another"})
    assert records.read(1000)["goal"] == "red on blue"


def test_of_several_processes_one_begins_each_task(records: Records) -> None:
    context = multiprocessing.get_context("spawn")
    counts: multiprocessing.Queue[int] = context.Queue()
    workers = [
        context.Process(target=begin_and_count, args=(records.folder, range(100), counts))
        for _ in range(3)
    ]
    for worker in workers:
        worker.start()
    assert sum(counts.get(timeout=120.0) for _ in workers) == 100
    for worker in workers:
        worker.join(60.0)
    assert records.seeds() == list(range(100))


def test_an_end_keeps_what_was_written_at_the_beginning(records: Records) -> None:
    records.begin(1, {"goal": "red on blue"})
    records.end(1, {"success": True, "failure": None})
    assert records.read(1) == {
        "goal": "red on blue", "seed": 1, "state": "ended", "success": True, "failure": None,
    }  # fmt: skip


def test_only_tasks_without_an_end_become_interrupted(records: Records) -> None:
    for seed in (1, 2, 3):
        records.begin(seed, {})
    records.end(1, {"success": True, "failure": None})
    records.interrupt(2)
    assert records.interrupt_all_begun() == [3]
    assert [records.state(seed) for seed in (1, 2, 3)] == [
        State.ENDED, State.INTERRUPTED, State.INTERRUPTED,
    ]  # fmt: skip
    assert records.interrupt_all_begun() == []


def test_results_of_older_code_count_as_ended(records: Records) -> None:
    records.path(1000).write_text(json.dumps({"seed": 1000, "success": True}))
    assert records.state(1000) is State.ENDED
    assert records.interrupt_all_begun() == []


def test_nothing_but_records_and_folders_is_left_behind(records: Records) -> None:
    records.begin(1, {})
    records.end(1, {"success": True})
    with pytest.raises(AlreadyBegunError):
        records.begin(1, {})
    assert [path.name for path in records.folder.iterdir()] == ["1.json"]


def test_a_campaign_is_held_by_one(records: Records) -> None:
    other = Records(records.folder)
    with records.lock(), pytest.raises(CampaignRunsError, match="another process"), other.lock():
        pass
    with Records(records.folder).lock():
        pass


def test_forgetting_makes_every_task_one_that_has_not_begun(records: Records) -> None:
    records.begin(1, {})
    records.forget()
    assert not records.has_begun(1)
    records.begin(1, {})


def test_the_tally_counts_what_has_ended_whoever_ran_it(records: Records) -> None:
    tally = Tally(records)
    assert tally.count(range(4)) == (0, 0)
    for seed in range(3):
        records.begin(seed, {})
    assert tally.count(range(4)) == (0, 0)
    records.end(0, {"success": True})
    records.interrupt(1)
    assert tally.count(range(4)) == (1, 2)
    records.end(2, {"success": True})
    assert tally.count(range(4)) == (2, 3)
