# SPDX-License-Identifier: Apache-2.0
"""One file says what stands around to the simulator and to the motion problem."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest

from motion_node.obstacles import ObstacleError, obstacles_from, read_obstacles
from sim_node.scene import load_scene
from sim_node.scene.files import example_scenes


@pytest.mark.parametrize("name", ["wall", "tray", "default"])
def test_the_simulators_scenes_are_read_as_it_reads_them(name: str) -> None:
    found = {item.name: item for item in read_obstacles(str(example_scenes()[name]))}
    expected = load_scene(name).obstacles
    assert set(found) == {item.name for item in expected}
    for item in expected:
        if item.shape != "tray":
            own = found[item.name]
            assert own.size == item.size
            assert own.position_world == pytest.approx(item.position_world)
            assert own.yaw == item.yaw
            assert own.round == (item.shape in ("cylinder", "sphere"))


def test_a_tray_is_a_bottom_and_four_sides() -> None:
    parts = obstacles_from(
        [{"name": "t", "shape": "tray", "size": [0.3, 0.2, 0.05], "position": [0.5, 0.1]}]
    )
    assert len(parts) == 5
    low = np.min([np.subtract(p.position_world, np.array(p.size) / 2) for p in parts], axis=0)
    high = np.max([np.add(p.position_world, np.array(p.size) / 2) for p in parts], axis=0)
    np.testing.assert_allclose([low, high], [[0.35, 0.0, 0.0], [0.65, 0.2, 0.05]], atol=1e-12)


def test_no_file_is_no_obstacle() -> None:
    assert read_obstacles("") == ()


WALL = {"name": "wall", "size": [0.2, 0.02, 0.1], "position": [0.5, 0.1]}


@pytest.mark.parametrize(
    ("item", "words"),
    [
        ({**WALL, "name": ""}, "obstacles[0].name"),
        ({**WALL, "shape": "cone"}, "obstacles[0].shape = 'cone'"),
        ({**WALL, "size": [0.2, 0.02]}, "obstacles[0].size"),
        ({**WALL, "size": [0.2, 0.02, -0.1]}, "obstacles[0].size"),
        ({**WALL, "size": [0.2, 0.02, float("nan")]}, "obstacles[0].size"),
        ({**WALL, "size": [True, 0.02, 0.1]}, "obstacles[0].size"),
        ({**WALL, "position": []}, "obstacles[0].position"),
        ({**WALL, "position": "here"}, "obstacles[0].position"),
        ({**WALL, "yaw": float("inf")}, "obstacles[0].yaw"),
        ({**WALL, "colour": "red"}, "obstacles[0].colour is unknown"),
        ({**WALL, "shape": "cylinder"}, "as deep as it is wide"),
        ("wall", "obstacles[0] is not a mapping"),
    ],
)
def test_what_does_not_fit_is_told_by_its_key(item: object, words: str) -> None:
    with pytest.raises(ObstacleError, match=words.replace("[", r"\[").replace("]", r"\]")):
        obstacles_from({"obstacles": [item]})


def test_names_are_not_given_twice() -> None:
    with pytest.raises(ObstacleError, match="a name of its own"):
        obstacles_from([WALL, WALL])


def test_a_file_that_cannot_be_read_is_named(tmp_path: Path) -> None:
    with pytest.raises(ObstacleError, match="No such file"):
        read_obstacles(str(tmp_path / "none.yaml"))
    broken = tmp_path / "broken.yaml"
    broken.write_text("obstacles: [")
    with pytest.raises(ObstacleError, match="is no YAML"):
        read_obstacles(str(broken))
