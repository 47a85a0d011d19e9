# SPDX-License-Identifier: Apache-2.0
"""From camera images to scene graphs.

What a notebook needs stands here; none of it knows ROS::

    from perception_node import Observation, Perception, PinholeCamera, load_weights

    perception = Perception(load_weights())
    camera = PinholeCamera(intrinsics, world_from_optical, width, height)
    seen = perception.perceive(Observation(rgb, labels, depth, camera))
    print(seen.status, seen.graph.stacks())

:mod:`perception_node.pipeline` reads from top to bottom what happens in between.
"""

from __future__ import annotations

import importlib
from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
    from .camera import PinholeCamera
    from .config import PerceptionConfig, PlaceSearch, StabilityLimits
    from .drawing import draw_scene_graph
    from .errors import BadImageError, PerceptionError, WeightsError
    from .observation import Observation
    from .pipeline import Perceived, Perception
    from .places import Places, RowOfPlaces, Standing
    from .segment import Segment, Segmenter, Segments, Volume, given_labels
    from .visual_module.coordinates import Coordinates, Locator
    from .visual_module.mask_centroid import MaskCentroid
    from .visual_module.object_images import ObjectImages
    from .visual_module.visual_module import VisualModule
    from .visual_module.weights import DEFAULT_WEIGHTS, load_weights

#: Where each name comes from; imported when it is first asked for: an executable listens to Ctrl-C
#: before such imports, and only what learnt needs torch.
_HOMES = {
    "DEFAULT_WEIGHTS": "visual_module.weights",
    "BadImageError": "errors",
    "Coordinates": "visual_module.coordinates",
    "Locator": "visual_module.coordinates",
    "MaskCentroid": "visual_module.mask_centroid",
    "ObjectImages": "visual_module.object_images",
    "Observation": "observation",
    "Perceived": "pipeline",
    "Perception": "pipeline",
    "PerceptionConfig": "config",
    "PerceptionError": "errors",
    "PinholeCamera": "camera",
    "PlaceSearch": "config",
    "Places": "places",
    "RowOfPlaces": "places",
    "Segment": "segment",
    "Segmenter": "segment",
    "Segments": "segment",
    "StabilityLimits": "config",
    "Standing": "places",
    "VisualModule": "visual_module.visual_module",
    "Volume": "segment",
    "WeightsError": "errors",
    "draw_scene_graph": "drawing",
    "given_labels": "segment",
    "load_weights": "visual_module.weights",
}

__all__ = [
    "DEFAULT_WEIGHTS",
    "BadImageError",
    "Coordinates",
    "Locator",
    "MaskCentroid",
    "ObjectImages",
    "Observation",
    "Perceived",
    "Perception",
    "PerceptionConfig",
    "PerceptionError",
    "PinholeCamera",
    "PlaceSearch",
    "Places",
    "RowOfPlaces",
    "Segment",
    "Segmenter",
    "Segments",
    "StabilityLimits",
    "Standing",
    "VisualModule",
    "Volume",
    "WeightsError",
    "draw_scene_graph",
    "given_labels",
    "load_weights",
]


def __getattr__(name: str) -> Any:
    if name not in _HOMES:
        raise AttributeError(f"module {__name__!r} has no attribute {name!r}")
    return getattr(importlib.import_module(f".{_HOMES[name]}", __name__), name)
