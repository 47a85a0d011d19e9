# SPDX-License-Identifier: Apache-2.0
"""The blocks of a scene as upright prisms, where they come to stand, and the stacks they form."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np

from scene_graph import (
    BOX,
    CYLINDER,
    SPHERE,
    BlockPose,
    Place,
    SceneGraph,
    SceneGraphError,
    SceneObject,
    base_name,
    rotation_from_quaternion,
    wrap_line,
)

from .errors import InvalidPlanError

#: A block whose vertical axis is farther than this from vertical is leaning [rad].
MAX_LEAN = 0.3
#: A stack that stands farther than this from the centre of its place is worth mentioning [m].
ASIDE = 0.02
#: So far under the table a stack ends that is none [m].
NOTHING = 0.1
#: Shapes that look the same from above however they are turned.
ROUND = (CYLINDER, SPHERE)


@dataclass(frozen=True)
class Block(BlockPose):
    """A block standing upright.

    Attributes:
        name: of the object.
        shape: one of ``scene_graph.SHAPES``; it decides how the block can be grasped.
    """

    name: str
    shape: str = BOX


@dataclass(frozen=True)
class Column:
    """A stack as an obstacle: an upright box from the table to ``top``, in world axes [m]."""

    center: tuple[float, float]
    half: tuple[float, float]
    top: float


@dataclass(frozen=True)
class Scene:
    """The blocks of each stack from the bottom, and the places on which the stacks stand."""

    places: tuple[Place, ...]
    stacks: tuple[tuple[Block, ...], ...]

    @property
    def floor(self) -> float:
        """Height of the table [m]."""
        return min(place.position_world[2] for place in self.places)

    @property
    def columns(self) -> tuple[Column, ...]:
        """The stacks as obstacles."""
        floor = self.floor
        return tuple(_column(stack, place, floor) for stack, place in zip(self.stacks, self.places))

    @property
    def aside(self) -> str:
        """Which stacks do not stand where their places are; empty if all do."""
        found = []
        for stack, place in zip(self.stacks, self.places):
            if stack:
                offset = np.subtract(stack[0].position_world[:2], place.position_world[:2])
                if (distance := float(np.hypot(*offset))) > ASIDE:
                    base = base_name(place.index)
                    found.append(f"{stack[0].name} stands {1000 * distance:.0f} mm beside {base}")
        return ", ".join(found)

    def without_top(self, stack: int) -> Scene:
        """The scene after the top of a stack was taken."""
        return self._with_stack(stack, self.stacks[stack][:-1])

    def with_top(self, stack: int, block: Block) -> Scene:
        """The scene after a block was put onto a stack."""
        return self._with_stack(stack, (*self.stacks[stack], block))

    def _with_stack(self, index: int, stack: tuple[Block, ...]) -> Scene:
        return replace(self, stacks=(*self.stacks[:index], stack, *self.stacks[index + 1 :]))


def _column(stack: Sequence[Block], place: Place, floor: float) -> Column:
    if not stack:
        # Where a block stood beside the places something may be put that reaches over it.
        top = floor - NOTHING if place.aside else floor
        return Column(place.position_world[:2], (0.0, 0.0), top)
    boxes = [(block.position_world, block.half_world) for block in stack]
    (left, right), (near, far) = (
        (min(p[i] - h[i] for p, h in boxes), max(p[i] + h[i] for p, h in boxes)) for i in (0, 1)
    )
    return Column(
        ((left + right) / 2, (near + far) / 2),
        ((right - left) / 2, (far - near) / 2),
        max(block.top for block in stack),
    )


def block_from_object(item: SceneObject) -> Block:
    """The block that was seen; whichever of its axes is nearest to vertical becomes the third.

    Raises:
        InvalidPlanError: if pose or size are not finite or positive, or the block leans.
    """
    numbers = np.array([*item.position_world, *item.quaternion_world, *item.size], dtype=float)
    norm = float(np.linalg.norm(numbers[3:7]))
    if not np.all(np.isfinite(numbers)) or min(item.size) <= 0 or not 0.5 < norm < 2.0:
        raise InvalidPlanError(f"{item.name} has no usable pose and size", object_name=item.name)
    if item.shape in ROUND:
        return Block(item.position_world, 0.0, item.size, item.name, item.shape)
    rotation = rotation_from_quaternion(item.quaternion_world)
    vertical = int(np.argmax(np.abs(rotation[2])))
    lean = float(np.arccos(np.clip(abs(rotation[2, vertical]), -1.0, 1.0)))
    if lean > MAX_LEAN:
        raise InvalidPlanError(
            f"{item.name} leans by {np.degrees(lean):.0f} degrees and cannot be grasped from above",
            object_name=item.name,
        )
    first, second = [axis for axis in range(3) if axis != vertical]
    yaw = wrap_line(float(np.arctan2(rotation[1, first], rotation[0, first])))
    size = (item.size[first], item.size[second], item.size[vertical])
    return Block(item.position_world, yaw, size, item.name, item.shape)


def read_scene(graph: SceneGraph) -> Scene:
    """The stacks of blocks that a scene graph describes.

    Raises:
        InvalidPlanError: if there are no bases, the relations describe no stacks, a block of the
            relations is missing, or a block's pose cannot be used.
    """
    if not graph.places:
        raise InvalidPlanError("the plan's scene has no bases")
    places = tuple(sorted(graph.places, key=lambda place: place.index))
    if [place.index for place in places] != list(range(len(places))):
        raise InvalidPlanError("the bases of the plan's scene are not numbered from 0")
    if not np.all(np.isfinite([place.position_world for place in places])):
        raise InvalidPlanError("a base of the plan's scene has no finite position")
    try:
        names = graph.stacks()
    except SceneGraphError as error:
        raise InvalidPlanError(f"the plan's scene is inconsistent: {error}") from error
    known = set(graph.names)
    listed = {name for stack in names for name in stack}
    for name in sorted(listed - known):
        raise InvalidPlanError(f"{name} is missing from the plan's objects", object_name=name)
    for name in sorted(known - listed):
        raise InvalidPlanError(f"{name} stands on nothing in the plan's scene", object_name=name)
    return Scene(
        places,
        tuple(tuple(block_from_object(graph.object(name)) for name in stack) for stack in names),
    )


def placed(
    block: Block,
    yaw: float,
    base_world: tuple[float, float, float],
    support: Block | None,
    max_overhang: float,
) -> Block:
    """The block after it was put onto a stack.

    It goes to the middle of the place, so that errors of perception and grasping do not add up
    from block to block, but never farther than a share of the support's extent from the support's
    centre: a tower stands as long as each centre of mass is above the block below.

    Args:
        yaw: of the block there, counter-clockwise from world x [rad].
        base_world: centre of the place on the table [m].
        support: the block it will stand on; None: the table.
        max_overhang: share of the support's horizontal extent, 0 to 0.5.
    """
    x, y, floor = base_world
    if support is not None:
        half_x, half_y = support.half_world
        limit_x, limit_y = 2 * max_overhang * half_x, 2 * max_overhang * half_y
        x = float(
            np.clip(x, support.position_world[0] - limit_x, support.position_world[0] + limit_x)
        )
        y = float(
            np.clip(y, support.position_world[1] - limit_y, support.position_world[1] + limit_y)
        )
        floor = support.top
    return replace(block, position_world=(x, y, floor + block.size[2] / 2), yaw=yaw)
