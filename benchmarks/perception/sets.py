# SPDX-License-Identifier: Apache-2.0
"""Sets of pictures: what is drawn, how the camera errs, and what perception has to reach."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass, field, replace
from typing import Any, Final

from perception.scenes import Drawn, plain, solids, state_of_six, turned, two_rows
from perception_node.segment import RGBD, SEGMENTATION_TOPIC
from sim_node import ColorConfig, DepthConfig, SegmentationConfig, SensorConfig

#: What a real RGB-D camera does to depth: noise that grows with the square, lost edges.
REAL_DEPTH: Final = DepthConfig(noise=0.0015, edge_dropout=0.5, edge_width=2)
_VGA: Final[Mapping[str, Any]] = {"width": 640, "height": 480}
#: A lens as those of cameras that see 60 degrees across, nearer than usual, so that blocks are in
#: more than the middle of the picture; barrel distortion moves its corners by 47 px, blocks by 7.
_WIDE: Final[Mapping[str, Any]] = {
    **_VGA, "vertical_fov": 0.8, "position": [1.1, 0.0, 0.38],
    "distortion": [-0.28, 0.09, 0.001, -0.0005, 0.0],
}  # fmt: skip


@dataclass(frozen=True)
class PictureSet:
    """A named set; its pictures are drawn by seeds from 1000 on.

    Attributes:
        name: what ``SET=`` takes.
        what: for the table.
        draw: scene, layout and seed of the n-th picture.
        count: of the pictures.
        sensor: what is wrong with the camera; its seed is the picture's.
        mask_source: of perception.
        graph: least share of right graphs; None: neither it nor ``accepted`` is required.
        accepted: least share of graphs that are accepted and right; every set is also held to one
            in a thousand accepted and wrong.
        iou: least mean IoU.
        thesis: its numbers for graph and IoU.
        sizes: bounds on the 99th percentile of the errors of centre and size of the accepted [mm].
        poses: bounds on median and 99th percentile of the centre's error [mm], median of yaw's [°].
    """

    name: str
    what: str
    draw: Callable[[int], Drawn]
    count: int = 1000
    sensor: SensorConfig = field(default_factory=SensorConfig)
    mask_source: str = RGBD
    graph: float | None = None
    accepted: float = 0.95
    iou: float | None = None
    thesis: tuple[float | None, float | None] = (None, None)
    sizes: tuple[float, float] | None = None
    poses: tuple[float, float, float] | None = None


def _with_label_error(kind: str, strength: int, count: int = 500) -> PictureSet:
    return PictureSet(
        f"labels_{kind}_{strength}",
        f"given masks {kind}, strength {strength}; 6 objects",
        plain(6),
        count,
        SensorConfig(segmentation=SegmentationConfig(kind, strength)),
        SEGMENTATION_TOPIC,
        graph=0.97,
    )


def _as_cameras_are(
    name: str, what: str, camera: Mapping[str, Any] = _VGA, **sensor: Any
) -> PictureSet:
    """Six blocks in the plain world, by a camera with what real ones have, masks found."""
    return PictureSet(
        name,
        f"6 objects, {what}, {camera['width']}x{camera['height']}",
        plain(6, **camera),
        sensor=SensorConfig(**sensor),
        graph=0.97,
        accepted=0.97,
    )


_REAL: Final = SensorConfig(depth=REAL_DEPTH)

SETS: Final = (
    PictureSet(
        "six", "D_sim, 6 objects, all states", state_of_six, 20_160,
        graph=0.998, iou=0.92, thesis=(0.867, 0.739),
    ),
    PictureSet(
        "seven", "D_sim, 7 objects", plain(7), 20_000,
        graph=0.995, iou=0.92, thesis=(0.884, 0.714),
    ),
    PictureSet("view_2", "camera +2°, 6 objects", turned(2.0), 2000,
               graph=0.995, iou=0.90, thesis=(0.882, 0.584)),
    PictureSet("view_10", "camera +10°, 6 objects", turned(10.0), 2000,
               graph=0.995, iou=0.90, thesis=(0.881, 0.561)),
    PictureSet("view_15", "camera +15°, 6 objects", turned(15.0), 2000,
               graph=0.995, iou=0.90, thesis=(0.843, 0.529)),
    PictureSet("six_noisy", "6 objects, depth of a real camera", plain(6), 2000, _REAL,
               graph=0.99, poses=(1.5, 6.0, 1.5)),
    PictureSet(
        "hard", "cubes 3-6 cm, yaw to 45°, clutter, real depth, 640x480, camera ±20°",
        solids(shapes=("box",), edges=(0.03, 0.06), cubes=True, clutter=True, azimuth=0.349,
               size=(640, 480)),
        2000, _REAL, graph=0.97,
    ),
    PictureSet(
        "solids", "cuboids and cylinders 3-7 cm, any yaw, exact depth",
        solids(shapes=("box", "cylinder"), edges=(0.03, 0.07)), 1000, sizes=(4.0, 4.0),
    ),
    PictureSet(
        "solids_noisy", "cuboids and cylinders 3-7 cm, any yaw, real depth",
        solids(shapes=("box", "cylinder"), edges=(0.03, 0.07)), 1000, _REAL, sizes=(4.0, 4.0),
    ),
    PictureSet(
        "two_rows", "two rows, 4 objects on 6 places, camera 0.5-0.75 m high", two_rows(4), 2309,
        graph=0.985, thesis=(0.8667, None),
    ),
    PictureSet(
        "two_rows_noisy", "two rows, 4 objects on 6 places, depth of a real camera", two_rows(4),
        1000, _REAL, graph=0.97,
    ),
    _as_cameras_are("blurred", "blurred by 1 px", color=ColorConfig(blur=1.0)),
    _as_cameras_are("jpeg", "blurred by 0.7 px, JPEG of quality 90",
                    color=ColorConfig(blur=0.7, jpeg_quality=90)),
    _as_cameras_are("shifted_depth", "depth 1 px beside colour",
                    depth=DepthConfig(shift=(1.0, 0.0))),
    _as_cameras_are("real_camera", "blur, noisy colours, real depth 1 px beside them",
                    color=ColorConfig(blur=0.8, noise=2.5),
                    depth=replace(REAL_DEPTH, shift=(1.0, 0.0))),
    _as_cameras_are("lens", f"through a wide lens, k1 = {_WIDE['distortion'][0]}", _WIDE),
    *(_with_label_error(kind, strength)
      for kind in ("eroded", "dilated", "shifted", "boundary") for strength in (1, 2)),
    _with_label_error("merged", 1),
    _with_label_error("split", 1),
    _with_label_error("speckled", 5),
)  # fmt: skip


class UnknownSetError(ValueError):
    """There is no set of that name; the sentence says which there are."""


def sets_named(names: str) -> tuple[PictureSet, ...]:
    """Those of a comma-separated list, all of them for an empty one; raises UnknownSetError."""
    if not names:
        return SETS
    known = {item.name: item for item in SETS}
    wanted = [name.strip() for name in names.split(",")]
    for name in wanted:
        if name not in known:
            raise UnknownSetError(f"{name!r} is no set; there are {', '.join(known)}")
    return tuple(known[name] for name in wanted)
