# SPDX-License-Identifier: Apache-2.0
"""What is right about places that were found: no truth numbers the free ones among them."""

from __future__ import annotations

import math

from scene_graph import Relation, SceneGraph, up_relations

#: A place that is further than this from where a stack stands is none of it [m].
_OTHER = 0.03


def on_found_places(truth: SceneGraph, found: SceneGraph) -> frozenset[Relation] | None:
    """The right relations where each stack stands on the place that was found for it.

    None where one has no place of its own, or a place too many is where no stack can be.
    """
    places = {place.index: place.position_world for place in found.places if not place.aside}
    stacks: list[tuple[str, ...]] = [()] * len(places)
    for place, stack in zip(truth.places, truth.stacks()):
        if not stack:
            continue
        nearest = _nearest(found, place.position_world)
        if nearest is None or nearest[1] > _OTHER or stacks[nearest[0]]:
            return None
        stacks[nearest[0]] = stack
    return up_relations(tuple(stacks))


def place_errors(truth: SceneGraph, found: SceneGraph) -> tuple[float, ...]:
    """How far from the middle of each stack's lowest block the place next to it is [mm]."""
    errors = []
    for stack in truth.stacks():
        if stack and (nearest := _nearest(found, truth.object(stack[0]).position_world)):
            errors.append(1000.0 * nearest[1])
    return tuple(errors)


def _nearest(found: SceneGraph, point: tuple[float, float, float]) -> tuple[int, float] | None:
    """Index of the place that is nearest, and its distance on the table [m]."""
    away = [
        (math.dist(place.position_world[:2], point[:2]), place.index)
        for place in found.places
        if not place.aside
    ]
    return min(away)[::-1] if away else None
