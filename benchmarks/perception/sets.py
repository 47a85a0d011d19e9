# SPDX-License-Identifier: Apache-2.0
"""Sets of pictures: what is drawn, how the camera errs, and what perception has to reach."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass, field, replace
from typing import Any, Final

from perception.damages import (
    OF_LABELS,
    OF_PICTURES,
    Damage,
    Shot,
    half_hidden,
    no_depth,
)
from perception.scenes import (
    Drawn,
    any_number,
    behind_a_thing,
    beside_the_picture,
    between_colors,
    colored,
    low_rows,
    plain,
    shifted_stacks,
    solids,
    state_of_six,
    turned,
    two_rows,
)
from perception_node import Observation
from perception_node.segment import RGB, RGBD, SEGMENTATION_TOPIC
from scene_graph import BASIC_COLORS, COLORS
from sim_node import ColorConfig, DepthConfig, SegmentationConfig, SensorConfig

#: What a real RGB-D camera does to depth: noise that grows with the square, lost edges.
REAL_DEPTH: Final = DepthConfig(noise=0.0015, edge_dropout=0.5, edge_width=2)
Range = tuple[float, float]
#: Colours that no data set for training has.
UNSEEN_COLORS: Final = tuple(color for color in COLORS if color not in BASIC_COLORS)
HALF_HIDDEN: Final = "half of one block lost"
#: What is done with masks where depth is there as well.
SNAPPED: Final = "masks are made those of what is found in colour and depth: little is left"
#: What is looked through, where it is asked how much more two cameras see.
HOW: Final = {1: "the first of two cameras", 2: "from the front and from the side"}
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
        accepted: least share of graphs that are accepted and right; every set that is ``settled``
            is also held to one in a thousand accepted and wrong.
        iou: least mean IoU.
        thesis: its numbers for graph and IoU.
        sizes: bounds on the 99th percentile of the errors of centre and size of the accepted [mm].
        damage: what becomes of the picture then; what is wrong with it has to be noticed, and no
            more: of how many graphs are right or accepted nothing is required.
        names: greatest shares of blocks that have a wrong name in a confident graph, and that have
            no name; None: not counted.
        shapes: least share of blocks with the right shape; None: not counted.
        baselines: whether the centroids of masks stand beside the visual module, or with masks from
            colour alone clusters of colours beside the network.
        told: whether colour and depth can tell what is wrong with the picture, without the arm.
        settled: whether anything in the picture contradicts what is wrong; where nothing does,
            nothing is required of it alone.
        note: what has to be known to read the rows.
        found: how many places are to be found, 0: as many as stacks; None: they are given.
        between: whether colours may be in doubt, and what is published of that is counted.
        cameras: how many are looked through, where it is asked how much more several see; else 0.
        after: whether it comes after a whole picture of the earlier state, and depth of the first
            move from there: what a camera whose colours froze sends.
        as_high: whether the stacks of the earlier state are as high as those of now.
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
    damage: Damage | None = None
    names: tuple[float, float] | None = None
    shapes: float | None = None
    baselines: bool = False
    told: bool = True
    settled: bool = True
    between: bool = False
    found: int | None = None
    cameras: int = 0
    after: bool = False
    as_high: bool = False
    note: str | None = None


def _with_label_error(kind: str, strength: int, count: int = 500) -> PictureSet:
    return PictureSet(
        f"labels_{kind}_{strength}",
        f"given masks {kind}, strength {strength}; 6 objects",
        plain(6),
        count,
        SensorConfig(segmentation=SegmentationConfig(kind, strength)),
        SEGMENTATION_TOPIC,
        graph=0.97,
        note=SNAPPED,
    )


def _of_masks_alone(kind: str, strength: int, damage: Damage = no_depth) -> PictureSet:
    """Without depth, where stacks follow from the masks' coordinates alone."""
    exact = SegmentationConfig() if kind in ("exact", HALF_HIDDEN) else None
    return PictureSet(
        f"masks_{kind.replace(' ', '_')}_{strength}",
        f"given masks {kind}, strength {strength}, no depth; 6 objects",
        plain(6),
        500,
        SensorConfig(segmentation=exact or SegmentationConfig(kind, strength)),
        SEGMENTATION_TOPIC,
        graph=0.97,
        damage=damage,
        baselines=True,
        note="stacks follow from the masks alone, and places from the camera",
    )


def _damaged(name: str, what: str, damage: Damage, mask_source: str = RGBD) -> PictureSet:
    told = name != "mirrored"
    same = "a picture of another state of the table looks the same, but for the arm"
    return PictureSet(
        f"damage_{name}", what, plain(6), 200, mask_source=mask_source, damage=damage, told=told,
        note=None if told else same,
    )  # fmt: skip


def _color_frozen(name: str, what: str, **more: Any) -> PictureSet:
    """Colours of an earlier state that depth of now does not contradict, or not at once."""
    damaged = _damaged("color_frozen", *OF_PICTURES["color_frozen"])
    return replace(damaged, name=f"damage_color_{name}", what=what, **more)


