# SPDX-License-Identifier: Apache-2.0
"""Families: from what the tasks of a campaign are drawn, and what a campaign has to reach."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field, replace
from typing import Any, Final

from scene_graph import BOX
from tasks.two_rows import TwoRows

#: Low and high end of what is drawn uniformly; of whole numbers both ends included.
Range = tuple[float, float]

#: The colours that the visual module was trained on; a task stays the same where more are known.
NINE_COLORS: Final = (
    "blue", "brown", "cyan", "green", "orange", "pink", "purple", "red", "yellow",
)  # fmt: skip


class UnknownFamilyError(ValueError):
    """There is no family of that name; the sentence says which there are."""


@dataclass(frozen=True)
class Row:
    """A row of places somewhere in reach, drawn anew for each task.

    Attributes:
        count: of the places.
        gap: between neighbours, of its own each time [m].
        reach: distance of every place from the arm's base, on the table [m].
        bearing: greatest angle of a place beside the arm's front, seen from its base [rad].
        turn: greatest angle between the row and the table's edge [rad].
    """

    count: tuple[int, int] = (2, 5)
    gap: Range = (0.12, 0.18)
    reach: Range = (0.38, 0.65)
    bearing: float = 0.75
    turn: float = 0.26


@dataclass(frozen=True)
class Viewpoint:
    """A camera that looks at the middle of the row from somewhere in front of it.

    It is as far away as it is today, or farther where not all places, with all blocks on any one
    of them, would be in the picture.

    Attributes:
        azimuth: greatest angle around the row's middle, from straight in front [rad].
        elevation: angle over the horizon [rad].
        distance: least horizontal distance from the row's middle [m].
        target_height: of what it looks at, over the table [m].
        vertical_fov: full opening angle [rad].
        size: edge of the square picture [px].
    """

    azimuth: float = 0.2618
    elevation: float = 0.2524
    distance: float = 0.95
    target_height: float = 0.155
    vertical_fov: float = 0.52
    size: int = 256


@dataclass(frozen=True)
class Family:
    """A named set of tasks; a task is drawn from it by its seed alone.

    What is None or empty is that of the plain world: three places in one row, boxes of 4.5 cm, one
    camera, perfect pictures, nothing that goes wrong.

    Attributes:
        name: what ``FAMILY=`` takes.
        what: for the table.
        blocks: how many.
        sizes: edge of a block, of its own each [m].
        shapes, colors: of the blocks, in families with scenes of their own.
        row: where the places are.
        rows: where they are where there are two rows of them; half of the goals then speak of what
            is in front of what.
        viewpoint: where the camera is.
        noise: parameters ``sensor.*`` of ``sim_node``; the seed of each task is added.
        masks: kinds of errors of the labels that the simulator publishes, each by one pixel, of
            which a task has one; they matter only where perception hears labels.
        mask_source: where perception gets its masks; empty: from where it does by default.
        disturbances: requests to ``sim/disturb``, of which a task has one when it begins.
        file: the result file's name in benchmarks/results; empty: ``tasks_NAME``.
        success, low: least success rate, and least lower end of its interval.
        seconds: greatest median of a task's wall time, one graph at a time [s]; None: no bound.
    """

    name: str
    what: str
    blocks: tuple[int, int]
    sizes: Range | None = None
    shapes: tuple[str, ...] = (BOX,)
    colors: tuple[str, ...] = NINE_COLORS
    row: Row | None = None
    rows: TwoRows | None = None
    viewpoint: Viewpoint | None = None
    noise: Mapping[str, Any] = field(default_factory=dict)
    masks: tuple[str, ...] = ()
    mask_source: str = ""
    disturbances: tuple[Mapping[str, Any], ...] = ()
    file: str = ""
    success: float | None = None
    low: float | None = None
    seconds: float | None = None

    @property
    def has_own_scenes(self) -> bool:
        """Whether each task needs a scene file, and so a graph, of its own."""
        return bool(self.sizes or self.row or self.rows or self.viewpoint or self.shapes != (BOX,))

    @property
    def result(self) -> str:
        """Name of its result file, without folder and ending."""
        return self.file or f"tasks_{self.name}"


def plain(name: str, blocks: int, **bounds: Any) -> Family:
    """Random start and complete random goal in the plain world."""
    what = f"{blocks} blocks, random start and goal"
    return Family(name, what, (blocks, blocks), file=f"tasks_{blocks}", **bounds)


#: What a real RGB-D camera does to the depth.
RGBD_CAMERA: Final[Mapping[str, Any]] = {
    "sensor.depth.noise": 0.0015,
    "sensor.depth.edge_dropout": 0.5,
    "sensor.depth.edge_width": 2,
}
#: What a good segmenter does to the masks.
MASK_ERRORS: Final = ("eroded", "dilated", "shifted", "boundary")
#: What passes, or can be repaired, while a task runs.
MISHAPS: Final[tuple[Mapping[str, Any], ...]] = (
    {"kind": "slip", "when": "in_air"},
    {"kind": "jam", "when": "grasp", "seconds": 4.0},
    {"kind": "cover", "what": "hand", "seconds": 4.0},
    {"kind": "cover", "what": "sheet", "seconds": 4.0},
    {"kind": "shove", "acceleration": 1.5},
    {"kind": "nudge"},
)

VARIED: Final = Family(
    "varied",
    "varied: sizes, places, camera, noise",
    blocks=(4, 6),
    sizes=(0.03, 0.06),
    row=Row(),
    viewpoint=Viewpoint(),
    noise=RGBD_CAMERA,
    masks=MASK_ERRORS,
    success=0.95,
)

FAMILIES: Final[tuple[Family, ...]] = (
    plain("three", 3),
    plain("four", 4),
    plain("five", 5),
    plain("six", 6, success=0.99, low=0.96, seconds=6.0),
    plain("seven", 7, success=0.99, low=0.96),
    VARIED,
    replace(
        VARIED,
        name="varied_masks",
        what="varied with masks of a detector: sizes, places, camera, noise, outlines",
        mask_source="segmentation_topic",
    ),
    Family(
        "color",
        "6 blocks, a camera without depth",
        blocks=(6, 6),
        mask_source="rgb",
    ),
    Family(
        "two_rows",
        "two rows: 4 blocks on 6 places, some behind others",
        blocks=(4, 4),
        rows=TwoRows(),
        success=0.98,
    ),
    Family(
        "disturbed",
        "6 blocks, one disturbance a task",
        blocks=(6, 6),
        disturbances=MISHAPS,
    ),
)


def family_named(name: str) -> Family:
    """The family of a name; raises UnknownFamilyError."""
    for family in FAMILIES:
        if family.name == name:
            return family
    known = ", ".join(family.name for family in FAMILIES)
    raise UnknownFamilyError(f"{name!r} is no family of tasks; there are {known}")


def family_of(blocks: int) -> Family:
    """The plain family of so many blocks; raises UnknownFamilyError."""
    for family in FAMILIES:
        if family.result == f"tasks_{blocks}":
            return family
    raise UnknownFamilyError(f"{blocks} blocks asked for; plain families have 3 to 7")
