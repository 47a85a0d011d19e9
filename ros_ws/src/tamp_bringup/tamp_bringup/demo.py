# SPDX-License-Identifier: Apache-2.0
"""``ros2 run tamp_bringup demo``: the whole graph builds a tower and shows each stage.

Starts the four nodes as processes, lets the camera look, plans, optimises, executes, looks again,
and writes plan.png, execution.gif and result.json. The exit code is 0 if the simulator's ground
truth says that the goal was reached.
"""

from __future__ import annotations

import argparse
import io
import json
import math
import sys
import tempfile
import time
from datetime import datetime
from pathlib import Path
from typing import Final

import numpy as np
import rclpy
from numpy.typing import NDArray
from rclpy.signals import SignalHandlerOptions
from rclpy.utilities import remove_ros_args
from tamp_interfaces.action import AchieveGoal
from tamp_interfaces.msg import MotionStatus
from tamp_runtime.messages.scene_graph import graph_from_message, moves_from_messages
from tamp_runtime.node_process import prepare_process
from tqdm import tqdm

from planner_node.cli.client import PlannerClient
from planner_node.cli.plan_text import describe_plan
from planner_node.errors import PlannerError
from scene_graph import format_stacks

from .plan_picture import draw_plan
from .processes import NodeProcesses, use_own_domain
from .recording import Recording
from .scene_observer import SceneObserver, SimulationError, true_stacks
from .task import (
    Failure,
    SceneForGoalError,
    TaskResult,
    goal_text,
    random_goal,
    scene_for_goal,
    triples,
)
from .task_runner import run_task

#: The greatest seed of a scene that fits into the request.
MAX_SEED: Final = 2**31 - 1


class Narrator:
    """Turns feedback into lines, a progress bar and the picture of the plan."""

    def __init__(self, out: Path, image: NDArray[np.uint8] | None, goal: str) -> None:
        self._out, self._image, self._goal = out, image, goal
        self._last = ""
        self._plan_id = ""
        self._bar: tqdm | None = None
        self.pictures = 0

    def __call__(self, feedback: AchieveGoal.Feedback) -> None:
        """Shows what is new in one feedback message."""
        # Moves and scenes come once a plan, later only its name.
        if feedback.plan.moves and feedback.plan.plan_id != self._plan_id:
            self._plan_id = feedback.plan.plan_id
            self.close()
            self._show_plan(feedback)
        motion = feedback.motion
        if feedback.stage == feedback.EXECUTING and motion.state == MotionStatus.EXECUTING:
            if self._bar is None:
                print(
                    f"motion   {motion.duration:.0f} s of trajectory, "
                    f"optimised in {motion.optimisation_seconds:.2f} s"
                )
                self._bar = tqdm(
                    total=100, desc="execute", bar_format="{l_bar}{bar}| {postfix}", disable=None
                )
            self._bar.n = round(100 * motion.progress)
            self._bar.set_postfix_str(
                f"move {motion.moves_done}/{motion.moves_total} {motion.phase} {motion.object_name}"
            )
            return
        self.close()
        if feedback.message and feedback.message != self._last:
            self._last = feedback.message
            print(f"{_STAGES.get(feedback.stage, ''):8} {feedback.message}")

    def close(self) -> None:
        """Ends the progress bar, if there is one."""
        if self._bar is not None:
            self._bar.close()
            self._bar = None

    def _show_plan(self, feedback: AchieveGoal.Feedback) -> None:
        print(f"plan     {len(feedback.plan.moves)} moves")
        for line in describe_plan(feedback.plan, feedback.states):
            print(f"           {line}")
        graphs = [feedback.plan.initial, *feedback.states]
        name = "plan.png" if self.pictures == 0 else f"plan_{self.pictures + 1}.png"
        draw_plan(
            self._out / name,
            self._image,
            [graph_from_message(graph).stacks() for graph in graphs],
            moves_from_messages(feedback.plan.moves),
            self._goal,
        )
        self.pictures += 1


_STAGES = {
    AchieveGoal.Feedback.PERCEIVING: "look",
    AchieveGoal.Feedback.PLANNING: "plan",
    AchieveGoal.Feedback.OPTIMISING: "motion",
    AchieveGoal.Feedback.EXECUTING: "execute",
    AchieveGoal.Feedback.CONFIRMING: "confirm",
    AchieveGoal.Feedback.CANCELLING: "cancel",
}


