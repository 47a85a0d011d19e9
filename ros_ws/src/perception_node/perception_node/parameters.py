# SPDX-License-Identifier: Apache-2.0
"""The parameters of perception_node, and what they mean to the algorithm."""

from __future__ import annotations

import itertools
import math
from collections.abc import Iterable, Mapping
from dataclasses import replace
from typing import Any, Final

import numpy as np
from tamp_runtime.parameters import ParameterSpec

from .config import PerceptionConfig
from .places import Points
from .segment import SEGMENTERS

#: Least distance between two places [m].
MIN_GAP: Final = 0.02

_DEFAULT: Final = PerceptionConfig()


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
        "processor threads of the visual module",
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
    """The algorithm's configuration for a full set of parameter values."""
    return PerceptionConfig(
        mask_source=values["mask_source"],
        stack_positions=positions_from_parameter(values["stack_positions"]),
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
