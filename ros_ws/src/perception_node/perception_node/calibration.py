# SPDX-License-Identifier: Apache-2.0
"""What is known of a camera: its lens, its pixels, and where it is."""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import dataclass, replace
from typing import Any, Final

import cv2
import numpy as np
from numpy.typing import NDArray

from scene_graph import rotation_from_quaternion

from .camera import PinholeCamera
from .errors import BadImageError
from .observation import Observation

#: How much longer or shorter than 1 a quaternion may be.
QUATERNION_TOLERANCE: Final = 2e-4
#: Coefficients that a lens can have, by distortion model.
_COEFFICIENTS: Final = {
    "plumb_bob": (4, 5),
    "rational_polynomial": (8, 12, 14),
    "equidistant": (4,),
}
#: Where inverse depths of neighbours bend by a smaller share than this, there is no edge: the noise
#: of a depth camera bends them by a third of it.
_PLANE: Final = 0.01
_BEND: Final = np.array([[1.0, -2.0, 1.0]], np.float32)

Array = NDArray[np.float64]
Pixels = NDArray[Any]


@dataclass(frozen=True)
class LensModel:
    """A camera as sensor_msgs/CameraInfo describes it, where every symbol is explained.

    Attributes:
        frame: the optical frame of the pictures.
        width, height: of the whole sensor [px].
        region: left, top, width and height of the part that pictures show; without width or height
            they show all of it [px].
        distortion_model: its name; empty means plumb_bob.
        d: its coefficients.
        k: of the raw pictures, nine numbers by rows [px].
        r: from the camera to the rectified one, nine numbers by rows; zeros mean none.
        p: projection of the rectified pictures, twelve numbers by rows; zeros mean none [px].
    """

    frame: str
    width: int
    height: int
    k: tuple[float, ...]
    distortion_model: str = ""
    d: tuple[float, ...] = ()
    r: tuple[float, ...] = (0.0,) * 9
    p: tuple[float, ...] = (0.0,) * 12
    region: tuple[int, int, int, int] = (0, 0, 0, 0)

    @property
    def shown(self) -> tuple[int, int, int, int]:
        """Left, top, width and height of the part of the sensor that pictures show [px]."""
        if self.region[2] and self.region[3]:
            return self.region
        return 0, 0, self.width, self.height


@dataclass(frozen=True)
class FramePose:
    """The pose of the frame ``child`` in the frame ``parent``.

    Attributes:
        position: shape (3,) [m].
        quaternion: x, y, z, w.
    """

    parent: str
    child: str
    position: tuple[float, float, float]
    quaternion: tuple[float, float, float, float]

    def matrix(self, name: str) -> Array:
        """Homogeneous, shape (4, 4) [m]; raises BadImageError, about ``name``, if it has none."""
        if not abs(np.linalg.norm(self.quaternion) - 1.0) < QUATERNION_TOLERANCE:
            raise BadImageError(f"{name} does not hold a unit quaternion")
        pose = np.eye(4)
        pose[:3, :3] = rotation_from_quaternion(self.quaternion)
        pose[:3, 3] = self.position
        return pose


