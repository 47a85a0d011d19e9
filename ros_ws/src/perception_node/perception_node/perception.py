# SPDX-License-Identifier: Apache-2.0
"""From one camera frame to a scene graph with a verdict: the visual module and all around it."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, field, replace
from typing import Any, Protocol

import numpy as np
from numpy.typing import NDArray

from scene_graph import (
    UP,
    GraphStatus,
    Place,
    Relation,
    SceneGraph,
    SceneObject,
    Stacks,
    base_name,
    left_relations,
    up_relations,
)

from .block_poses import BlockPose, block_poses
from .block_surface import BlockSurface, measure_block
from .camera_model import PinholeCamera
from .errors import BadImageError, PerceptionError
from .masks import ObjectImages, largest_part, object_images
from .naming import color_names, mean_colors, unique_names
from .shape_outline import shape_from_outline
from .stability import StabilityLimits, instability
from .stack_count import count_stacks
from .stacks_from_coordinates import assign_places, stacks_from_coordinates, with_empty_places
from .visibility import PlaceVolumes, box_region, hidden_pixels
from .visual_module import Coordinates


@dataclass(frozen=True)
class PerceptionConfig:
    """What perception knows of the scene, and what it accepts.

    Attributes:
        stack_positions: centres of the m places on the table, from the left of the image [m]; none
            where the places are unknown, which leaves left-relations instead of bases.
        min_confidence: least confidence of a confident graph (A.2.5).
        max_hidden: greatest hidden share of the column over a place.
        column_half_width, column_height: of the columns in which blocks can stand [m].
        limits: what counts as standing.
    """

    stack_positions: tuple[tuple[float, float, float], ...] = (
        (0.5, -0.15, 0.0),
        (0.5, 0.0, 0.0),
        (0.5, 0.15, 0.0),
    )
    min_confidence: float = 0.6
    max_hidden: float = 0.005
    column_half_width: float = 0.035
    column_height: float = 0.36
    limits: StabilityLimits = field(default_factory=StabilityLimits)


class Locator(Protocol):
    """Whatever finds the coordinates of objects: the visual module, or the baseline."""

    def locate(self, objects: ObjectImages) -> Coordinates: ...


@dataclass(frozen=True)
class Perceived:
    """A scene graph, whether it can be used, and a sentence saying why not (or empty)."""

    graph: SceneGraph
    status: GraphStatus
    message: str = ""


class Perception:
    """Interprets frames. Keeps nothing between them, so it can be used from several threads."""

    def __init__(self, module: Locator, config: PerceptionConfig | None = None) -> None:
        self.module = module
        self.config = config or PerceptionConfig()

    def perceive(
        self,
        rgb: NDArray[np.uint8],
        labels: NDArray[np.integer],
        depth: NDArray[np.floating] | None = None,
        camera: PinholeCamera | None = None,
    ) -> Perceived:
        """Interprets one frame. Whatever is wrong with it is told by status and message.

        Args:
            rgb: shape (height, width, 3).
            labels: instance labels, 0 = none, shape (height, width).
            depth: along the optical axis [m], shape (height, width); without it there are no
                poses, and nothing is said about hidden or unstable blocks.
            camera: without it there are neither poses nor bases.
        """
        try:
            _check_frame(rgb, labels, depth)
            if camera is not None:
                camera = camera.resized(labels.shape[1], labels.shape[0])
            return self._perceive(rgb, labels, depth, camera)
        except PerceptionError as error:
            return self.rejected(GraphStatus.BAD_IMAGE, str(error))

    def rejected(self, status: GraphStatus, message: str) -> Perceived:
        """An empty graph with the reason for it."""
        places = tuple(Place(i, position) for i, position in enumerate(self.config.stack_positions))
        return Perceived(SceneGraph((), frozenset(), places, 0.0), status, message)

    def _perceive(
        self,
        rgb: NDArray[np.uint8],
        labels: NDArray[np.integer],
        depth: NDArray[np.floating] | None,
        camera: PinholeCamera | None,
    ) -> Perceived:
        hidden_mask, hidden = self._hidden(labels, depth, camera)
        objects = object_images(rgb, labels)
        if len(objects) == 0:
            if verdict := self._occlusion(hidden):
                return self.rejected(GraphStatus.OCCLUDED, verdict)
            return self.rejected(
                GraphStatus.NO_OBJECTS,
                "no block is seen; put blocks on the table, or check the camera",
            )
        masks = [largest_part(labels == label) for label in objects.labels]
        located = self.module.locate(objects)
        count = min(count_stacks(np.any(masks, axis=0)), len(objects))
        stacks = stacks_from_coordinates(located.corners, count)
        verdicts: list[tuple[GraphStatus, str]] = []
        if verdict := self._occlusion(hidden):
            verdicts.append((GraphStatus.OCCLUDED, verdict))
        on_places = self._on_places(stacks, located, camera, verdicts)
        columns = stacks if on_places is None else on_places

        surfaces: list[BlockSurface] | None = None
        if depth is not None and camera is not None:
            surfaces = _measure(masks, depth, camera, objects)
            shapes = [surface.shape for surface in surfaces]
        else:
            shapes = [shape_from_outline(rgb, mask) for mask in masks]
        names = unique_names(color_names(mean_colors(rgb, masks)), shapes, columns)
        confidence = located.iou
        poses: list[BlockPose] | None = None
        if surfaces is not None and depth is not None and camera is not None:
            poses = block_poses(surfaces, columns, self._table_heights(len(columns)))
            confidence = confidence * _visible_shares(poses, hidden_mask, camera)
            self._check_places(poses, names, columns, on_places is not None, verdicts)
        items = _objects(objects, located, names, shapes, poses, confidence)
        graph = SceneGraph(
            objects=items,
            relations=_relations(names, columns, on_places is not None),
            places=self.rejected(GraphStatus.NO_OBJECTS, "").graph.places
            if on_places is not None
            else (),
            confidence=float(confidence.min()) * (1.0 - max(hidden, default=0.0)),
        )
        return self._judged(graph, verdicts)

    def _judged(self, graph: SceneGraph, verdicts: Sequence[tuple[GraphStatus, str]]) -> Perceived:
        if verdicts:
            return Perceived(graph, *verdicts[0])
        if graph.confidence < self.config.min_confidence:
            worst = min(graph.objects, key=lambda item: item.confidence)
            return Perceived(
                graph,
                GraphStatus.LOW_CONFIDENCE,
                f"the visual module reproduces {worst.name} with a confidence of only "
                f"{worst.confidence:.2f} (required: {self.config.min_confidence:.2f}); look again, "
                "or train it on such scenes",
            )
        return Perceived(graph, GraphStatus.CONFIDENT)

    def _hidden(
        self,
        labels: NDArray[np.integer],
        depth: NDArray[np.floating] | None,
        camera: PinholeCamera | None,
    ) -> tuple[NDArray[np.bool_] | None, list[float]]:
        """Pixels where something hides the places, and the hidden share of each column, 0..1."""
        config = self.config
        if depth is None or camera is None or not config.stack_positions:
            return None, []
        positions = np.array(config.stack_positions, dtype=np.float64)
        volumes = PlaceVolumes(positions, config.column_half_width, config.column_height)
        regions = [volumes.region(camera, place) for place in range(len(positions))]
        hidden = hidden_pixels(labels, depth, camera, volumes, np.any(regions, axis=0))
        return hidden, [_share(hidden, region) for region in regions]

    def _occlusion(self, hidden: Sequence[float]) -> str:
        if max(hidden, default=0.0) <= self.config.max_hidden:
            return ""
        worst = int(np.argmax(hidden))
        return (
            f"something that is not a block hides {hidden[worst]:.0%} of {base_name(worst)}; look "
            "again when it is gone"
        )

    def _on_places(
        self,
        stacks: list[list[int]],
        located: Coordinates,
        camera: PinholeCamera | None,
        verdicts: list[tuple[GraphStatus, str]],
    ) -> list[list[int]] | None:
        """The stacks of all m places; None where the places or the camera are unknown."""
        places = self.config.stack_positions
        if camera is None or not places:
            return None
        side = max(camera.width, camera.height)
        seen = [float(located.centres[stack[0], 0]) for stack in stacks]
        projected = (camera.project(places)[:, 0] + 0.5) / side
        if np.any(np.diff(projected) <= 0.0) or not np.isfinite(projected).all():
            raise BadImageError(
                "the places are not in order from the left of the image; check the parameter "
                "stack_positions and camera/extrinsics"
            )
        try:
            assigned = assign_places(seen, projected)
        except PerceptionError as error:
            verdicts.append((GraphStatus.UNSTABLE, f"{error}; put every block on a place"))
            return None
        return with_empty_places(stacks, assigned, len(places))

    def _table_heights(self, count: int) -> list[float]:
        heights = [position[2] for position in self.config.stack_positions]
        return heights if len(heights) == count else [heights[0] if heights else 0.0] * count

    def _check_places(
        self,
        poses: Sequence[BlockPose],
        names: Sequence[str],
        columns: Sequence[Sequence[int]],
        have_places: bool,
        verdicts: list[tuple[GraphStatus, str]],
    ) -> None:
        if not have_places:
            return
        places = self.config.stack_positions
        sentence = instability(poses, names, columns, places, self.config.limits)
        if sentence:
            verdicts.append((GraphStatus.UNSTABLE, f"{sentence}; look again, or tidy up by hand"))


def _check_frame(rgb: NDArray[Any], labels: NDArray[Any], depth: NDArray[Any] | None) -> None:
    if rgb.ndim != 3 or rgb.shape[2] != 3 or rgb.dtype != np.uint8:
        raise BadImageError(f"image is {rgb.dtype} of shape {rgb.shape}, expected 8-bit RGB")
    if min(rgb.shape[:2]) < 32:
        raise BadImageError(
            f"image of {rgb.shape[1]}x{rgb.shape[0]} is too small; send 128x128 or more"
        )
    if labels.shape != rgb.shape[:2]:
        raise BadImageError(
            f"segmentation is {_size(labels)} but the image is {_size(rgb)}; "
            "both must show the same pixels"
        )
    if depth is not None and depth.shape != rgb.shape[:2]:
        raise BadImageError(
            f"depth is {_size(depth)} but the image is {_size(rgb)}; register depth to colour"
        )


def _share(hidden: NDArray[np.bool_], region: NDArray[np.bool_]) -> float:
    return int(np.count_nonzero(hidden & region)) / max(1, int(np.count_nonzero(region)))


def _visible_shares(
    poses: Sequence[BlockPose], hidden: NDArray[np.bool_] | None, camera: PinholeCamera
) -> NDArray[np.float64]:
    """How much of each block's outline nothing without a label hides, shape (N,), 0..1."""
    if hidden is None or not hidden.any():
        return np.ones(len(poses))
    regions = [box_region(camera, item.position_world, item.size, item.yaw) for item in poses]
    return np.array([1.0 - _share(hidden, region) for region in regions])


