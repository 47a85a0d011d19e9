# SPDX-License-Identifier: Apache-2.0
"""The parameters ``sensor.*``, and what they mean."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from typing import Any, Final

from tamp_runtime.parameters import ParameterSpec

from .config import (
    ENCODINGS,
    METRES,
    NO_DEPTH,
    ZERO,
    ColorConfig,
    DeliveryConfig,
    DepthConfig,
    SegmentationConfig,
    SensorConfig,
)
from .segmentation import KINDS

_RELIABLE: Final = "reliable"
_RELIABILITIES: Final = (_RELIABLE, "best_effort")
_OFF: Final = SensorConfig()


def _one_of(name: str, choices: Sequence[str]) -> Callable[[str], str]:
    """A check that a value is one of some words."""

    def problem(value: str) -> str:
        known = ", ".join(choices)
        return "" if value in choices else f"{name} = {value!r} is none of: {known}"

    problem.__doc__ = f"one of {', '.join(choices)}"
    return problem


def _cast_problem(values: Sequence[float]) -> str:
    """three numbers"""
    if len(values) == 3:
        return ""
    return f"sensor.color.cast has {len(values)} numbers; it needs those of red, green and blue"


def _shift_problem(values: Sequence[float]) -> str:
    """two numbers"""
    if len(values) == 2:
        return ""
    return f"sensor.depth.shift has {len(values)} numbers; it needs those to the right and down"


def _share(name: str, default: float, description: str) -> ParameterSpec:
    return ParameterSpec(name, default, f"{description} [0..1]", minimum=0.0, maximum=1.0)


SENSOR_PARAMETERS: Final = (
    ParameterSpec(
        "sensor.seed",
        _OFF.seed,
        "seed of all that is drawn for the cameras, together with the seed of the scene; a reset "
        "begins anew: the same seeds and scene give the same pictures",
        minimum=0,
        maximum=2**31 - 1,
    ),
    ParameterSpec(
        "sensor.depth.noise",
        _OFF.depth.noise,
        "standard deviation of depth at 1 m; it grows with the square of the distance [m]",
        minimum=0.0,
        maximum=0.1,
    ),
    ParameterSpec(
        "sensor.depth.noise_correlation",
        _OFF.depth.noise_correlation,
        "standard deviation of the Gaussian over which neighbours share that noise; 0: none [px]",
        minimum=0.0,
        maximum=20.0,
    ),
    _share(
        "sensor.depth.edge_dropout",
        _OFF.depth.edge_dropout,
        "probability with which a pixel near an edge of depth has none",
    ),
    ParameterSpec(
        "sensor.depth.edge_width",
        _OFF.depth.edge_width,
        "how near that is; 1: the pixels on both sides of the edge [px]",
        minimum=1,
        maximum=20,
    ),
    ParameterSpec(
        "sensor.depth.edge_step",
        _OFF.depth.edge_step,
        "difference of neighbouring depths at 1 m that makes an edge; it grows with the square of "
        "the distance [m]",
        minimum=0.001,
        maximum=1.0,
    ),
    _share(
        "sensor.depth.dropout",
        _OFF.depth.dropout,
        "probability with which any pixel has no depth",
    ),
    ParameterSpec(
        "sensor.depth.step",
        _OFF.depth.step,
        "step in which depth is quantised, at 1 m where it grows; 0: it is not [m]",
        minimum=0.0,
        maximum=0.1,
    ),
    ParameterSpec(
        "sensor.depth.step_grows",
        _OFF.depth.step_grows,
        "whether that step grows with the square of the distance, as that of disparities does",
    ),
    ParameterSpec(
        "sensor.depth.shift",
        list(_OFF.depth.shift),
        "how far right and down depth lies beside where it belongs in the colour picture, to the "
        "nearest pixel; what comes in from outside has no depth [px]",
        minimum=-100.0,
        maximum=100.0,
        check=_shift_problem,
    ),
    ParameterSpec(
        "sensor.depth.no_depth",
        ZERO,
        "what a pixel without depth holds in 32FC1; in 16UC1 it is always 0",
        check=_one_of("sensor.depth.no_depth", NO_DEPTH),
    ),
    ParameterSpec(
        "sensor.depth.encoding",
        METRES,
        "of the depth picture: metres (32FC1), or whole millimetres up to 65.535 m (16UC1)",
        check=_one_of("sensor.depth.encoding", ENCODINGS),
    ),
    ParameterSpec(
        "sensor.color.noise",
        _OFF.color.noise,
        "standard deviation of each channel of a pixel [0..255]",
        minimum=0.0,
        maximum=100.0,
    ),
    ParameterSpec(
        "sensor.color.exposure",
        _OFF.color.exposure,
        "factor of all channels; what gets above 255 saturates",
        minimum=0.0,
        maximum=20.0,
    ),
    ParameterSpec(
        "sensor.color.cast",
        list(_OFF.color.cast),
        "further factors of red, green and blue",
        minimum=0.0,
        maximum=20.0,
        check=_cast_problem,
    ),
    ParameterSpec(
        "sensor.color.blur",
        _OFF.color.blur,
        "standard deviation of the Gaussian over which lens and demosaicing smear light, before it "
        "saturates and noise is added; 0: none [px]",
        minimum=0.0,
        maximum=20.0,
    ),
    ParameterSpec(
        "sensor.color.jpeg_quality",
        _OFF.color.jpeg_quality,
        "quality of the JPEG that a picture has been, 1..100, with noise and all (by OpenCV, "
        "colours 4:2:0); 0: it has been none",
        minimum=0,
        maximum=100,
    ),
    ParameterSpec(
        "sensor.segmentation.kind",
        _OFF.segmentation.kind,
        "labels as they are, none at all (off), or what is wrong with them: every mask eroded or "
        "dilated, all of them shifted, outlines that wobble (boundary), single pixels with other "
        "labels (speckled), blocks that touch merged, blocks split or missing, phantom blocks on "
        "the table",
        check=_one_of("sensor.segmentation.kind", KINDS),
    ),
    ParameterSpec(
        "sensor.segmentation.strength",
        _OFF.segmentation.strength,
        "how wrong: by how many pixels (eroded, dilated, shifted, boundary), percent of the pixels "
        "(speckled), pairs of blocks (merged), or blocks (split, missing, phantom)",
        minimum=0,
        maximum=100,
    ),
    _share(
        "sensor.delivery.lost_pictures",
        _OFF.delivery.lost_pictures,
        "probability with which a picture is not taken",
    ),
    _share(
        "sensor.delivery.lost_messages",
        _OFF.delivery.lost_messages,
        "probability with which one message of a picture gets lost by itself",
    ),
    ParameterSpec(
        "sensor.delivery.delay",
        _OFF.delivery.delay,
        "from the stamp of a picture to its publication, in simulated time; rounded up to the "
        "next 1/60 s [s]",
        minimum=0.0,
        maximum=5.0,
    ),
    ParameterSpec(
        "sensor.delivery.jitter",
        _OFF.delivery.jitter,
        "further delay, drawn for each picture between 0 and this; none overtakes another [s]",
        minimum=0.0,
        maximum=5.0,
    ),
    ParameterSpec(
        "sensor.delivery.reliability",
        _RELIABLE,
        "of the cameras' publishers; of best-effort messages Fast DDS loses, between processes, "
        "what does not fit into its 0.5 MB of shared memory (a picture of 256x256 has 0.6 MB in "
        "all): some of small pictures, most of large ones",
        read_only=True,
        check=_one_of("sensor.delivery.reliability", _RELIABILITIES),
    ),
)


def sensor_from_parameters(values: Mapping[str, Any]) -> SensorConfig:
    """The configuration for a full set of parameter values; others among them are ignored."""

    def of(group: str) -> dict[str, Any]:
        prefix = f"sensor.{group}."
        return {
            name.removeprefix(prefix): value
            for name, value in values.items()
            if name.startswith(prefix)
        }

    depth, color, delivery = of("depth"), of("color"), of("delivery")
    right, down = depth.pop("shift")
    red, green, blue = color.pop("cast")
    reliable = delivery.pop("reliability") == _RELIABLE
    return SensorConfig(
        seed=values["sensor.seed"],
        depth=DepthConfig(**depth, shift=(right, down)),
        color=ColorConfig(**color, cast=(red, green, blue)),
        segmentation=SegmentationConfig(**of("segmentation")),
        delivery=DeliveryConfig(**delivery, reliable=reliable),
    )
