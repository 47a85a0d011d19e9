# SPDX-License-Identifier: Apache-2.0
"""Recordings keep all that a replay needs, and say why where they cannot be read."""

from __future__ import annotations

from contextlib import closing
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
import replay.recording
from replay.alignment import beginning
from replay.carry_out import REST_SECONDS, carry_out
from replay.environment import LOCK, provide_mujoco
from replay.recording import Command, Recording, RecordingError, load_recording
from replay_scenes import recording

from sim_node.controller import ArmController
from sim_node.world import World

ROOT = Path(__file__).parents[3]
STEP = 1.0 / 240.0


def assert_equal(left: Recording, right: Recording) -> None:
    for key in ("seed", "goal", "success", "robot", "joints", "places", "bodies", "relations"):
        assert getattr(left, key) == getattr(right, key), key
    assert np.array_equal(left.start, right.start)
    assert left.trace.names == right.trace.names
    assert left.trace.notes == right.trace.notes
    for key in ("times", "joints", "poses"):
        assert np.array_equal(getattr(left.trace, key), getattr(right.trace, key))
    assert len(left.commands) == len(right.commands)
    for one, other in zip(left.commands, right.commands):
        assert one.begins == other.begins
        assert np.array_equal(one.times, other.times)
        assert np.array_equal(one.positions, other.positions)
        assert (one.velocities is None) == (other.velocities is None)
        if one.velocities is not None and other.velocities is not None:
            assert np.array_equal(one.velocities, other.velocities)


def test_a_recording_is_the_same_after_it_was_written_and_read(tmp_path: Path) -> None:
    moving = recording().commands[0]
    stop = Command(5.0, np.zeros(0), np.zeros((0, 9)), None)
    whole = recording(commands=(moving, replace(moving, begins=2.5, velocities=None), stop))
    whole.save(tmp_path / "7.npz")
    assert_equal(load_recording(tmp_path / "7.npz"), whole)
    assert [path.name for path in tmp_path.iterdir()] == ["7.npz"]


def test_what_is_no_recording_is_named_with_what_to_do(tmp_path: Path) -> None:
    path = tmp_path / "7.npz"
    for content in (b"", b"nonsense", b"PK\x03\x04 cut"):
        path.write_bytes(content)
        with pytest.raises(RecordingError, match=r"7\.npz is no recording .* remove it"):
            load_recording(path)


def test_a_recording_of_another_format_is_refused(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    path = tmp_path / "7.npz"
    recording().save(path)
    monkeypatch.setattr(replay.recording, "VERSION", 2)
    with pytest.raises(RecordingError, match="number 1, this code reads 2"):
        load_recording(path)


class PosedWorld(World):
    """pybullet's world with the poses of its blocks."""

    def poses(self) -> np.ndarray:
        return np.array([np.concatenate(self.block_pose(name)) for name in self.names])


def test_the_same_commands_in_the_same_engine_end_the_same() -> None:
    times = np.array([0.0, 1.0, 3.0])
    layout = (("red_box", "green_box"), (), ("blue_box",))
    with closing(PosedWorld()) as world:
        # The hand comes down before the row and sweeps along it; whatever it hits, it hits twice.
        home = world.arm.home_positions
        down = np.array([-0.7, 0.4, 0.0, -2.4, 0.0, 2.8, 0.785, 0.04, 0.04])
        swept = down.copy()
        swept[0] = 0.7
        positions = np.array([home, down, swept])
        world.reset(layout, 3)
        first, controller = world.steps, ArmController(world)
        while world.steps - first < round((3.5 + REST_SECONDS) / STEP) + 1:
            if world.steps - first == 120:
                controller.follow(world.arm.joints, times, positions, None)
            controller.update()
            world.step()
        ended = world.poses()
        world.reset(layout, 3)
        whole = recording(
            joints=world.arm.joints,
            commands=(Command(120 * STEP, times, positions, None),),
            trace=replace(recording().trace, times=np.array([3.0])),
        )
        again = carry_out(whole, world)
        assert np.array_equal(world.poses(), ended)
        assert np.abs(again.poses[-1] - again.poses[0]).max() > 0.01, "nothing was hit"
        assert not again.notes


@pytest.mark.parametrize("late", [-0.2, -0.05, 0.0, 0.1, 0.3])
def test_the_joints_tell_when_a_trajectory_began_that_was_heard_of_late(late: float) -> None:
    times = np.array([0.0, 0.5, 1.0, 2.0])
    positions = np.array([[0.0, 0.1], [0.2, 0.4], [0.9, 0.3], [1.0, 0.0]])
    began = 600 * STEP
    at = np.arange(0.0, 6.0, 4 * STEP)
    joints = np.array([np.interp(at - began, times, column) for column in positions.T]).T
    found = beginning(began + late, times, positions, at, joints, STEP)
    assert found == pytest.approx(began, abs=1.5 * STEP)


def test_where_the_arm_does_not_move_a_trajectory_began_when_it_was_heard() -> None:
    at = np.arange(0.0, 6.0, 4 * STEP)
    still = np.zeros((len(at), 2))
    times, positions = np.array([0.0, 1.0]), np.zeros((2, 2))
    assert beginning(2.5, times, positions, at, still, STEP) == 2.5
    assert beginning(2.5, times, positions, at[:1], still[:1], STEP) == 2.5


def test_the_extra_is_pinned_by_hashes_and_repeats_nothing_of_the_product() -> None:
    text = LOCK.read_text()
    entries = [line for line in text.splitlines() if line and not line.startswith(" ")]
    names = {line.split("==")[0] for line in entries}
    assert "mujoco" in names
    assert all("==" in line and line.endswith("\\") for line in entries)
    assert text.count("--hash=sha256:") >= len(entries)
    assert "://" not in text
    product = {
        line.split("==")[0] for line in (ROOT / "requirements.lock").read_text().splitlines()
    }
    assert not names & product


def test_an_extra_that_is_there_is_not_installed_again(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    import hashlib
    import sys

    monkeypatch.setattr(sys, "path", list(sys.path))
    lock, folder = tmp_path / "lock", tmp_path / "replay"
    lock.write_text("no such requirement")
    (folder / "mujoco").mkdir(parents=True)
    (folder / "mujoco" / "__init__.py").touch()
    (folder / ".stamp").write_text(hashlib.sha256(lock.read_bytes()).hexdigest())
    provide_mujoco(folder, lock)
    assert sys.path[-1] == str(folder), "what the product has comes first"