def run_demo(options: argparse.Namespace) -> TaskResult:
    """Runs the demo against the running graph; see the module."""
    parameters = {"sim_node": {"real_time_factor": float(options.real_time_factor)}}
    with (
        NodeProcesses(options.out / "logs", parameters) as processes,
        SceneObserver(pictures=True) as observer,
        PlannerClient() as planner,
    ):
        print(f"start    four nodes; logs in {options.out / 'logs'}")
        initial = observer.reset(options.seed, options.blocks, timeout=60.0)
        stacks = true_stacks(initial)
        assert stacks is not None, "a scene that was just built stands"
        goal = options.goal or goal_text(random_goal(initial.names, options.seed))
        print(f"scene    {format_stacks(stacks)}")
        print(f"goal     {goal}")
        graph = observer.confident_graph(timeout=60.0)
        print(
            f"look     {len(graph.objects)} blocks, confidence {graph.confidence:.2f}, "
            f"{1e3 * graph.processing_seconds:.0f} ms from image to graph"
        )
        observer.recording = Recording()
        narrator = Narrator(options.out, observer.image(), goal)
        try:
            result = run_task(planner, observer, initial, goal, narrator, processes.check)
        finally:
            narrator.close()
        if narrator.pictures == 0:  # nothing to do, or refused: show the scene as it is
            draw_plan(options.out / "plan.png", observer.image(), [stacks], [], goal)
        time.sleep(0.5)  # a last picture of the finished scene
        observer.recording.write_gif(options.out / "execution.gif")
        return result


def main() -> int:
    """Entry point; returns the exit code."""
    parser = argparse.ArgumentParser(description=__doc__, prog="ros2 run tamp_bringup demo")
    parser.add_argument("--seed", type=int, default=0, help="seed of scene and goal")
    parser.add_argument(
        "--blocks", type=int, help="number of blocks, 3 to 7; default 5, or as many as the goal has"
    )
    parser.add_argument(
        "--goal",
        default="",
        help='e.g. "red on blue", in the first scene from the seed on that has these blocks; '
        "default: random by seed",
    )
    parser.add_argument("--out", type=Path, help="folder for the results; default runs/<time>")
    parser.add_argument("--real-time-factor", type=float, default=1.0, help="0: as fast as it goes")
    options = parser.parse_args(remove_ros_args(sys.argv)[1:])
    if problem := _problem(options):
        parser.error(problem)
    # Into a pipe or a file, too, a stage shows when it happens.
    if isinstance(sys.stdout, io.TextIOWrapper):
        sys.stdout.reconfigure(line_buffering=True)
    options.out = options.out or Path("runs") / datetime.now().strftime("%Y-%m-%d_%H-%M-%S")
    try:
        asked_for = options.seed
        options.seed, options.blocks = scene_for_goal(options.goal, options.seed, options.blocks)
    except (SceneForGoalError, PlannerError) as error:
        parser.error(f"--goal: {error}")
    try:
        make_writable_folder(options.out)
    except OSError as error:
        parser.error(f"--out {options.out}: cannot be written: {error.strerror}")
    if options.seed != asked_for:
        print(
            f"demo     scene {options.seed}: the first from {asked_for} on with the goal's blocks"
        )
    domain = use_own_domain()
    prepare_process()
    print(f"demo     ROS_DOMAIN_ID={domain}: with it, other terminals can listen in")
    # Ctrl-C must reach this program as KeyboardInterrupt, so that it can stop the arm first.
    rclpy.init(args=sys.argv, signal_handler_options=SignalHandlerOptions.NO)
    try:
        result = run_demo(options)
    except KeyboardInterrupt:
        print("\nstopped; the goal was cancelled and the nodes are down")
        return 130
    except SimulationError as error:  # before there was a task
        result = TaskResult(
            False,
            options.goal,
            triples(frozenset()),
            triples(frozenset()),
            0,
            0,
            0,
            dict.fromkeys(("perceive", "plan", "motion", "execute", "total"), 0.0),
            Failure("sim", str(error)),
        )
    finally:
        rclpy.try_shutdown()
    (options.out / "result.json").write_text(json.dumps(result.to_json(), indent=2) + "\n")
    if result.success:
        print(
            f"done     success: {result.moves_executed} moves in {result.timing_s['total']:.0f} s, "
            f"confirmed by the simulator; see {options.out}"
        )
        return 0
    assert result.failure is not None
    print(f"done     failed in {result.failure.module}: {result.failure.reason}; see {options.out}")
    return 1


def _problem(options: argparse.Namespace) -> str:
    """What is wrong with the arguments, before anything is started."""
    if options.blocks is not None and not 3 <= options.blocks <= 7:
        return f"--blocks {options.blocks}: 3 to 7 are possible"
    if not 0 <= options.seed <= MAX_SEED:
        return f"--seed {options.seed}: 0 to {MAX_SEED} are possible"
    if not 0.0 <= options.real_time_factor < math.inf:
        return f"--real-time-factor {options.real_time_factor}: must be 0 or more"
    return ""


def make_writable_folder(folder: Path) -> None:
    """Makes a folder and sees that files can be made in it; raises OSError."""
    folder.mkdir(parents=True, exist_ok=True)
    with tempfile.TemporaryFile(dir=folder):
        pass
