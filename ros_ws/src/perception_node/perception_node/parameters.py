# SPDX-License-Identifier: Apache-2.0
"""The parameters of perception_node, and what they mean to the algorithm."""

from __future__ import annotations

import itertools
import math
import re
from collections.abc import Iterable, Mapping
from dataclasses import replace
from typing import Any, Final

import numpy as np
from tamp_runtime.parameters import ParameterSpec

from .config import PerceptionConfig, PlaceSearch
from .places import Points
from .segment import RGB, SEGMENTERS

#: Where the places come from, as the parameter ``places`` has it.
GIVEN: Final = "given"
FOUND: Final = "found"

#: Least distance between two places [m].
MIN_GAP: Final = 0.02

_DEFAULT: Final = PerceptionConfig()
_SEARCH: Final = _DEFAULT.search


def positions_from_parameter(values: Iterable[float]) -> Points:
    """x, y, z of the first place, of the second, …; raises ValueError for a broken triple."""
    numbers = [float(value) for value in values]
    if len(numbers) % 3:
        raise ValueError(f"needs x, y, z of each place, but has {len(numbers)} numbers")
    return tuple((x, y, z) for x, y, z in zip(numbers[0::3], numbers[1::3], numbers[2::3]))


def _positions_problem(values: Any) -> str:
    try:
        positions = positions_from_parameter(values)
    except ValueError as error:
        return f"stack_positions {error}"
    if not np.isfinite(values).all():
        return "stack_positions must be finite"
    if any(math.dist(a, b) <= MIN_GAP for a, b in itertools.combinations(positions, 2)):
        return "stack_positions has places less than 2 cm apart"
    return ""


def _mask_source_problem(value: Any) -> str:
    """One of rgbd, rgb, segmentation_topic."""
    if value in SEGMENTERS:
        return ""
    return f"mask_source is {value!r}; there are {', '.join(SEGMENTERS)}"


def _cameras_problem(values: Any) -> str:
    """Names of one camera or more."""
    fits = values and all(re.fullmatch(r"[a-z]\w*(/[a-z]\w*)*", name) for name in values)
    if fits and len(set(values)) == len(values):
        return ""
    return f"cameras is {list(values)}; needs the names with which their topics begin, each once"


def _places_problem(value: Any) -> str:
    """One of given, found."""
    if value in (GIVEN, FOUND):
        return ""
    return f"places is {value!r}; there are {GIVEN}, {FOUND}"


def _reach_problem(values: Any) -> str:
    """Least and greatest distance."""
    if len(values) == 2 and values[0] < values[1]:
        return ""
    return f"place_reach is {list(values)}; needs the least distance and the greatest"