@dataclass(frozen=True)
class Rectification:
    """Makes of a picture with distortion what a pinhole camera would have taken.

    Attributes:
        between: maps of OpenCV, from the pixels of the new picture to where between pixels of the
            old one they were.
        nearest: the same, to the nearest pixel.
    """

    between: tuple[Pixels, Pixels]
    nearest: tuple[Pixels, Pixels]

    @classmethod
    def of(cls, columns: Pixels, rows: Pixels) -> Rectification:
        """From maps of OpenCV in floating point."""
        # With the maps for linear interpolation OpenCV rounds a tenth of a pixel up.
        return cls(
            cv2.convertMaps(columns, rows, cv2.CV_16SC2),
            cv2.convertMaps(columns, rows, cv2.CV_16SC2, nninterpolation=True),
        )

    def color(self, rgb: Pixels) -> Pixels:
        """Of a color image; what the lens did not show is black."""
        return cv2.remap(rgb, *self.between, cv2.INTER_LINEAR)

    def labels(self, labels: Pixels) -> Pixels:
        """Of labels: that of the nearest pixel; 0 where the lens showed nothing."""
        kind = labels.dtype
        # OpenCV has no 32-bit integers here; labels are as exact in floating point.
        kept = labels if kind in (np.uint16, np.uint8) else labels.astype(np.float32)
        return cv2.remap(kept, *self.nearest, cv2.INTER_NEAREST).astype(kind, copy=False)

    def depth(self, depth: Pixels) -> Pixels:
        """Of depths [m]; 0 where the lens showed nothing.

        On a plane the inverse of depth is linear in the picture: there it is interpolated. At edges
        it must not be mixed: there it is that of the nearest pixel.
        """
        known = np.isfinite(depth) & (depth > 0.0)
        inverse = np.divide(1.0, depth, out=np.zeros_like(depth), where=known)
        bend = np.maximum(
            np.abs(cv2.filter2D(inverse, cv2.CV_32F, _BEND)),
            np.abs(cv2.filter2D(inverse, cv2.CV_32F, _BEND.T)),
        )
        plane = (known & (bend < _PLANE * inverse)).astype(np.float32)
        amid = cv2.remap(plane, *self.between, cv2.INTER_LINEAR) > 1.0 - 1e-4
        seen = cv2.remap(depth, *self.nearest, cv2.INTER_NEAREST)
        np.divide(1.0, cv2.remap(inverse, *self.between, cv2.INTER_LINEAR), out=seen, where=amid)
        return seen


@dataclass(frozen=True)
class View:
    """How pictures of a size are taken: by ``camera``, after ``rectification`` if there is one."""

    camera: PinholeCamera
    rectification: Rectification | None = None

    def observation(self, rgb: Pixels, labels: Pixels | None, depth: Pixels | None) -> Observation:
        """Of pictures that were taken like this; raises BadImageError if they do not fit."""
        taken = Observation(rgb, labels, depth)
        if self.rectification is not None:
            taken.checked()
            taken = Observation(
                self.rectification.color(rgb),
                None if labels is None else self.rectification.labels(labels),
                None if depth is None else self.rectification.depth(depth),
            )
        return replace(taken, camera=self.camera)


