# SPDX-License-Identifier: Apache-2.0
"""From where to look at what no camera has seen."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace
from typing import Final

import numpy as np
from numpy.typing import NDArray

from scene_graph import SceneGraph, SceneObject, is_hidden, rotation_from_quaternion

from .camera import PinholeCamera
from .config import PerceptionConfig

Array = NDArray[np.float64]

#: Directions from which it can be looked, around the places and over the table [rad].
AROUND: Final = np.radians(np.arange(0.0, 360.0, 15.0))
ABOVE: Final = np.radians([25.0, 40.0, 55.0, 70.0])
#: A camera looks at this height over the middle of the places [m].
TARGET: Final = 0.1
#: The arm stands on the z axis of the world; no camera is nearer to it or looks past it nearer [m].
ARM: Final = 0.3
#: What is hidden is settled by a view that shows this share of it.
ENOUGH: Final = 0.8
#: Points of a box, as parts of its size from its middle.
_GRID: Final = np.stack(np.meshgrid(*[np.linspace(-0.4, 0.4, 4)] * 3), axis=-1).reshape(-1, 3)


def next_view(
    graph: SceneGraph, camera: PinholeCamera, config: PerceptionConfig
) -> PinholeCamera | None:
    """The camera where it would see what no camera has seen of a graph; None: nowhere, or nothing.

    Of the places from which it sees most, as far as the blocks that are known let it, the one
    that is nearest to where it is.
    """
    hidden = [item for item in graph.objects if is_hidden(item.name)]
    blocks = [item for item in graph.objects if all(item.size) and not is_hidden(item.name)]
    if not hidden or not graph.places:
        return None
    points = np.concatenate([_GRID * item.size + item.position_world for item in hidden])
    feet = np.array([place.position_world for place in graph.places])
    target = feet.mean(axis=0) + (0.0, 0.0, TARGET)
    distance = float(np.linalg.norm(camera.position_world - target))
    best: tuple[float, float, PinholeCamera] | None = None
    for up in ABOVE:
        for angle in AROUND:
            off = np.array([np.cos(up) * np.cos(angle), np.cos(up) * np.sin(angle), np.sin(up)])
            there = _looking(camera, target + distance * off, target)
            if _is_by_the_arm(there, target) or not _shows(there, feet, config):
                continue
            share = float(_seen(points, there.position_world, blocks).mean())
            away = float(np.linalg.norm(there.position_world - camera.position_world))
            if share >= ENOUGH and (best is None or (-share, away) < best[:2]):
                best = (-share, away, there)
    return None if best is None else best[2]


def _looking(camera: PinholeCamera, position: Array, target: Array) -> PinholeCamera:
    """The camera at a position, upright, looking at a target [m]."""
    forward = (target - position) / np.linalg.norm(target - position)
    right = np.cross(forward, (0.0, 0.0, 1.0))
    right /= np.linalg.norm(right)
    pose = np.eye(4)
    pose[:3] = np.column_stack([right, np.cross(forward, right), forward, position])
    return replace(camera, world_from_optical=pose)


def _is_by_the_arm(camera: PinholeCamera, target: Array) -> bool:
    """Whether the way from the camera to its target passes by the arm, seen from above."""
    start, way = camera.position_world[:2], target[:2] - camera.position_world[:2]
    share = np.clip(-(start @ way) / max(float(way @ way), 1e-9), 0.0, 1.0)
    return bool(np.linalg.norm(start + share * way) < ARM)


def _shows(camera: PinholeCamera, feet: Array, config: PerceptionConfig) -> bool:
    """Whether all columns over the places are in the picture, shape (m, 3) [m]."""
    w = config.column_half_width
    corners = np.array([[i, j, 0.0] for i in (-w, w) for j in (-w, w)])
    ends = (feet[:, None] + corners).reshape(-1, 3)
    pixels = camera.project(np.concatenate([ends, ends + (0.0, 0.0, config.column_height)]))
    with np.errstate(invalid="ignore"):
        inside = (pixels >= 0.0) & (pixels <= (camera.width - 1, camera.height - 1))
    return bool(inside.all())


def _seen(points: Array, eye: Array, blocks: Sequence[SceneObject]) -> NDArray[np.bool_]:
    """Which points, shape (n, 3) [m], no block hides from an eye, shape (n,)."""
    free = np.ones(len(points), bool)
    for item in blocks:
        turn = rotation_from_quaternion(item.quaternion_world)
        start = (eye - item.position_world) @ turn
        way = (points - eye) @ turn
        with np.errstate(divide="ignore", invalid="ignore"):
            ends = (np.array([[-0.5], [0.5]])[:, None] * item.size - start) / way
        enter, leave = ends.min(axis=0).max(axis=1), ends.max(axis=0).min(axis=1)
        free &= ~((enter < np.minimum(leave, 1.0)) & (leave > 0.0))
    return free
