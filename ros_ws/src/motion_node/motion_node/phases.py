# SPDX-License-Identifier: Apache-2.0
"""Moves to phases: each move (p, q) becomes a pick and a place with their modes (5.1).

A phase ends with a switch: a pose of the hand at which it stands still while the fingers open or
close. Between two switches the mode is constant: what is held, and how high each stack is.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, field, replace
from typing import Final

import numpy as np

from scene_graph import Move, Place, SceneGraph, SceneGraphError, base_name

from .blocks import Block, Grasp, block_from_object, grasps, placed
from .errors import InvalidPlanError
from .robots import Gripper

PICK: Final = "pick"
PLACE: Final = "place"
HOME: Final = "home"


@dataclass(frozen=True)
class PhaseSettings:
    """Tolerances of grasping and placing.

    Attributes:
        max_grasp_width: widest block that the open fingers go around [m].
        place_gap: height above its support at which a block is let go [m].
        max_overhang: see :func:`placed`.
    """

    max_grasp_width: float = 0.07
    place_gap: float = 0.002
    max_overhang: float = 0.2


@dataclass(frozen=True)
class Column:
    """A stack as an obstacle: an upright box from the table to ``top``, in world axes [m]."""

    center: tuple[float, float]
    half: tuple[float, float]
    top: float


@dataclass(frozen=True)
class Switch:
    """Where the hand stands still at the end of a phase.

    Attributes:
        position_world: tool centre point [m]; the hand points straight down.
        yaw: direction of the fingers' motion, counter-clockwise from world x [rad].
        stack: index of the stack it belongs to.
    """

    position_world: tuple[float, float, float]
    yaw: float
    stack: int


@dataclass(frozen=True)
class Tool:
    """What hangs below the palm, as a box in the hand's frame: the fingers and a held block.

    Attributes:
        half_x, half_y: half extents along the hand's axes, y being the fingers' direction [m].
        bottom: z of the lower end in the hand's frame [m].
        held: name of the held block, or empty.
        finger: position of each finger joint when the hand arrives [m].
    """

    half_x: float
    half_y: float
    bottom: float
    held: str = ""
    finger: float = 0.0


@dataclass(frozen=True)
class Phase:
    """One phase: from the switch before to ``switch`` in a constant mode.

    Attributes:
        kind: ``pick``, ``place`` or ``home``.
        move: index of the move; the number of moves for ``home``.
        object_name: the block that the move is about; empty for ``home``.
        switch: where the phase ends; None: at the arm's home.
        start: where it starts, if it starts at a switch.
        tool: what hangs below the palm on the way.
        columns: the stacks on the way, a held block left out.
        grip: finger position commanded after the switch [m].
    """

    kind: str
    move: int
    object_name: str
    switch: Switch | None
    start: Switch | None
    tool: Tool
    columns: tuple[Column, ...]
    grip: float


@dataclass
class _Scene:
    """The blocks of each stack from the bottom, changed move by move."""

    places: tuple[Place, ...]
    stacks: list[list[Block]]
    floor: float = field(init=False)

    def __post_init__(self) -> None:
        self.floor = min(place.position_world[2] for place in self.places)

    def columns(self) -> tuple[Column, ...]:
        return tuple(
            _column(stack, place, self.floor) for stack, place in zip(self.stacks, self.places)
        )


def _column(stack: Sequence[Block], place: Place, floor: float) -> Column:
    if not stack:
        return Column(place.position_world[:2], (0.0, 0.0), floor)
    lower = np.min([np.subtract(b.position_world[:2], b.half_world) for b in stack], axis=0)
    upper = np.max([np.add(b.position_world[:2], b.half_world) for b in stack], axis=0)
    center, half = (lower + upper) / 2, (upper - lower) / 2
    return Column(
        (float(center[0]), float(center[1])),
        (float(half[0]), float(half[1])),
        max(block.top for block in stack),
    )


def open_tool(gripper: Gripper) -> Tool:
    """The empty hand with its fingers fully open."""
    return Tool(
        half_x=gripper.finger_thickness,
        half_y=gripper.finger_travel + gripper.finger_depth,
        bottom=gripper.finger_tip,
        finger=gripper.finger_travel,
    )


def _holding_tool(gripper: Gripper, block: Block, grasp: Grasp, squeeze: float) -> Tool:
    below_tcp = block.size[2] / 2 + grasp.height
    return Tool(
        half_x=max(gripper.finger_thickness, grasp.depth / 2),
        half_y=grasp.width / 2 + gripper.finger_depth,
        bottom=max(gripper.finger_tip, gripper.tcp_offset + below_tcp),
        held=block.name,
        finger=max(0.0, grasp.width / 2 - squeeze),
    )


def read_scene(graph: SceneGraph) -> _Scene:
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
    stacks = [[block_from_object(graph.object(name)) for name in stack] for stack in names]
    return _Scene(places, stacks)


def expand(
    graph: SceneGraph,
    moves: Sequence[Move],
    gripper: Gripper,
    settings: PhaseSettings,
    squeeze: float,
    object_names: Sequence[str] = (),
) -> list[Phase]:
    """The phases of a plan, the way home included: a^r_{1:K} = p(a^v_{1:K^v}) of 5.1.

    Args:
        squeeze: how much farther than the block's half width each finger is sent, so that the
            fingers press [m].
        object_names: the blocks that the plan believes it moves; checked where given.

    Raises:
        InvalidPlanError: if a move does not fit the scene; ``move`` is its index.
    """
    scene = read_scene(graph)
    count = len(scene.stacks)
    phases: list[Phase] = []
    start: Switch | None = None
    below, above = (
        gripper.finger_tip - gripper.tcp_offset,
        gripper.tcp_offset - gripper.palm,
    )
    for index, move in enumerate(moves):
        source, target = move.source, move.target
        for stack in (source, target):
            if not 0 <= stack < count:
                raise InvalidPlanError(
                    f"move {index} {move} names {base_name(stack)}; there are {count} stacks", index
                )
        if source == target:
            raise InvalidPlanError(f"move {index} {move} ends where it starts", index)
        if not scene.stacks[source]:
            raise InvalidPlanError(
                f"move {index} {move} takes from {base_name(source)}, which is empty by then", index
            )
        block = scene.stacks[source][-1]
        if object_names and object_names[index] and object_names[index] != block.name:
            raise InvalidPlanError(
                f"move {index} {move} is said to take {object_names[index]}, but {block.name} is "
                f"on top of {base_name(source)} by then",
                index,
                object_names[index],
            )
        options = grasps(block, below, above)
        fitting = [option for option in options if option.width <= settings.max_grasp_width]
        grasp = (fitting or options)[0]
        tool = open_tool(gripper)
        holding = _holding_tool(gripper, block, grasp, squeeze)
        x, y, z = block.position_world
        pick = Switch((x, y, z + grasp.height), grasp.yaw, source)
        phases.append(
            Phase(PICK, index, block.name, pick, start, tool, scene.columns(), holding.finger)
        )
        scene.stacks[source].pop()
        support = scene.stacks[target][-1] if scene.stacks[target] else None
        base = scene.places[target].position_world
        after = placed(block, grasp, base, support, settings.max_overhang)
        x, y, z = after.position_world
        place = Switch((x, y, z + grasp.height + settings.place_gap), 0.0, target)
        phases.append(
            Phase(
                PLACE,
                index,
                block.name,
                place,
                pick,
                holding,
                scene.columns(),
                gripper.finger_travel,
            )
        )
        scene.stacks[target].append(after)
        start = place
    home = Phase(
        HOME,
        len(moves),
        "",
        None,
        start,
        open_tool(gripper),
        scene.columns(),
        gripper.finger_travel,
    )
    return [*phases, home]


def way_home(phases: Sequence[Phase], moves_done: int, gripper: Gripper) -> Phase:
    """The way home after ``moves_done`` complete moves, from wherever the empty hand is.

    The blocks stand as the phases predict; with none of the moves done, as they were seen.
    """
    following = [phase for phase in phases if phase.move >= moves_done]
    first = following[0] if following else phases[-1]
    return replace(
        phases[-1], start=None, columns=first.columns, tool=open_tool(gripper), move=first.move
    )


def too_wide(phase: Phase, settings: PhaseSettings, squeeze: float) -> float:
    """By how much the block of a pick is too wide for the open fingers; 0 if it fits [m]."""
    return max(0.0, 2 * (phase.grip + squeeze) - settings.max_grasp_width)
