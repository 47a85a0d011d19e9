# SPDX-License-Identifier: Apache-2.0
"""The scene graph is drawn over the camera image."""

import numpy as np
from numpy.typing import NDArray

from perception_node.drawing import DRAWING_WIDTH, draw_scene_graph
from perception_node.pipeline import Perceived
from perception_node.segment import Segments
from scene_graph import GraphStatus, Relation, SceneGraph, SceneObject


def scene(
    status: GraphStatus = GraphStatus.OCCLUDED, message: str = ""
) -> tuple[NDArray[np.uint8], Perceived]:
    rgb, labels = np.full((256, 256, 3), 120, np.uint8), np.zeros((256, 256), np.uint16)
    labels[180:200, 200:220], labels[160:180, 200:220] = 3, 8
    graph = SceneGraph(
        (
            SceneObject("orange_cylinder", "orange", "cylinder", label=3),
            SceneObject("red_box", "red", "box", label=8),
            SceneObject("gone_box", "blue", "box", label=99),
        ),
        frozenset(
            {
                Relation("red_box", "up", "orange_cylinder"),
                Relation("orange_cylinder", "up", "stack2"),
            }
        ),
        confidence=0.9,
    )
    return rgb, Perceived(graph, status, message, Segments.from_labels(labels))


def test_blocks_and_names_are_drawn_and_the_input_is_left_alone() -> None:
    rgb, perceived = scene(GraphStatus.CONFIDENT)
    before = rgb.copy()
    drawing = draw_scene_graph(rgb, perceived)
    assert drawing.shape == (DRAWING_WIDTH, DRAWING_WIDTH, 3) and drawing.dtype == np.uint8
    assert drawing.nbytes < 500_000  # Fast DDS drops larger best-effort messages
    assert np.array_equal(rgb, before)
    scale = DRAWING_WIDTH / 256
    around = drawing[int(155 * scale) : int(205 * scale), int(195 * scale) :]
    assert (around != 120).any(-1).mean() > 0.2
    assert (drawing[-60:, :120] == 120).all()


def test_a_long_message_is_wrapped_into_the_image() -> None:
    plain = draw_scene_graph(*scene())
    drawing = draw_scene_graph(*scene(message="hidden by something " * 8))
    rows = np.flatnonzero((drawing != plain).any((1, 2)))
    assert rows[0] > 15 and np.ptp(rows) > 28
    columns = np.flatnonzero((drawing != plain).any((0, 2)))
    assert columns[-1] < DRAWING_WIDTH - 1


def test_large_images_are_not_enlarged() -> None:
    rgb = np.zeros((480, 640, 3), np.uint8)
    empty = Perceived(SceneGraph((), frozenset()), GraphStatus.NO_OBJECTS, "none")
    assert draw_scene_graph(rgb, empty).shape == rgb.shape
