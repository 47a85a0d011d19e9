# SPDX-License-Identifier: Apache-2.0
"""What one picture alone cannot tell, and the ones before it can."""

from __future__ import annotations

import zlib
from typing import Any, Final

import cv2
import numpy as np
from numpy.typing import NDArray

from scene_graph import UP, SceneGraph, base_name

from .camera import PinholeCamera
from .observation import Observation

#: Calibrations that differ by less are the same: that moves nothing by more than some pixels, and
#: who calibrates again gets it [m], [rad].
SAME_POSITION: Final = 0.01
SAME_ROTATION: Final = np.radians(1.0)
#: Every so many rows the bits of a picture are looked at: noise changes all of them.
_ROWS: Final = 8
#: Every so many rows and columns a pixel is compared.
_STEP: Final = 2
#: Colours that differ by less are the same, by more others [0..255, three channels together].
_SAME_COLOR: Final = 40
_OTHER_COLOR: Final = 90
#: Depths that differ by less are the same, as a share of them.
_SAME_DEPTH: Final = 0.01
#: With fewer pixels that tell, as where nothing of what was seen is in view any more, or the camera
#: turned back to what it moved away from, nobody knows.
_ENOUGH: Final = 80
#: Of those that tell, so many have to say that the camera moved. Where only it moved nearly all do,
#: and still half of them where it turned back to what it moved away from; else a seventh at most.
_MANY: Final = 1 / 3
#: Depths that differ by more are of other things, whatever the noise [m], and as a share of them.
_OTHER_DEPTH: Final = (0.02, 0.04)
FROZEN_COLORS: Final = (
    "has been the same picture to the last bit while depth shows that things moved; start the "
    "camera's driver anew"
)
#: Least area of what moved, in pixels, without a rim two pixels wide: edges of depth flicker.
_AREA: Final = 16
#: A calibration by which blocks stand so much nearer to their places is the right one [m].
_NEARER: Final = 0.008


class Continuity:
    """Remembers the last picture that was understood, and how long pictures have been the same."""

    def __init__(self) -> None:
        self._understood: Observation | None = None
        self._aside: float | None = None
        self._stamp = self._content = self._since = 0
        self._colors: tuple[int, int] | None = None
        self._depth: NDArray[np.floating] | None = None
        self._frozen = False

    def understand(self, observation: Observation, graph: SceneGraph, stamp: int) -> None:
        """Remembers an observation that made a confident graph.

        Args:
            stamp: when it was taken [ns].
        """
        self._understood, self._aside, self._stamp = observation, _aside(graph), stamp

    def calibration_problem(self, observation: Observation, graph: SceneGraph, stamp: int) -> str:
        """What is wrong with a calibration that moved and a camera that did not; else nothing.

        A camera that moved shows at other pixels what it showed before. One that does not, and is
        said to be somewhere else, has one calibration that is wrong. It is the new one, unless the
        blocks stand much nearer to the middle of their places by it. Before the first picture that
        was understood, and after the clock went back, all is believed.

        Args:
            graph: what the observation shows by the new calibration.
            stamp: when it was taken [ns].
        """
        if stamp < self._stamp:
            self._understood = None
        before, camera = self._understood, observation.camera
        if before is None or before.camera is None or before.depth is None or camera is None:
            return ""
        metres, angle = _distance(before.camera, camera)
        if metres < SAME_POSITION and angle < SAME_ROTATION:
            return ""
        if before.rgb.shape != observation.rgb.shape:
            return ""
        told, moved = _moved(before, before.camera, before.depth, observation, camera)
        if told < _ENOUGH or moved >= _MANY * told:
            return ""
        aside = _aside(graph)
        if aside is not None and self._aside is not None and aside + _NEARER < self._aside:
            return ""
        return (
            f"camera/extrinsics says that the camera has moved by {1000 * metres:.0f} mm and "
            f"turned by {np.degrees(angle):.0f} degrees since the scene was understood last, and "
            "its picture does not show that: the calibration before this one is wrong, or this one "
            "is; if this one is right, restart perception_node"
        )

    def frozen_colors(
        self, stamp: int, rgb: NDArray[np.uint8], depth: NDArray[np.floating] | None
    ) -> float:
        """For how long colours have been the same while depth has shown that things moved [s].

        Once it has, until colours change: an arm that is home again leaves depth as it was, and
        what it moved may be as high as what stood there.

        Args:
            stamp: when both were taken [ns].
            rgb, depth: as the camera delivered them, shapes (h, w, 3) and (h, w) [m].

        Returns:
            0 where colours changed, nothing moved, or depth is not known.
        """
        if depth is None:
            return 0.0
        content = zlib.crc32(np.ascontiguousarray(rgb[::_ROWS]).data)
        known, before = self._colors, self._depth
        if known is None or before is None or known[0] != content or stamp < known[1]:
            self._colors, self._depth, self._frozen = (content, stamp), depth, False
            return 0.0
        if before.shape == depth.shape and not self._frozen:
            self._frozen = _other_things(before, depth)
        return (stamp - known[1]) / 1e9 if self._frozen else 0.0

    def seconds_unchanged(self, stamp: int, *pictures: NDArray[Any] | None) -> float:
        """For how long every picture has been this one, by the bits of some rows [s].

        Args:
            stamp: when it was taken [ns].
            pictures: what the cameras delivered.
        """
        content = 0
        for picture in pictures:
            if picture is not None:
                content = zlib.crc32(np.ascontiguousarray(picture[::_ROWS]).data, content)
        if content != self._content or stamp < self._since:
            self._content, self._since = content, stamp
        return (stamp - self._since) / 1e9


