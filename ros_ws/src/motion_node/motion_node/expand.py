# SPDX-License-Identifier: Apache-2.0
"""Moves to phases: each move (p, q) becomes a pick and a place with their modes (5.1)."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace
from itertools import pairwise
from typing import Final

import numpy as np

from scene_graph import Move, Place, base_name, wrap_line

from .blocks import Block, Column, Scene, placed
from .errors import InvalidPlanError
from .grasps import Circumstances, Grasp, choose_grasp, grasps_for
from .phases import HOME, PICK, PLACE, Phase, Switch, Tool
from .robots import Gripper
from .settings import PhaseSettings

#: Number of stacks where nobody has said how many there are.
USUAL_STACKS: Final = 3
#: No stack is taken to be higher than this above the table, where nobody knows [m].
TALLEST: Final = 0.35
#: Above the highest known stack, where the arm cannot rise to ``TALLEST`` [m].
SPARE_RISE: Final = 0.03


@dataclass(frozen=True)
class Choice:
    """How a move takes its block and puts it down.

    Attributes:
        grasp: which of the ways to take it, from 0, the preferred one.
        across: whether it is put down with the fingers along world y, not x.
    """

    grasp: int = 0
    across: bool = False


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


def expand(
    scene: Scene,
    moves: Sequence[Move],
    gripper: Gripper,
    settings: PhaseSettings,
    squeeze: float,
    object_names: Sequence[str] = (),
    choices: Sequence[Choice] = (),
) -> list[Phase]:
    """The phases of a plan, the way home included: a^r_{1:K} = p(a^v_{1:K^v}) of 5.1.

    Args:
        squeeze: how much farther than the block's half width each finger is sent, so that the
            fingers press [m].
        object_names: the blocks that the plan believes it moves; checked where given.
        choices: one a move; none: the preferred ones.

    Raises:
        InvalidPlanError: if a move does not fit the scene; ``move`` is its index.
    """
    phases: list[Phase] = []
    start: Switch | None = None
    for index, move in enumerate(moves):
        block = _taken(scene, index, move, object_names[index] if object_names else "")
        source, target = move.source, move.target
        circumstances = Circumstances(gripper, free_yaw(scene.places, source))
        choice = choices[index] if choices else Choice()
        grasps = grasps_for(block, circumstances, settings.max_grasp_width)
        grasp, count = grasps[min(choice.grasp, len(grasps) - 1)], len(grasps)
        tool, holding = open_tool(gripper), _holding_tool(gripper, block, grasp, squeeze)
        x, y, z = block.position_world
        pick = Switch((x, y, z + grasp.height), grasp.yaw, source)
        phases.append(
            Phase(
                *(PICK, index, block.name, pick, start, tool, scene.columns, holding.finger),
                *(grasp, count, choice.grasp),
            )
        )
        scene = scene.without_top(source)
        support = scene.stacks[target][-1] if scene.stacks[target] else None
        base = scene.places[target].position_world
        turn = np.pi / 2 if choice.across else 0.0
        yaw = wrap_line(grasp.placed_yaw + turn) if choice.across else grasp.placed_yaw
        after = placed(block, yaw, base, support, settings.max_overhang)
        x, y, z = after.position_world
        start = Switch((x, y, z + grasp.height + settings.place_gap), turn, target)
        travel = gripper.finger_travel
        phases.append(
            Phase(
                *(PLACE, index, block.name, start, pick, holding, scene.columns, travel),
                *(grasp, count, choice.grasp),
            )
        )
        scene = scene.with_top(target, after)
    tool, travel = open_tool(gripper), gripper.finger_travel
    return [*phases, Phase(HOME, len(moves), "", None, start, tool, scene.columns, travel)]


def only_for(
    scene: Scene, moves: Sequence[Move], index: int, gripper: Gripper, settings: PhaseSettings
) -> Scene:
    """The scene before a move of a plan, with no other stacks than the move's two."""
    for move in moves[:index]:
        block = scene.stacks[move.source][-1]
        circumstances = Circumstances(gripper, free_yaw(scene.places, move.source))
        grasp = choose_grasp(block, circumstances, settings.max_grasp_width)
        scene = scene.without_top(move.source)
        support = scene.stacks[move.target][-1] if scene.stacks[move.target] else None
        base = scene.places[move.target].position_world
        after = placed(block, grasp.placed_yaw, base, support, settings.max_overhang)
        scene = scene.with_top(move.target, after)
    own = (moves[index].source, moves[index].target)
    stacks = tuple(stack if place in own else () for place, stack in enumerate(scene.stacks))
    return replace(scene, stacks=stacks)


