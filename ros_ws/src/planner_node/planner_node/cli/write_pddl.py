# SPDX-License-Identifier: Apache-2.0
"""``ros2 run planner_node write_pddl``: the scene and a goal as PDDL, for another planner.

What that finds goes back with ``plan_to_goal --plan FILE`` or ``achieve_goal --plan FILE``.
"""

from __future__ import annotations

import argparse
import sys
import time
import uuid
from collections.abc import Sequence
from pathlib import Path
from typing import Final

import rclpy
from rclpy.node import Node
from rclpy.utilities import remove_ros_args
from tamp_interfaces.msg import SceneGraph
from tamp_runtime.node_thread import NodeThread
from tamp_runtime.qos import NEWEST

from scene_graph import Stacks

from ..conversions import sighting_from_message
from ..errors import NoSceneGraphError, NotConfidentError, PlannerError
from ..goals import check_contradictions, parse_goal, resolve_goal
from ..loop import Scene, scene_in
from ..loop.scene_plan import stability_in
from ..search.peers.pddl import pddl_of
from ..settings import AVOID, STABILITY, Settings
from .commands import EXIT_FAILED, prepare
from .interrupts import exit_code, say

_POLL_SECONDS: Final = 0.05


def write_pddl(arguments: Sequence[str] | None = None) -> int:
    """Writes domain.pddl and problem.pddl.

    Returns:
        0: they are written; 1: there is no scene, or the goal does not fit it; 2: an argument makes
        no sense.
    """
    arguments = sys.argv if arguments is None else arguments
    parser = argparse.ArgumentParser(
        prog="write_pddl",
        description="Writes what the camera sees, and a goal, as PDDL for another planner.",
        epilog="Its plan is carried out by: achieve_goal --plan FILE",
    )
    parser.add_argument("goal", help="such as 'red on blue'")
    parser.add_argument(
        "--out", type=Path, default=Path(), help="where to put domain.pddl and problem.pddl"
    )
    parser.add_argument(
        "--state",
        help="in place of what is seen, such as 'red_box green_box | - | blue_box', each stack "
        "from the bottom; no node has to run",
    )
    parser.add_argument(
        "--stability",
        choices=STABILITY,
        default=AVOID,
        help="as the planner's parameter, default %(default)s",
    )
    parser.add_argument("--timeout", type=float, default=10.0, help="[s], default %(default)s")
    options = parser.parse_args(remove_ros_args(arguments)[1:])
    state = None if options.state is None else _state(parser, options.state)
    try:
        scene = _seen(arguments, options.timeout) if state is None else None
        stacks = scene.stacks if scene is not None else state or ()
        names = [name for stack in stacks for name in stack]
        goal = resolve_goal(parse_goal(options.goal), names, len(stacks), now=stacks)
        check_contradictions(goal, len(stacks))
        stability = None
        if scene is not None:
            stability = stability_in(scene, Settings(stability=options.stability))
        told = pddl_of(stacks, goal, stability)
        options.out.mkdir(parents=True, exist_ok=True)
        for name, text in (("domain", told.domain), ("problem", told.problem)):
            (options.out / f"{name}.pddl").write_text(text)
    except KeyboardInterrupt as interrupt:
        return exit_code(interrupt)
    except (PlannerError, OSError) as error:
        say(f"write_pddl: {error}")
        return EXIT_FAILED
    say(f"{options.out}/domain.pddl and problem.pddl: '{goal}'", sys.stdout)
    return 0


def _state(parser: argparse.ArgumentParser, text: str) -> Stacks:
    stacks = tuple(
        tuple(name for name in stack.split() if name != "-")
        for stack in text.strip().strip("[]").split("|")
    )
    names = [name for stack in stacks for name in stack]
    if twice := {name for name in names if names.count(name) > 1}:
        parser.error(f"--state: {', '.join(sorted(twice))} is there twice")
    return stacks


def _seen(arguments: Sequence[str], timeout: float) -> Scene:
    """The next scene that can be planned on.

    Raises:
        NoSceneGraphError, NotConfidentError: none within ``timeout`` [s].
    """
    prepare(arguments)
    node = Node(f"write_pddl_{uuid.uuid4().hex[:6]}")
    newest: list[SceneGraph] = []
    node.create_subscription(SceneGraph, "scene_graph", newest.append, NEWEST)
    spinning = NodeThread(node)
    problem: PlannerError = NoSceneGraphError(
        f"no scene graph within {timeout:g} s; are the camera and perception_node running? "
        "Or give --state"
    )
    try:
        deadline = time.monotonic() + timeout
        while time.monotonic() < deadline:
            if newest:
                try:
                    return scene_in(sighting_from_message(newest.pop()))
                except NotConfidentError as error:
                    problem = error
                newest.clear()
            time.sleep(_POLL_SECONDS)
        raise problem
    finally:
        spinning.stop()
        node.destroy_node()
        rclpy.try_shutdown()
