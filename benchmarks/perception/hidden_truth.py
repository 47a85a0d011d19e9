# SPDX-License-Identifier: Apache-2.0
"""Whether a graph in which blocks hide others is right, by the true poses and the true picture.

Nothing here is shared with perception: what is visible of a block is counted in the simulator's
labels, and rays to the corners of a small cube are compared with its depth.
"""

from __future__ import annotations

import itertools
from typing import Final

import cv2
import numpy as np
from numpy.typing import NDArray

from scene_graph import FRONT, SceneGraph, SceneGraphError, SceneObject, is_hidden, rows_of
from sim_node import Frame
from sim_node.scene import CameraConfig

#: A block of which more is visible has to be seen.
MOST_MISSED: Final = 0.5
#: The smallest block that there may be [m], and how far beside the middle of a place, or of a block
#: that it stands on, its own middle may be [m].
SMALLEST: Final = 0.025
BESIDE_PLACE: Final = 0.0225
BESIDE_BLOCK: Final = 0.45 * SMALLEST
#: Depth of a surface that is seen differs from that of its point by less [m].
SAME: Final = 0.004
_CORNERS: Final = np.array(list(itertools.product((-0.5, 0.0, 0.5), repeat=3)))


def is_partly_right(
    seen: SceneGraph, truth: SceneGraph, frame: Frame, camera: CameraConfig
) -> bool:
    """Whether all that a graph says is true, and nothing is missing that could be seen."""
    try:
        stacks = seen.stacks()
    except SceneGraphError:
        return False
    true = truth.stacks()
    names = {name for stack in stacks for name in stack if not is_hidden(name)}
    row = rows_of(truth.places).rows
    place_of = {name: index for index, stack in enumerate(true) for name in stack}
    for item in seen.relations:
        if item.predicate == FRONT and not row[place_of[item.subject]] < row[place_of[item.object]]:
            return False
    for index, (here, there) in enumerate(zip(stacks, true, strict=True)):
        if [name for name in here if not is_hidden(name)] != [n for n in there if n in names]:
            return False
        unseen = [name for name in there if name not in names]
        if not any(map(is_hidden, here)):
            if unseen:
                return False
            continue
        if not unseen and not _could_hide(index, truth, frame, camera):
            return False
        for name in unseen:
            if visible_share(truth.object(name), frame, camera) > MOST_MISSED:
                return False
        # What stands for hidden blocks is where they are.
        if unseen and _hidden_levels(here, there, names) is False:
            return False
    return True


def _hidden_levels(here: tuple[str, ...], there: tuple[str, ...], names: set[str]) -> bool:
    """Whether between any two that are seen, something is hidden in the graph as in truth."""
    true = [name if name in names else "" for name in there]
    told = ["" if is_hidden(name) else name for name in here]
    true = [name for name, before in zip(true, [None, *true]) if name or before != ""]
    if told and not told[-1] and (not true or true[-1]):
        told = told[:-1]  # above the others there may be none
    return true == told


def visible_share(block: SceneObject, frame: Frame, camera: CameraConfig) -> float:
    """Visible part of a block's outline, 0..1."""
    corners = _CORNERS * block.size @ _turn(block).T + block.position_world
    pixels = _project(corners, camera)[:, :2]
    outline = np.zeros(frame.labels.shape, np.uint8)
    cv2.fillConvexPoly(outline, cv2.convexHull(np.round(pixels).astype(np.int32)), 1)
    return int(np.count_nonzero(frame.labels == block.label)) / max(1, int(outline.sum()))


def _could_hide(place: int, truth: SceneGraph, frame: Frame, camera: CameraConfig) -> bool:
    """Whether a small cube could be on a place's stack without any of its corners being seen."""
    stack = truth.stacks()[place]
    x, y, top = truth.places[place].position_world
    aside = BESIDE_BLOCK if stack else BESIDE_PLACE
    if stack:
        item = truth.object(stack[-1])
        x, y, top = item.position_world
        top += 0.5 * item.size[2]
    for dx, dy in itertools.product(np.linspace(-aside, aside, 9), repeat=2):
        centre = (x + dx, y + dy, top + 0.5 * SMALLEST)
        points = _project(_CORNERS * SMALLEST + centre, camera)
        columns, rows = np.round(points[:, :2]).astype(int).T
        if not (frame.depth[rows, columns] > points[:, 2] + SAME).any():
            return True
    return False


def _project(points: NDArray[np.float64], camera: CameraConfig) -> NDArray[np.float64]:
    """Pixels and depths of points in world, shape (n, 3) [m] -> (n, 3) [px, px, m]."""
    pose = camera.world_from_optical
    optical = (points - pose[:3, 3]) @ pose[:3, :3]
    pixels = optical @ camera.intrinsics.T
    return np.column_stack([pixels[:, :2] / pixels[:, 2:], optical[:, 2]])


def _turn(block: SceneObject) -> NDArray[np.float64]:
    _, _, z, w = block.quaternion_world
    yaw = 2.0 * np.arctan2(z, w)
    c, s = np.cos(yaw), np.sin(yaw)
    return np.array([[c, -s, 0.0], [s, c, 0.0], [0.0, 0.0, 1.0]])