def _lit(
    name: str, exposure: Range = (0.85, 1.1), red: Range = (1.0, 1.0), blue: Range = (1.0, 1.0)
) -> PictureSet:
    return PictureSet(
        f"names_{name}",
        f"3-7 blocks of 14 colours, {name} light",
        colored(tuple(COLORS), exposure, red, blue),
        500,
        names=(0.0005, 0.03),
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


def _of_color_alone(
    name: str, what: str, draw: Callable[[int], Drawn], graph: float, **more: Any
) -> PictureSet:
    """Neither depth nor masks are there."""
    return PictureSet(
        f"rgb_{name}", f"colour alone, {what}", draw, mask_source=RGB, graph=graph, baselines=True,
        note="poses follow from outlines, the table and the places", **more,
    )  # fmt: skip


def _half_hidden_without_depth(seen: Observation, shot: Shot) -> Observation:
    return no_depth(half_hidden(seen, shot), shot)


_REAL: Final = SensorConfig(depth=REAL_DEPTH)
_SEEN_BEFORE: Final = "a node has seen the whole picture before, and depth of the move"

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
    *(PictureSet(
        f"{name}_{count}_cameras" if count > 1 else f"{name}_1_camera",
        f"{what}, {count} camera{'s' * (count > 1)}", draw, 500, _REAL, cameras=count,
        told=count > 1,
        graph=0.97 if count > 1 else None, note=f"real depth; {HOW[count]}",
    ) for name, what, draw in (
        ("rows", "two rows from low, 6 objects", low_rows(6)),
        ("thing", "6 objects, a thing before them", behind_a_thing(6)),
    ) for count in (1, 2)),
    _of_color_alone("six", "6 objects", plain(6), 0.97),
    _of_color_alone(
        "hard", "cubes 3-6 cm, yaw to 45°, clutter, 640x480, camera ±20°",
        solids(shapes=("box",), edges=(0.03, 0.06), cubes=True, clutter=True, azimuth=0.349,
               size=(640, 480)), 0.93,
    ),
    _of_color_alone(
        "light", "3-7 blocks of 14 colours, any light",
        colored(tuple(COLORS), (0.5, 1.1), (0.8, 1.2), (0.75, 1.2)), 0.93,
    ),
    _of_color_alone("real_camera", "6 objects, blur, noise, JPEG of quality 90, 640x480",
                    plain(6, **_VGA), 0.97,
                    sensor=SensorConfig(color=ColorConfig(blur=0.8, noise=2.5, jpeg_quality=90))),
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
    replace(_with_label_error("exact", 1), name="labels_half_hidden", damage=half_hidden,
            what=f"given masks, {HALF_HIDDEN}; 6 objects"),
    *(_of_masks_alone(kind, strength)
      for kind, strength in (
          ("exact", 1), ("eroded", 2), ("dilated", 2), ("shifted", 2), ("boundary", 2),
          ("merged", 1), ("split", 1), ("speckled", 5),
      )),
    _of_masks_alone(HALF_HIDDEN, 1, _half_hidden_without_depth),
    *(PictureSet(f"{name}_{much}", f"{what}, ε ≤ {most:g} blocks; 6 objects",
                 shifted_stacks(most), 500, graph=0.99, iou=0.88, thesis=thesis, found=found,
                 note=note)
      for name, what, found, note in (
          ("shifted", "stacks shifted", None, "places given"),
          ("found", "places found, stacks shifted", 3, "in one picture, free places laid"))
      for much, most, thesis in (("half", 0.5, (0.892, 0.726)), ("one", 1.0, (0.902, 0.724)),
                                 ("two", 2.0, (0.902, 0.701)))),
    PictureSet(
        "found_anywhere", "places found, 1-5 stacks of cubes 3-6 cm in reach, yaw to 45°, real "
        "depth, 640x480, camera ±15°",
        solids(shapes=("box",), edges=(0.03, 0.06), cubes=True, size=(640, 480)),
        1000, _REAL, graph=0.97, found=0, note="as many places as stacks",
    ),
    _lit("white"),
    _lit("warm", red=(1.05, 1.2), blue=(0.7, 0.9)),
    _lit("cool", red=(0.75, 0.92), blue=(1.08, 1.25)),
    _lit("dim", exposure=(0.4, 0.7)),
    PictureSet("between", "4-6 blocks, paint of one or two between two colours",
               between_colors(), between=True, told=False,
               note="20 to 50 % of another colour; which name is right is in doubt"),
    PictureSet("shapes", "boxes and cylinders of colours not seen, with depth",
               colored(UNSEEN_COLORS, shapes=("box", "cylinder")), 500, shapes=0.99,
               thesis=(None, None)),
    PictureSet("shapes_no_depth", "boxes and cylinders of colours not seen, given masks, no depth",
               colored(UNSEEN_COLORS, shapes=("box", "cylinder")), 500,
               mask_source=SEGMENTATION_TOPIC, damage=no_depth, shapes=0.99),
    *(_damaged(name, *entry) for name, entry in OF_PICTURES.items()),
    _color_frozen("froze", "colours froze before the first move, depth not", after=True,
                  note=_SEEN_BEFORE),
    _color_frozen("as_high", "colours frozen, depth not, stacks as high as now", as_high=True,
                  told=False, settled=False,
                  note="depth of both states is the same: one picture cannot tell, see the next"),
    _color_frozen("froze_as_high", "colours froze before the first move, stacks as high as now",
                  as_high=True, after=True, told=False, note=_SEEN_BEFORE),
    *(_damaged(name, *entry, SEGMENTATION_TOPIC) for name, entry in OF_LABELS.items()),
    *(replace(_damaged(name, *OF_PICTURES[name], RGB), name=f"rgb_{name}",
              what=f"colour alone, {OF_PICTURES[name][0]}")
      for name in ("black", "white", "one_color", "upside_down", "half_lost")),
    PictureSet("any_number", "1 to 12 blocks", any_number, 300),
    PictureSet("outside", "blocks outside the picture", beside_the_picture, 300),
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
