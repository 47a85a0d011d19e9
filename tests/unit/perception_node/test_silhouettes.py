# SPDX-License-Identifier: Apache-2.0
"""Blocks measured by their outlines: beside ray-cast ones, whose poses are known."""

from __future__ import annotations

from dataclasses import replace

import cv2
import numpy as np
import pytest
from perception_scenes import PLACES, Solid, cast, looking_camera, piled, tower

from perception_node.blocks import BlockSurface
from perception_node.blocks.silhouette import measure_silhouettes
from perception_node.errors import BadImageError
from perception_node.segment import Segments

CAMERA = looking_camera(512)
FEET = np.array(PLACES)


def measured(solids: list[Solid]) -> tuple[BlockSurface, ...]:
    _, labels = cast(solids, CAMERA)
    rgb = np.full((*labels.shape, 3), 120, np.uint8)
    segments = Segments.from_labels(labels, hides=np.zeros(labels.shape, bool))
    assert len(segments) == len(solids)
    return measure_silhouettes(rgb, segments, CAMERA, FEET)


def assert_is(surface: BlockSurface, solid: Solid) -> None:
    toward = CAMERA.position_world[:2] - solid.centre[:2]
    toward /= np.linalg.norm(toward)
    off = np.subtract(surface.position, solid.centre[:2])
    assert surface.upright
    assert abs(off @ [-toward[1], toward[0]]) < 0.002
    assert abs(off @ toward) < 0.009
    assert abs(0.5 * (surface.low + surface.high) - solid.centre[2]) < 0.003
    assert abs(surface.high - surface.low - 2.0 * solid.halves[2]) < 0.003
    assert abs(surface.widths[0] - 2.0 * solid.halves[0]) < 0.003
    # The stated doubt holds, up to four standard deviations.
    doubt = surface.covariance[:2, :2] + 1e-7 * np.eye(2)
    assert off @ np.linalg.inv(doubt) @ off < 16.0


def test_towers_of_equal_cubes() -> None:
    solids = [*tower(0, ["box"] * 3, 0.1), *tower(1, ["box"], 0.6), *tower(2, ["box"] * 2, -0.2)]
    for surface, solid in zip(measured(solids), solids):
        assert_is(surface, solid)


def test_cubes_of_many_sizes_turned_anyhow() -> None:
    solids = [
        *piled(0, [(0.06, 0.06, 0.06), (0.03, 0.03, 0.03)], [0.3, -0.6]),
        *piled(2, [(0.035, 0.035, 0.035), (0.055, 0.055, 0.055)], [0.7, 0.1]),
    ]
    for surface, solid in zip(measured(solids), solids):
        assert_is(surface, solid)


@pytest.mark.parametrize("edges", [(0.031, 0.039), (0.045, 0.052)])
def test_a_larger_cube_is_not_taken_for_an_equal_one_nearer_by(edges: tuple[float, float]) -> None:
    solids = piled(0, [(edge,) * 3 for edge in edges], [0.2, -0.3])
    for surface, solid in zip(measured(solids), solids):
        assert_is(surface, solid)


@pytest.mark.parametrize("edge", [0.03, 0.045])
def test_doubt_whether_a_block_was_missed_is_settled_by_the_top_below_it(edge: float) -> None:
    low, high = piled(0, [(edge,) * 3] * 2, [0.3, -0.2])
    for solids in ([low], [low, high]):
        _, labels = cast(solids, CAMERA)
        labels[labels > 1] = 0  # the upper one is missed
        found = Segments.from_labels(labels, hides=np.zeros(labels.shape, bool))
        block = found.blocks[0]
        rim = block.part & ~cv2.erode(block.part.astype(np.uint8), np.ones((3, 3))).astype(bool)
        outline = np.argwhere(rim)[:, ::-1].astype(np.float64)
        segments = replace(found, blocks=(replace(block, outline=outline, over=(12.0, 34.0)),))
        rgb = np.full((*labels.shape, 3), 120, np.uint8)
        if len(solids) == 1:
            assert_is(measure_silhouettes(rgb, segments, CAMERA, FEET)[0], low)
        else:
            with pytest.raises(BadImageError, match=r"pixel \(12, 34\) may be a block on a tower"):
                measure_silhouettes(rgb, segments, CAMERA, FEET)


def test_what_lies_on_an_edge_and_what_is_in_the_air_are_no_upright_blocks() -> None:
    lying = Solid("box", (0.5, 0.0, 0.02), (0.02, 0.09, 0.02), 0.0)
    floating = Solid("box", (0.5, 0.15, 0.12), 0.0225)
    flat, high = measured([lying, floating])
    # What stands on the table and looks like the one in the air is far behind its place.
    assert not high.upright or np.hypot(*np.subtract(high.position, PLACES[2][:2])) > 0.1
    assert flat.widths[0] > 2.5 * (flat.high - flat.low) or not flat.upright


def test_what_stands_beside_all_places_is_told() -> None:
    with pytest.raises(BadImageError, match="stands on no place"):
        measured([Solid("box", (0.5, 0.27, 0.0225), 0.0225)])
