# SPDX-License-Identifier: Apache-2.0
"""The plan's picture and the animation can be opened and show what they should."""

from pathlib import Path

import numpy as np
import pytest
from PIL import Image, ImageSequence

from scene_graph import COLORS, Move
from tamp_bringup.plan_picture import draw_plan
from tamp_bringup.recording import Recording

STATES = (
    (("red_box", "blue_box"), (), ("green_cylinder",)),
    (("red_box",), ("blue_box",), ("green_cylinder",)),
    ((), ("blue_box", "red_box"), ("green_cylinder",)),
)


def count_color(path: Path, color: str) -> int:
    pixels = np.asarray(Image.open(path).convert("RGB")).astype(int)
    return int((np.abs(pixels - np.array(COLORS[color]) * 255).max(axis=2) < 12).sum())


def test_a_plan_shows_every_state(tmp_path: Path) -> None:
    image = np.full((64, 64, 3), 200, dtype=np.uint8)
    one, all_ = tmp_path / "one.png", tmp_path / "all.png"
    draw_plan(one, image, STATES[:1], [], "red on blue")
    draw_plan(all_, image, STATES, [Move(0, 1), Move(0, 1)], "red on blue")
    assert count_color(one, "red") > 200
    assert count_color(all_, "red") == pytest.approx(3 * count_color(one, "red"), rel=0.3)


def test_a_plan_without_an_image_or_moves_can_be_drawn(tmp_path: Path) -> None:
    draw_plan(tmp_path / "plan.png", None, STATES[:1], [], "red_box on stack0 " * 20)
    assert Image.open(tmp_path / "plan.png").size[0] > 100


def frame(value: int) -> np.ndarray:
    return np.full((8, 8, 3), value, dtype=np.uint8)


def frame_count(path: Path) -> int:
    return sum(1 for _ in ImageSequence.Iterator(Image.open(path)))


def test_an_animation_keeps_images_at_its_interval(tmp_path: Path) -> None:
    recording = Recording(interval=0.4)
    for index in range(20):
        recording.add(frame(index * 10), index * 0.1)
    assert recording.write_gif(tmp_path / "a.gif")
    assert frame_count(tmp_path / "a.gif") == 5


def test_a_long_recording_stays_bounded(tmp_path: Path) -> None:
    recording = Recording(interval=0.1, limit=20)
    for index in range(1000):
        recording.add(frame(index % 250), index * 0.1)
    recording.write_gif(tmp_path / "a.gif")
    assert 5 <= frame_count(tmp_path / "a.gif") <= 20


def test_nothing_recorded_is_nothing_written(tmp_path: Path) -> None:
    assert not Recording().write_gif(tmp_path / "a.gif")
    assert not (tmp_path / "a.gif").exists()
