# SPDX-License-Identifier: Apache-2.0
"""The demo, as a person starts it."""

from __future__ import annotations

import json
import signal
import sys
from pathlib import Path

import pytest
from ros2_run import TOWER_TIMEOUT, Start, finish

from tamp_bringup import demo


@pytest.mark.timeout(600)
def test_the_demo_writes_what_it_promises(start: Start, tmp_path: Path) -> None:
    arguments = ["--seed", "2", "--blocks", "3", "--out", str(tmp_path)]
    done = finish(start("tamp_bringup", "demo", *arguments), TOWER_TIMEOUT)
    assert done.code == 0, done
    assert "hung" not in done.stderr
    result = json.loads((tmp_path / "result.json").read_text())
    assert result["success"] is True
    assert result["failure"] is None
    assert result["moves_executed"] >= result["moves_planned"] > 0
    assert set(result["timing_s"]) == {"perceive", "plan", "motion", "execute", "total"}
    assert len(result["initial"]) == len(result["final"]) == 3
    assert (tmp_path / "plan.png").stat().st_size > 10_000
    assert (tmp_path / "execution.gif").read_bytes()[:3] == b"GIF"


def test_ctrl_c_stops_the_demo_and_every_node_even_in_the_background_of_a_script(
    start: Start, tmp_path: Path
) -> None:
    arguments = ["--blocks", "6", "--out", str(tmp_path)]
    process = start("tamp_bringup", "demo", *arguments, ignored=[signal.SIGINT])
    assert process.stdout is not None
    for line in process.stdout:
        if line.startswith("plan"):
            break
    process.send_signal(signal.SIGINT)
    ended = finish(process)
    assert ended.code == 130, ended
    assert "hung" not in ended.stderr
    assert not left_over(str(tmp_path))


def left_over(marker: str) -> list[str]:
    """Command lines of processes whose log is in a folder."""
    found = []
    for folder in Path("/proc").glob("[0-9]*"):
        try:
            target = (folder / "fd" / "1").readlink()
            if marker in str(target):
                found.append((folder / "cmdline").read_text().replace("\0", " "))
        except OSError:
            continue
    return found


@pytest.mark.parametrize(
    "arguments",
    [
        ["--blocks", "9"],
        ["--goal", "red over"],
        ["--goal", "red on mauve"],
        ["--goal", "box on box"],
        ["--goal", "red on blue, green on red, pink on green", "--blocks", "3"],
        ["--seed", "-1"],
        ["--seed", "99999999999"],
        ["--real-time-factor", "nan"],
        ["--out", "/dev/null/runs"],
        ["--out", "/proc"],
    ],
)
def test_fault_17_the_demo_refuses_bad_arguments_before_it_starts_anything(
    arguments: list[str], monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    monkeypatch.setattr(sys, "argv", ["demo", *arguments])
    with pytest.raises(SystemExit) as refused:
        demo.main()
    assert refused.value.code == 2
    usage, sentence = capsys.readouterr().err.rsplit("error: ", 1)
    assert usage.startswith("usage:")
    assert sentence.startswith(arguments[0]) and sentence.count("\n") == 1