def _taken(scene: Scene, index: int, move: Move, expected: str) -> Block:
    """The block that a move takes.

    Raises:
        InvalidPlanError: if the move does not fit the scene, or takes another than ``expected``.
    """
    count = len(scene.stacks)
    for stack in (move.source, move.target):
        if not 0 <= stack < count:
            raise InvalidPlanError(
                f"move {index} {move} names {base_name(stack)}; there are {count} stacks", index
            )
    if move.source == move.target:
        raise InvalidPlanError(f"move {index} {move} ends where it starts", index)
    place = base_name(move.source)
    if not scene.stacks[move.source]:
        raise InvalidPlanError(
            f"move {index} {move} takes from {place}, which is empty by then", index
        )
    block = scene.stacks[move.source][-1]
    if expected and expected != block.name:
        raise InvalidPlanError(
            f"move {index} {move} is said to take {expected}, but {block.name} is "
            f"on top of {place} by then",
            index,
            expected,
        )
    return block


def free_yaw(places: Sequence[Place], stack: int) -> float:
    """Direction across the line from a place to its nearest neighbour, in (-pi/2, pi/2] [rad].

    Along world x where there is no neighbour.
    """
    here = np.array(places[stack].position_world[:2])
    others = [np.subtract(p.position_world[:2], here) for p in places if p.index != stack]
    if not others:
        return 0.0
    dx, dy = min(others, key=lambda offset: float(np.hypot(*offset)))
    return wrap_line(float(np.arctan2(dy, dx)) + np.pi / 2)


def way_home(phases: Sequence[Phase], moves_done: int, gripper: Gripper) -> Phase:
    """The way home after ``moves_done`` complete moves, from wherever the empty hand is.

    The blocks stand as the phases predict; with none of the moves done, as they were seen.
    """
    following = [phase for phase in phases if phase.move >= moves_done]
    first = following[0] if following else phases[-1]
    tool = open_tool(gripper)
    return replace(phases[-1], start=None, columns=first.columns, tool=tool, move=first.move)


def put_down(phases: Sequence[Phase], move: int) -> list[Phase] | None:
    """The rest of a move whose block is in the hand, from wherever it is, and the way home.

    None if the phases do not place that block.
    """
    for phase, following in pairwise(phases):
        if phase.kind == PLACE and phase.move == move:
            home = replace(
                phases[-1], start=phase.switch, columns=following.columns, move=following.move
            )
            return [replace(phase, start=None), home]
    return None


def rise_home(
    point: tuple[float, float, float],
    stacks: int,
    top: float,
    tool: Tool,
    move: int = 0,
) -> Phase:
    """Straight up to a height, and home: the way where nobody knows what stands around the hand.

    Whatever it is, the hand has come down beside it, and above ``top`` there is nothing. So it
    rises as if it stood in the middle of a stack of that height.

    Args:
        point: the tool centre point in world [m].
        stacks: how many stacks there are in the motion problem.
        top: [m]
        tool: the hand with what it holds.
        move: as in ``Phase.move``.
    """
    column = Column(point[:2], (0.0, 0.0), top)
    return Phase(HOME, move, "", None, None, tool, (column,) * stacks, tool.finger)


def something_held(gripper: Gripper, fingers: float, name: str, squeeze: float) -> Tool:
    """The hand around something of which only its width is known; it is taken for a big block.

    Args:
        fingers: where the fingers stand [m].
    """
    return Tool(
        half_x=max(gripper.finger_thickness, gripper.finger_travel),
        half_y=fingers + gripper.finger_depth,
        bottom=gripper.tcp_offset + gripper.finger_travel,
        held=name,
        finger=max(0.0, fingers - squeeze),
    )