PARAMETERS: Final = (
    ParameterSpec(
        "weights",
        "",
        "weights file of the visual module (safetensors); empty: those of the package",
        read_only=True,
    ),
    ParameterSpec(
        "mask_source",
        _DEFAULT.mask_source,
        "where the blocks' pixels come from: rgbd (found in colour and depth), rgb (found in "
        "colour alone, no depth is heard) or segmentation_topic (camera/segmentation, of a "
        "detector of your own)",
        read_only=True,
        check=_mask_source_problem,
    ),
    ParameterSpec(
        "cameras",
        ["camera"],
        "whose pictures are looked at: with what their topics begin, as in camera/image_raw. Of "
        "several, what they see of one moment is joined; what is left and in front is so for the "
        "first. One that falls silent is left out, and message says so",
        read_only=True,
        check=_cameras_problem,
    ),
    ParameterSpec(
        "rectified",
        False,
        "the pictures have no distortion though camera_info's d says so, as those of image_rect",
        read_only=True,
    ),
    ParameterSpec(
        "world_frame",
        "world",
        "in which poses are where the camera's place is found in tf_static, for lack of "
        "camera/extrinsics, which name their own",
        read_only=True,
    ),
    ParameterSpec(
        "pairing_tolerance",
        0.0,
        "stamps of pictures taken together may differ by this; less than half of the time between "
        "two pictures [s]",
        minimum=0.0,
        maximum=0.5,
        read_only=True,
    ),
    ParameterSpec(
        "threads",
        1,
        "processor threads of the visual module, and of OpenCV",
        minimum=1,
        maximum=64,
        read_only=True,
    ),
    ParameterSpec(
        "record",
        "",
        "folder in which to keep pictures for train_visual, one whenever a block stands elsewhere; "
        "empty: none are kept",
        read_only=True,
    ),
    ParameterSpec(
        "stack_positions",
        [value for position in _DEFAULT.stack_positions for value in position],
        "x, y, z of each place on the table, from the left of the image, one after the other; of "
        "two rows those of the one that is nearer to the camera first [m]",
        minimum=-10.0,
        maximum=10.0,
        check=_positions_problem,
    ),
    ParameterSpec(
        "places",
        GIVEN,
        "where the places come from: given (stack_positions) or found: in the first picture whose "
        "graph can be planned on, wherever a stack stands, and again when the service find_places "
        "is called; in between they stay. Of stack_positions only the height of the table is used "
        "then. Whatever in reach looks like a block counts as a stack",
        read_only=True,
        check=_places_problem,
    ),
    ParameterSpec(
        "place_count",
        _SEARCH.count,
        "how many places there are to be where they are found; beside the stacks free ones are "
        "laid, on the line through them (of one stack: across the view), each at place_gap from "
        "the nearest other one, or as little more as there is room, in reach, in the picture, and "
        "where nothing but table is seen; 0: as many as there are stacks, none of them free",
        minimum=0,
        maximum=8,
    ),
    ParameterSpec(
        "place_gap",
        _SEARCH.gap,
        "how far free places are from others, so that the hand has room; stacks that are found may "
        "be nearer to one another by 15 mm [m]",
        minimum=0.06,
        maximum=1.0,
    ),
    ParameterSpec(
        "place_reach",
        list(_SEARCH.reach),
        "least and greatest distance from the arm's axis, the z axis of the world, at which places "
        "are found [m]",
        minimum=0.0,
        maximum=5.0,
        check=_reach_problem,
    ),
    ParameterSpec(
        "min_confidence",
        _DEFAULT.min_confidence,
        "least confidence (A.2.5) of a graph that may be planned on [0..1]",
        minimum=0.0,
        maximum=1.0,
    ),
    ParameterSpec(
        "max_hidden",
        _DEFAULT.max_hidden,
        "greatest share of the column over a place that something other than a block may hide "
        "in a graph that may be planned on [0..1]",
        minimum=0.0,
        maximum=1.0,
    ),
    ParameterSpec(
        "column_half_width",
        _DEFAULT.column_half_width,
        "half the side of the column over a place in which blocks can stand [m]",
        minimum=0.005,
        maximum=1.0,
    ),
    ParameterSpec(
        "column_height",
        _DEFAULT.column_height,
        "height of that column [m]",
        minimum=0.02,
        maximum=3.0,
    ),
    ParameterSpec(
        "smallest_block",
        _DEFAULT.smallest_block,
        "edge of the smallest cube that there may be [m]; of two rows of places, what is behind "
        "blocks counts as hidden where one of that size fits unseen",
        minimum=0.01,
        maximum=0.2,
    ),
    ParameterSpec(
        "place_tolerance",
        _DEFAULT.limits.place_tolerance,
        "how far beside its place's centre the lowest block may stand [m]",
        minimum=0.001,
        maximum=1.0,
    ),
    ParameterSpec(
        "support_gap",
        _DEFAULT.limits.gap,
        "height that may be measured between a block and what it stands on [m]",
        minimum=0.001,
        maximum=0.1,
    ),
    ParameterSpec(
        "max_tilt",
        _DEFAULT.limits.tilt,
        "angle by which a standing block may lean [rad]",
        minimum=0.01,
        maximum=1.0,
    ),
    ParameterSpec(
        "max_doubt",
        _DEFAULT.limits.doubt,
        "standard deviation with which a block's centre may be known in a graph that may be "
        "planned on; three times as much where it follows from colour alone [m]",
        minimum=0.0005,
        maximum=0.1,
    ),
)


def config_from_parameters(values: Mapping[str, Any]) -> PerceptionConfig:
    """The algorithm's configuration for a full set of parameter values.

    Where places are to be found it has none.

    Raises:
        ValueError: if places cannot be found from this source of masks, or cameras not be joined.
    """
    positions = positions_from_parameter(values["stack_positions"])
    to_find = values["places"] == FOUND
    if to_find and values["mask_source"] == RGB:
        raise ValueError("places are found in depth, which mask_source rgb has not; set it to rgbd")
    if values["cameras"][1:] and (to_find or values["mask_source"] == RGB):
        raise ValueError(
            "several cameras are joined by depth, at places that are given; set mask_source to "
            "rgbd, and places to given, or name one camera"
        )
    nearest, farthest = values["place_reach"]
    return PerceptionConfig(
        mask_source=values["mask_source"],
        stack_positions=() if to_find else positions,
        search=PlaceSearch(
            count=values["place_count"],
            gap=values["place_gap"],
            reach=(nearest, farthest),
            table_height=float(np.median([z for _, _, z in positions] or [0.0])),
        ),
        min_confidence=values["min_confidence"],
        max_hidden=values["max_hidden"],
        column_half_width=values["column_half_width"],
        column_height=values["column_height"],
        smallest_block=values["smallest_block"],
        limits=replace(
            _DEFAULT.limits,
            place_tolerance=values["place_tolerance"],
            gap=values["support_gap"],
            tilt=values["max_tilt"],
            doubt=values["max_doubt"],
        ),
    )