def _size(image: NDArray[Any]) -> str:
    return "x".join(str(side) for side in image.shape[1::-1])


def _measure(
    masks: Sequence[NDArray[np.bool_]],
    depth: NDArray[np.floating],
    camera: PinholeCamera,
    objects: ObjectImages,
) -> list[BlockSurface]:
    surfaces = []
    for label, mask in zip(objects.labels, masks):
        try:
            surfaces.append(measure_block(mask, depth, camera))
        except BadImageError as error:
            raise BadImageError(
                f"the depth of the object with label {label} cannot be used: {error}; "
                "check the depth camera"
            ) from error
    return surfaces


def _objects(
    objects: ObjectImages,
    located: Coordinates,
    names: Sequence[str],
    shapes: Sequence[str],
    poses: Sequence[BlockPose] | None,
    confidence: NDArray[np.float64],
) -> tuple[SceneObject, ...]:
    found = []
    for index, name in enumerate(names):
        item = SceneObject(
            name=name,
            color=name.partition("_")[0],
            shape=shapes[index],
            label=int(objects.labels[index]),
            coordinates=(float(located.phi[index, 0]), float(located.phi[index, 1])),
            confidence=float(confidence[index]),
        )
        if poses is not None:
            pose = poses[index]
            item = replace(
                item,
                position_world=pose.position_world,
                quaternion_world=pose.quaternion_world,
                size=pose.size,
            )
        found.append(item)
    return tuple(sorted(found, key=lambda item: item.name))


def _relations(
    names: Sequence[str], columns: Sequence[Sequence[int]], have_places: bool
) -> frozenset[Relation]:
    """Up-relations with bases where the places are known, else up- and left-relations (A.2.2)."""
    stacks: Stacks = tuple(tuple(names[i] for i in column) for column in columns)
    relations = up_relations(stacks)
    if have_places:
        return relations
    bases = {base_name(index) for index in range(len(stacks))}
    ups = {item for item in relations if item.predicate == UP and item.object not in bases}
    return frozenset(ups) | left_relations(stacks)
