# SPDX-License-Identifier: Apache-2.0
"""The true scene graph, read off the physics: for evaluation and tests only."""

from __future__ import annotations

import itertools
from collections.abc import Sequence
from dataclasses import replace

import numpy as np
from numpy.typing import NDArray

from scene_graph import (
    BOX,
    FLAT_TOPPED,
    UP,
    Place,
    Relation,
    SceneGraph,
    SceneObject,
    Stacks,
    base_name,
    front_relations,
    in_rows,
    rotation_from_quaternion,
    rows_of,
)
from scene_graph.places import Point

from .world import World

#: A block counts as standing on what is below it within these distances [m].
_HEIGHT_TOLERANCE = 0.006


def true_scene_graph(world: World) -> SceneGraph:
    """Objects with true poses, and up-relations for the blocks that stand on something."""
    objects = []
    for name in sorted(world.names):
        position, quaternion = world.block_pose(name)
        block = world.block(name)
        objects.append(
            SceneObject(
                name,
                block.color,
                block.shape,
                position,
                quaternion,
                block.size,
                world.label(name),
            )
        )
    graph = graph_of_poses(objects, world.config.stack_positions)
    x, y, z = (float(value) for value in world.config.camera.world_from_optical[:3, 3])
    return in_front_of(graph, (x, y, z))


def in_front_of(graph: SceneGraph, camera: Point) -> SceneGraph:
    """A graph with what two rows of places are to a camera, and the relations between them.

    Args:
        camera: its position in world [m].
    """
    places = in_rows([place.position_world for place in graph.places], camera)
    stacks, _ = standing_blocks(graph)
    relations = graph.relations | front_relations(stacks, rows_of(places))
    return replace(graph, places=places, relations=relations)


def graph_of_poses(objects: Sequence[SceneObject], positions: Sequence[Point]) -> SceneGraph:
    """The scene graph of blocks whose poses are known, wherever they come from.

    A block stands on another, or on a base, if its bottom touches the other's top and its centre
    is above it. A block that stands on nothing (in the hand, fallen over between two places) has
    no relation, so the graph is then no complete state.

    Args:
        objects: with shapes, poses and sizes.
        positions: of the places on the table [m].
    """
    tops = [(base_name(i), np.array(base)) for i, base in enumerate(positions)]
    reach: dict[str, float | NDArray[np.float64]] = {
        base_name(i): _base_reach(positions) for i in range(len(positions))
    }
    turns = {base_name(i): np.eye(3) for i in range(len(positions))}
    bottoms = []
    for item in objects:
        rotation = rotation_from_quaternion(item.quaternion_world)
        vertical = int(np.abs(rotation[2]).argmax())
        half = 0.5 * np.array(item.size)
        bottoms.append(np.array(item.position_world) - [0.0, 0.0, half[vertical]])
        if item.shape == BOX or (item.shape in FLAT_TOPPED and vertical == 2):
            across = [axis for axis in range(3) if axis != vertical]
            tops.append((item.name, np.add(item.position_world, [0.0, 0.0, half[vertical]])))
            reach[item.name], turns[item.name] = half[across], rotation[:, across].T
    relations = set()
    for item, bottom in zip(objects, bottoms):
        for below, top in tops:
            offset = bottom - top
            touches = below != item.name and abs(offset[2]) < _HEIGHT_TOLERANCE
            if touches and (np.abs(turns[below] @ offset)[:2] < reach[below]).all():
                relations.add(Relation(item.name, UP, below))
                break
    places = tuple(Place(i, base) for i, base in enumerate(positions))
    return SceneGraph(tuple(objects), frozenset(relations), places)


def standing_blocks(graph: SceneGraph) -> tuple[Stacks, tuple[str, ...]]:
    """The stacks as far as they stand, and the names of the blocks that stand in none."""
    above = {item.object: item.subject for item in sorted(graph.relations) if item.predicate == UP}
    stacks = []
    for place in graph.places:
        stack: list[str] = []
        below = base_name(place.index)
        while below in above:
            below = above[below]
            stack.append(below)
        stacks.append(tuple(stack))
    standing = {name for stack in stacks for name in stack}
    return tuple(stacks), tuple(sorted(set(graph.names) - standing))


def _base_reach(positions: Sequence[Point]) -> float:
    """How far from its centre the table is a base's: two fifths of the least distance [m]."""
    gaps = [np.linalg.norm(np.subtract(a, b)) for a, b in itertools.combinations(positions, 2)]
    return 0.4 * float(min(gaps, default=0.2))