def _other_things(before: NDArray[np.floating], now: NDArray[np.floating]) -> bool:
    """Whether depth shows other things than before; a pixel without depth tells nothing."""
    with np.errstate(invalid="ignore"):
        nearest = np.minimum(before, now)
        apart = np.abs(before - now) > _OTHER_DEPTH[0] + _OTHER_DEPTH[1] * nearest
        apart &= np.isfinite(nearest) & (nearest > 0.0)
    if np.count_nonzero(apart) < _AREA:
        return False
    inner = cv2.erode(apart.astype(np.uint8), np.ones((5, 5), np.uint8))
    return bool(np.count_nonzero(inner) >= _AREA)


def _aside(graph: SceneGraph) -> float | None:
    """Mean distance of the lowest blocks from the middle of their places [m]; None: none is known.

    What is put on a place by hand or by an arm is there to some millimetres.
    """
    places = {base_name(place.index): place.position_world for place in graph.places}
    apart = [
        np.subtract(graph.object(relation.subject).position_world, places[relation.object])
        for relation in graph.relations
        if relation.predicate == UP and relation.object in places
    ]
    return float(np.mean(np.hypot(*np.array(apart)[:, :2].T))) if apart else None


def _distance(one: PinholeCamera, other: PinholeCamera) -> tuple[float, float]:
    """Between the poses of two cameras [m], [rad]."""
    turn = one.world_from_optical[:3, :3].T @ other.world_from_optical[:3, :3]
    angle = float(np.arccos(np.clip((np.trace(turn) - 1.0) / 2.0, -1.0, 1.0)))
    return float(np.linalg.norm(one.position_world - other.position_world)), angle


def _moved(
    before: Observation,
    old_camera: PinholeCamera,
    depth: NDArray[np.floating],
    now: Observation,
    camera: PinholeCamera,
) -> tuple[int, int]:
    """How many pixels can tell whether a camera moved as its calibration did, and how many say so.

    What a pixel showed is seen at another one by a camera that moved so. Where the colours of these
    two differed before, they tell.
    """
    height, width = depth.shape
    rows, columns = np.mgrid[0:height:_STEP, 0:width:_STEP]
    far = depth[rows, columns]
    known = np.isfinite(far) & (far > 0.0)
    rows, columns, far = rows[known], columns[known], far[known].astype(np.float64)
    rays = old_camera.rays_world(np.stack([columns, rows], axis=-1))
    points = old_camera.position_world + far[:, None] * rays
    moved_to = np.rint(camera.project(points))
    seen = ((moved_to >= 0) & (moved_to < (width, height))).all(axis=1)
    here = rows[seen], columns[seen]
    there = tuple(moved_to[seen].astype(int).T[::-1])
    # Not by depth: that of a table that is seen from low differs from pixel to pixel.
    tell = _change(before.rgb[here], before.rgb[there]) > _OTHER_COLOR
    moved = tell & (_change(before.rgb[here], now.rgb[there]) < _SAME_COLOR)
    if now.depth is not None:
        new_far = (points[seen] - camera.position_world) @ camera.world_from_optical[:3, 2]
        with np.errstate(invalid="ignore"):
            moved &= np.abs(now.depth[there] - new_far) < _SAME_DEPTH * new_far
    return int(np.count_nonzero(tell)), int(np.count_nonzero(moved))


def _change(color: NDArray[np.uint8], other: NDArray[np.uint8]) -> NDArray[np.int16]:
    """By how much the channels of colours differ in all, shape (n, 3) -> (n,)."""
    return np.abs(color.astype(np.int16) - other.astype(np.int16)).sum(axis=-1, dtype=np.int16)