class Calibration:
    """What is known of the camera. Keeps the newest view, as it seldom changes.

    Where the camera is comes from ``camera/extrinsics``, and from the frames of ``tf_static`` as
    long as there are none.

    Args:
        rectified: the pictures are, as those of ``image_rect`` topics: ``p`` is their camera, and
            the distortion of the message is that of the pictures they were made of.
        world_frame: in which poses are, where they come from tf_static.
    """

    def __init__(self, rectified: bool = False, world_frame: str = "world") -> None:
        self._rectified = rectified
        self._world_frame = world_frame
        self._extrinsics: FramePose | None = None
        self._frames: dict[str, FramePose] = {}
        self._known: tuple[tuple[LensModel, int, int], View] | None = None

    def place(self, extrinsics: FramePose) -> None:
        """Where the camera is: the pose of its optical frame."""
        if extrinsics != self._extrinsics:  # many publish it again and again
            self._extrinsics = extrinsics
            self._known = None

    def add_frames(self, frames: Iterable[FramePose]) -> None:
        """Frames that do not move, as on tf_static."""
        known = self._frames | {frame.child: frame for frame in frames}
        if known != self._frames:
            self._frames = known
            self._known = None

    @property
    def placed(self) -> bool:
        """Whether anything is known of where the camera is."""
        return self._extrinsics is not None or bool(self._frames)

    @property
    def pose_frame(self) -> str:
        """The frame in which poses are."""
        return self._extrinsics.parent if self._extrinsics else self._world_frame

    def view(self, lens: LensModel, width: int, height: int) -> View:
        """How pictures of this size are taken.

        Args:
            lens: of the camera.
            width, height: of the picture [px].

        Raises:
            BadImageError: no camera is like this and takes such pictures.
        """
        key = (lens, width, height)
        if self._known is None or self._known[0] != key:
            self._known = (key, self._view(lens, width, height))
        return self._known[1]

    def _view(self, lens: LensModel, width: int, height: int) -> View:
        pose = self._pose(lens.frame)
        left, top, full_width, full_height = lens.shown
        if not full_width or not full_height:
            raise BadImageError("camera_info has no width and height; calibrate the camera")
        offset = np.array([[0.0, 0.0, left], [0.0, 0.0, top], [0.0, 0.0, 0.0]])
        raw = np.array(lens.k, dtype=np.float64).reshape(3, 3) - offset
        projection = np.array(lens.p, dtype=np.float64).reshape(3, 4)
        has_projection = projection[0, 0] > 0.0 and projection[1, 1] > 0.0
        distorted = any(abs(value) > 1e-9 for value in lens.d)
        straight = raw
        if has_projection and (distorted or self._rectified):
            straight = projection[:, :3] - offset
            # The second camera of a stereo pair is beside the frame that its poses are in.
            pose = pose.copy()
            beside = -projection[:2, 3] / (projection[0, 0], projection[1, 1])
            pose[:3, 3] += pose[:3, :2] @ beside
        camera = PinholeCamera(straight, pose, full_width, full_height).resized(width, height)
        if not distorted or self._rectified:
            return View(camera)
        taker = PinholeCamera(raw, pose, full_width, full_height).resized(width, height)
        return View(camera, _rectification(lens, taker.intrinsics, camera))

    def _pose(self, frame: str) -> Array:
        """Of the optical frame, shape (4, 4) [m]."""
        if self._extrinsics is not None:
            child = self._extrinsics.child
            if child and frame and child != frame:
                raise BadImageError(
                    f"camera/extrinsics is that of {child!r}, but the pictures are in "
                    f"{frame!r}; calibrate the camera whose pictures these are"
                )
            return self._extrinsics.matrix("camera/extrinsics")
        if not self.placed:
            raise BadImageError(
                "camera/extrinsics has not arrived yet; is the camera's driver complete?"
            )
        return self._chain(frame)

    def _chain(self, frame: str) -> Array:
        """From the world through tf_static to a frame."""
        pose, at, passed = np.eye(4), frame, [frame]
        while at != self._world_frame:
            step = self._frames.get(at)
            if step is None or step.parent in passed:
                raise BadImageError(
                    f"there is no camera/extrinsics, and tf_static leads from {frame!r} to "
                    f"{at!r} and not on to {self._world_frame!r}; publish where the camera is"
                )
            pose = step.matrix(f"tf_static of {at!r}") @ pose
            at = step.parent
            passed.append(at)
        return pose


def _rectification(lens: LensModel, intrinsics: Array, camera: PinholeCamera) -> Rectification:
    """From raw pictures with these intrinsics to those of a camera without distortion."""
    model = lens.distortion_model or "plumb_bob"
    counts = _COEFFICIENTS.get(model)
    if counts is None:
        raise BadImageError(
            f"the distortion model {model!r} of camera_info is none of {', '.join(_COEFFICIENTS)}; "
            "publish rectified pictures, with d = 0"
        )
    if len(lens.d) not in counts or not np.isfinite(lens.d).all():
        raise BadImageError(
            f"camera_info has {len(lens.d)} coefficients of distortion, and {model} has "
            f"{' or '.join(map(str, counts))}; calibrate the camera"
        )
    coefficients = np.array(lens.d, dtype=np.float64)
    rotation = np.array(lens.r, dtype=np.float64).reshape(3, 3)
    if not rotation.any():
        rotation = np.eye(3)
    size = (camera.width, camera.height)
    make: Any = cv2.fisheye if model == "equidistant" else cv2
    maps = make.initUndistortRectifyMap(
        intrinsics, coefficients, rotation, camera.intrinsics, size, cv2.CV_32FC1
    )
    return Rectification.of(*maps)
