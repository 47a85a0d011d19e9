# SPDX-License-Identifier: Apache-2.0
"""From what was found out about the blocks of a picture to its scene graph (3.2, A.2.2)."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace

from scene_graph import (
    BlockPose,
    Place,
    Relation,
    SceneGraph,
    SceneObject,
    Stacks,
    base_index,
    front_relations,
    left_relations,
    rows_of,
    up_relations,
)

from .blocks import Blocks
from .hiding import Hidden
from .names import Names
from .observation import Observation
from .places import Standing
from .places.occlusion import Occlusion
from .segment import Segments
from .visual_module.coordinates import Coordinates


def build_graph(
    observation: Observation,
    segments: Segments,
    occlusion: Occlusion,
    coordinates: Coordinates,
    standing: Standing,
    blocks: Blocks,
    names: Names,
    hidden: Sequence[Hidden] = (),
) -> SceneGraph:
    """The scene graph of N blocks, at least one; objects are sorted by name.

    Args:
        hidden: where blocks may be that are not seen; something stands there for them.

    The confidence of a block is its IoU (A.2.5) times the visible share of its outline; that of
    the graph is the least of them, lowered by the hidden share of the places.
    """
    confidence = coordinates.iou * occlusion.visible_shares(blocks.poses, observation.camera)
    objects = []
    for index, (segment, pose) in enumerate(zip(segments, blocks.poses)):
        a, b = coordinates.phi[index]
        item = SceneObject(
            name=names.names[index],
            color=names.colors[index],
            shape=blocks.shapes[index],
            label=segment.label,
            coordinates=(float(a), float(b)),
            confidence=float(confidence[index]),
            alternatives=names.alternatives[index] if names.alternatives else (),
        )
        objects.append(item if pose is None else _posed(item, pose))
    columns = [[names.names[item] for item in stack] for stack in standing.stacks]
    for place in standing.places:
        parts = [item for item in hidden if item.place == place.index]
        for number, part in reversed(list(enumerate(parts, start=1))):
            objects.append(part.stand_in(place, number))
            columns[place.index].insert(part.level, objects[-1].name)
    return SceneGraph(
        objects=tuple(sorted(objects, key=lambda item: item.name)),
        relations=_relations(tuple(map(tuple, columns)), standing),
        places=_with_hidden_shares(standing, occlusion),
        confidence=float(confidence.min()) * (1.0 - occlusion.greatest),
    )


def _with_hidden_shares(standing: Standing, occlusion: Occlusion) -> tuple[Place, ...]:
    known = len(occlusion.shares)
    if known != sum(not place.aside for place in standing.places):
        return standing.places
    seen = tuple(
        replace(place, hidden=share, seen_to=height)
        for place, share, height in zip(standing.places, occlusion.shares, occlusion.seen_to)
    )
    return (*seen, *standing.places[known:])


def _posed(item: SceneObject, pose: BlockPose) -> SceneObject:
    return replace(
        item,
        position_world=pose.position_world,
        quaternion_world=pose.quaternion_world,
        size=pose.size,
    )


def _relations(stacks: Stacks, standing: Standing) -> frozenset[Relation]:
    """Up-relations with bases where the places are known, else up- and left-relations (A.2.2).

    Of two rows front-relations as well (5.4.3).
    """
    relations = up_relations(stacks)
    if standing.places:
        return relations | front_relations(stacks, rows_of(standing.places))
    on_blocks = {item for item in relations if base_index(item.object) is None}
    return frozenset(on_blocks) | left_relations(stacks)
