# SPDX-License-Identifier: Apache-2.0
"""Objects: the nodes of a scene graph, and how they are named by what can be seen."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Final

BOX: Final = "box"
CYLINDER: Final = "cylinder"
SPHERE: Final = "sphere"
#: A triangular prism that lies on one of its three long faces: a roof, its ridge along the second
#: of its own axes, above the middle of the first.
PRISM: Final = "prism"
SHAPES: Final = (BOX, CYLINDER, SPHERE, PRISM)
#: Shapes with a top that a block can stand on; from a sphere it rolls, from a ridge it slides.
FLAT_TOPPED: Final = (BOX, CYLINDER)

#: Colours that have a name, as sRGB in 0..1. They are far apart in CIE Lab, so that a rendered or
#: photographed block is named reliably under changing light.
COLORS: Final[dict[str, tuple[float, float, float]]] = {
    "red": (0.85, 0.10, 0.10),
    "green": (0.10, 0.60, 0.15),
    "blue": (0.10, 0.25, 0.85),
    "yellow": (0.95, 0.85, 0.10),
    "purple": (0.50, 0.15, 0.65),
    "orange": (0.98, 0.50, 0.05),
    "cyan": (0.15, 0.80, 0.85),
    "pink": (0.98, 0.55, 0.75),
    "brown": (0.45, 0.25, 0.10),
    "grey": (0.50, 0.50, 0.50),
    "black": (0.06, 0.06, 0.06),
    "magenta": (0.90, 0.10, 0.70),
    "mint": (0.60, 0.95, 0.75),
    "lavender": (0.70, 0.60, 1.00),
}

#: Of a block whose colour is none of these.
UNKNOWN: Final = "unknown"

#: The nine colours of scenes that nobody described otherwise: random scenes and data sets draw
#: from them, and they are what perception tells apart. The others are for scenes that name them.
BASIC_COLORS: Final = tuple(COLORS)[:9]


def object_name(color: str, shape: str) -> str:
    """``object_name("red", "box") == "red_box"``."""
    return f"{color}_{shape}"


def split_object_name(name: str) -> tuple[str, str]:
    """Colour and shape of a name; raises ValueError for a name that is not ``color_shape``."""
    color, _, shape = name.partition("_")
    if color not in COLORS or shape not in SHAPES:
        raise ValueError(
            f"{name!r} is not COLOR_SHAPE with a colour of {', '.join(COLORS)} "
            f"and a shape of {', '.join(SHAPES)}"
        )
    return color, shape


@dataclass(frozen=True)
class SceneObject:
    """A block as seen.

    Attributes:
        name: unique in its graph, e.g. ``red_box``.
        color, shape: as words; a colour that is none of ``COLORS`` is ``UNKNOWN``.
        position_world: centre (x, y, z) [m].
        quaternion_world: orientation (x, y, z, w), unit norm.
        size: full extents along the block's own axes (x, y, z) [m].
        label: of its mask in the picture; 0 if it did not come from an image.
        coordinates: φ = (a, b) of the visual module G, from the bottom-left corner, in 0..1.
        confidence: IoU(u, ũ) of A.2.5, lowered by hidden parts, in 0..1.
        alternatives: colours that it may have instead, the likeliest first; of a doubtful graph.
    """

    name: str
    color: str
    shape: str
    position_world: tuple[float, float, float] = (0.0, 0.0, 0.0)
    quaternion_world: tuple[float, float, float, float] = (0.0, 0.0, 0.0, 1.0)
    size: tuple[float, float, float] = (0.0, 0.0, 0.0)
    label: int = 0
    coordinates: tuple[float, float] = (0.0, 0.0)
    confidence: float = 1.0
    alternatives: tuple[str, ...] = ()

    @property
    def readings(self) -> tuple[str, ...]:
        """All colours that it may have, the likeliest first."""
        return ((self.color,) if self.color != UNKNOWN else ()) + self.alternatives
