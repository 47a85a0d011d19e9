# SPDX-License-Identifier: Apache-2.0
"""What is wrong with a camera; by default nothing."""

from __future__ import annotations

from dataclasses import dataclass, field
from typing import Final

#: Encodings of depth pictures: metres, or whole millimetres in which 0 stands for none (REP 118).
METRES: Final = "32FC1"
MILLIMETRES: Final = "16UC1"
ENCODINGS: Final = (METRES, MILLIMETRES)

#: What a pixel without a depth holds where depth is in metres.
ZERO: Final = "zero"
NAN: Final = "nan"
NO_DEPTH: Final = (ZERO, NAN)

#: Kinds of segmentation that are no error: as it is, and none at all.
EXACT: Final = "exact"
OFF: Final = "off"


@dataclass(frozen=True)
class DepthConfig:
    """Errors of depth, as those of a camera that measures disparities d ∝ 1/z.

    Attributes:
        noise: standard deviation at 1 m; σ(z) = noise·z² [m].
        noise_correlation: standard deviation of the Gaussian over which the noise of neighbouring
            pixels is averaged [px]; 0: each has its own.
        edge_dropout: probability with which a pixel near an edge has no depth.
        edge_width: how far from an edge that is, 1 for the pixels on both of its sides [px].
        edge_step: difference of neighbouring depths at 1 m that makes an edge; it grows with z²,
            so that a table seen from its side has none [m].
        dropout: probability with which any pixel has no depth.
        step: of the quantisation, at 1 m where it grows [m]; 0: not quantised.
        step_grows: with z², as where disparities are whole multiples; else it is the same anywhere.
        shift: how far right and down depth lies beside where it belongs in the colour picture, to
            the nearest pixel: registration that is not perfect [px].
        no_depth: ZERO or NAN, what stands for no depth; in MILLIMETRES it is always 0.
        encoding: METRES or MILLIMETRES.
    """

    noise: float = 0.0
    noise_correlation: float = 0.0
    edge_dropout: float = 0.0
    edge_width: int = 2
    edge_step: float = 0.015
    dropout: float = 0.0
    step: float = 0.0
    step_grows: bool = True
    shift: tuple[float, float] = (0.0, 0.0)
    no_depth: str = ZERO
    encoding: str = METRES

    @property
    def is_exact(self) -> bool:
        """Whether pictures stay what they are; their encoding is another matter."""
        errors = (self.noise, self.edge_dropout, self.dropout, self.step, *self.shift)
        return not any(errors) and self.no_depth == ZERO


@dataclass(frozen=True)
class ColorConfig:
    """Errors of colour.

    Attributes:
        noise: standard deviation, of each channel of each pixel by itself [0..255].
        exposure: factor of all values before they saturate.
        cast: further factors of red, green and blue.
        blur: standard deviation of the Gaussian that lens and demosaicing smear light over, before
            it saturates [px]; 0: none.
        jpeg_quality: of the compression that pictures have gone through, 1..100; 0: none.
    """

    noise: float = 0.0
    exposure: float = 1.0
    cast: tuple[float, float, float] = (1.0, 1.0, 1.0)
    blur: float = 0.0
    jpeg_quality: int = 0

    @property
    def is_exact(self) -> bool:
        """Whether pictures stay what they are."""
        return self == ColorConfig()


@dataclass(frozen=True)
class SegmentationConfig:
    """Errors of the instance labels.

    Attributes:
        kind: EXACT, OFF (none is published) or a key of :data:`.segmentation.ERRORS`.
        strength: its unit is that of the kind: pixels, percent of the pixels, or how many blocks.
    """

    kind: str = EXACT
    strength: int = 1

    @property
    def is_exact(self) -> bool:
        """Whether labels stay what they are."""
        return self.kind in (EXACT, OFF) or self.strength == 0


@dataclass(frozen=True)
class DeliveryConfig:
    """What happens to pictures between sensor and subscribers.

    Attributes:
        lost_pictures: probability with which a whole picture is never taken.
        lost_messages: probability with which one message of a picture (colour, depth, labels, each
            camera info) gets lost by itself.
        delay: from taking a picture to publishing it, in simulated time [s].
        jitter: further delay, drawn for each picture between 0 and this [s].
        reliable: whether publishers are reliable, or best effort.
    """

    lost_pictures: float = 0.0
    lost_messages: float = 0.0
    delay: float = 0.0
    jitter: float = 0.0
    reliable: bool = True


@dataclass(frozen=True)
class SensorConfig:
    """What is wrong with a camera, and the seed of all that is drawn for it."""

    seed: int = 0
    depth: DepthConfig = field(default_factory=DepthConfig)
    color: ColorConfig = field(default_factory=ColorConfig)
    segmentation: SegmentationConfig = field(default_factory=SegmentationConfig)
    delivery: DeliveryConfig = field(default_factory=DeliveryConfig)

    @property
    def is_exact(self) -> bool:
        """Whether pictures stay what they are."""
        return self.depth.is_exact and self.color.is_exact and self.segmentation.is_exact
