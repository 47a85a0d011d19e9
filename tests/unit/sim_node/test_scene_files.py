# SPDX-License-Identifier: Apache-2.0
"""Scene files: what they leave out is as by default; what is impossible is told in a sentence."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np
import pytest
import yaml
from hypothesis import given
from hypothesis import strategies as st

from scene_graph import COLORS, SHAPES
from sim_node.generators import generate_layout
from sim_node.ground_truth import true_scene_graph
from sim_node.scene import SceneConfig, SceneError, example_scenes, load_scene, parse_scene
from sim_node.simulated_arms import PANDA
from sim_node.world import World

EXAMPLES = example_scenes()
WALL = "name: wall, size: [0.02, 0.2, 0.1]"

#: What is wrong, the key that the sentence begins with, and something that it says of it.
BAD = [
    ("plases: [[0.5, 0.0]]", "plases", "is it places?"),
    ("places: 3", "places", "not a list"),
    ("places: []", "places", "1 to 8"),
    ("places: [[0.5, 0.0, 0.0]]", "places[0]", "3 items, not 2"),
    (f"places: {[[0.4, y / 10] for y in range(-4, 5)]}", "places", "1 to 8"),
    ("places: [[0.5, 0.0], [0.5, 0.04]]", "places[1]", "40 mm from places[0]"),
    ("places: [[0.5, 0.0], [0.9, 0.1]]", "places[1]", "off the table"),
    ("places: [[0.2, 0.0]]", "places[0]", "0.3 to 0.75 m"),
    ("places: [[0.6, -0.5], [0.5, 0.0]]", "places[0]", "0.78 m from the arm"),
    ("places: [[0.5, 0.1], [0.5, -0.1]]", "places[1]", "left of places[0]"),
    ("places: [[0.4, -0.1], [0.4, 0.1], [0.6, -0.1], [0.6, 0.1]]", "places[2]", "nearer"),
    ("places: [[0.5, .nan]]", "places[0][1]", "not finite"),
    ("places: [[0.5, left]]", "places[0][1]", "not a number"),
    ("blocks: [red_box]", "blocks", "not a mapping"),
    ("blocks: {size: 0.071}", "blocks.size", "0.025 to 0.07 m"),
    ("blocks: {size: 0.02}", "blocks.size", "0.025 to 0.07 m"),
    ("blocks: {size: [0.06, 0.03]}", "blocks.size", "low end"),
    ("blocks: {size: [0.03, 0.04, 0.05]}", "blocks.size", "range [low, high]"),
    ("blocks: {shapes: [box, pyramid]}", "blocks.shapes[1]", "known: box, cylinder, sphere, prism"),
    ("blocks: {shapes: []}", "blocks.shapes", "1 to 4"),
    ("blocks: {colors: [red, puce]}", "blocks.colors[1]", "'puce' is unknown; known: red"),
    ("blocks: {colors: [red, red]}", "blocks.colors", "twice"),
    ("blocks: {colors: [red, blue], most: 7}", "blocks.most", "more than the 2 names"),
    ("blocks: {most: 15}", "blocks.most", "1 to 14"),
    ("blocks: {most: 7.5}", "blocks.most", "not a whole number"),
    ("blocks: {mass: 0}", "blocks.mass", "0.005 to 2 kg"),
    ("blocks: {mass: 1e-1}", "blocks.mass", "with a point"),
    ("blocks: {friction: true}", "blocks.friction", "not a number"),
    ("blocks: {named: {red_teapot: {}}}", "blocks.named", "'red_teapot' is not COLOR_SHAPE"),
    ("blocks: {named: {red_box: {size: [0.04, 0.05]}}}", "blocks.named.red_box.size", "not 3"),
    ("blocks: {named: {red_sphere: {size: [0.04, 0.05, 0.04]}}}", "blocks.named.red_sphere.size",
     "one size"),
    ("blocks: {named: {red_cylinder: {size: [0.04, 0.05, 0.04]}}}",
     "blocks.named.red_cylinder.size", "diameter"),
    ("blocks: {named: {red_box: {size: 0.07}}}\nplaces: [[0.5, 0.0], [0.5, 0.075]]", "places[1]",
     "blocks of 70 mm"),
    ("obstacles: {name: wall}", "obstacles", "not a list"),
    ("obstacles: [{position: [0.5, 0.3]}]", "obstacles[0].name", "a name of its own"),
    (f"obstacles: [{{{WALL}}}]", "obstacles[0].position", "is missing"),
    (f"obstacles: [{{{WALL}, position: [0.5, 0.01]}}]", "obstacles[0].position", "on places[1]"),
    (f"obstacles: [{{{WALL}, position: [0.5, 0.3, 0.02]}}]", "obstacles[0].position",
     "30 mm into the table"),
    (f"obstacles: [{{{WALL}, position: [0.5, 0.9]}}]", "obstacles[0].position", "over the table"),
    (f"obstacles: [{{{WALL}, position: [0.1, 0.0]}}]", "obstacles[0].position", "arm's foot"),
    ("obstacles: [{name: bin, shape: bucket}]", "obstacles[0].shape", "known: box"),
    ("obstacles: [{name: bin, shape: tray, size: [0.01, 0.1, 0.1], position: [0.4, 0.4]}]",
     "obstacles[0].size", "nothing is left"),
    (f"obstacles: [{{{WALL}, position: [0.5, 0.3], color: puce}}]", "obstacles[0].color", "known"),
    (f"obstacles: [{{{WALL}, position: [0.5, 0.3], color: [0.5, 0.5, 2]}}]",
     "obstacles[0].color", "2, in [0.5, 0.5, 2.0]"),
    ("arm: {home: [0, 0, 0, 0, 0, 0, 9]}", "arm.home", "-7 to 7 rad"),
    ("cameras: []", "cameras", "1 to 8"),
    ("cameras: [{vertical_fov: 4}]", "cameras[0].vertical_fov", "4 is out of range; 0.1 to 2.5"),
    ("cameras: [{width: 64}]", "cameras[0].width", "128 to 1280"),
    ("cameras: [{height: 1080}]", "cameras[0].height", "128 to 720"),
    ("cameras: [{target: [1.45, 0.0, 0.4]}]", "cameras[0].target", "the camera itself"),
    ("cameras: [{position: [0.5, 0.0, 1.2], target: [0.5, 0.0, 0.0]}]", "cameras[0].target",
     "straight below"),
    ("cameras: [{target: [3.0, 0.0, 0.4]}]", "cameras[0].target", "none of the places"),
    ("cameras: [{position: [4.9, 0.0, 0.4]}]", "cameras[0].target", "none of the places"),
    ("cameras: [{position: [1.0, 0.0, -0.4]}]", "cameras[0].position", "above the table"),
    ("cameras: [{distortion: [0.1, 0.0]}]", "cameras[0].distortion", "2 items"),
    ("cameras: [{distortion: [-2, 0, 0, 0, 0], vertical_fov: 1.2}]", "cameras[0].distortion",
     "folds"),
    ("cameras: [{name: eye}]", "cameras[0].name", "called camera"),
    ("cameras: [{}, {}]", "cameras[1].name", "another one"),
    ("cameras: [{}, {name: left eye}]", "cameras[1].name", "cannot name a topic"),
    ("light: {direction: [0, 0, 0]}", "light.direction", "no direction"),
    ("light: {ambient: -1}", "light.ambient", "0 to 2"),
    ("yaw_jitter: 10", "yaw_jitter", "0 to 3.2 rad"),
    ("blocks: {}\nblocks: {}", "", "line 2: the key 'blocks' is there twice"),
    ("cameras: [", "", "no YAML: line 1"),
    ("light: !!python/object:os.system {}", "", "no YAML"),
    ("just words", "", "not a mapping"),
]  # fmt: skip


@pytest.mark.parametrize(("text", "key", "says"), BAD, ids=[f"{row[1]} {row[2]}" for row in BAD])
def test_an_impossible_scene_is_refused_with_a_sentence_about_its_key(
    text: str, key: str, says: str
) -> None:
    with pytest.raises(SceneError) as caught:
        parse_scene(text)
    sentence = str(caught.value)
    assert caught.value.key == key or not key
    assert sentence.startswith(key) and says in sentence, sentence
    assert "\n" not in sentence and len(sentence) < 300


def test_nothing_said_is_the_default() -> None:
    assert parse_scene("") == parse_scene("# empty") == load_scene("") == SceneConfig()


def test_the_default_written_out_says_the_same() -> None:
    written, default = load_scene("default"), SceneConfig()
    assert tuple(written.arm.home) == PANDA.home
    assert replace(written, arm=default.arm) == default


def test_an_unknown_name_is_answered_with_the_examples(tmp_path: Path) -> None:
    with pytest.raises(SceneError, match=r"'teapot' cannot be read: .*examples: default, five"):
        load_scene("teapot")
    (tmp_path / "binary.yaml").write_bytes(b"\xff\xfe\x00")
    for path in (tmp_path, tmp_path / "binary.yaml"):
        with pytest.raises(SceneError, match="cannot be read"):
            load_scene(str(path))


def test_the_sentence_about_a_file_names_it(tmp_path: Path) -> None:
    path = tmp_path / "mine.yaml"
    path.write_text("blocks: {size: 3}")
    with pytest.raises(SceneError, match=r"scene '.*mine.yaml': blocks.size = 3 is out of range"):
        load_scene(str(path))


@pytest.mark.parametrize("name", EXAMPLES)
def test_an_example_is_explained_built_and_true(name: str) -> None:
    assert EXAMPLES[name].read_text().startswith("# ")
    scene = load_scene(name)
    with World(scene) as world:
        for seed, generator in ((3, "uniform"), (4, "varied")):
            layout = generate_layout(scene, generator, seed, min(6, scene.blocks.most))
            world.reset(layout, seed, settle_time=1.0)
            assert true_scene_graph(world).stacks() == layout
            for number, camera in enumerate(scene.cameras):
                frame = world.render(number)
                assert frame.rgb.shape == (camera.height, camera.width, 3)
                assert len(np.unique(frame.labels)) > 4


#: Anything that YAML can hold, under keys that a scene knows.
_KEYS = st.sampled_from(
    [*yaml.safe_load(EXAMPLES["default"].read_text()), "size", "named", "red_box", "position"]
)
_VALUES = st.one_of(
    st.none(),
    st.booleans(),
    st.integers(),
    st.floats(),
    st.sampled_from([*COLORS, *SHAPES, "tray", "0.1"]),
    st.floats(0.02, 0.8),
)
_DATA = st.recursive(
    _VALUES, lambda part: st.lists(part, max_size=4) | st.dictionaries(_KEYS, part, max_size=4)
)


@given(st.dictionaries(_KEYS, _DATA, max_size=3))
def test_whatever_is_written_becomes_a_scene_or_a_sentence(data: dict[str, Any]) -> None:
    try:
        scene = parse_scene(yaml.safe_dump(data))
    except SceneError as error:
        assert str(error)
    else:
        assert isinstance(scene, SceneConfig)
