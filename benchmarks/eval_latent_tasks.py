# SPDX-License-Identifier: Apache-2.0
"""``make eval-latent-tasks``: goal images met in the simulator through plan_to_goal, on codes.

The graph runs in this process. The planner's representation is latent: it gets the camera's picture
and a goal image, no segmentation and no text; the ground truth judges.
"""

from __future__ import annotations

import argparse
import time
from dataclasses import dataclass
from typing import Any

import numpy as np
import rclpy
from latent.blocks_world import COLORS
from numpy.typing import NDArray
from rclpy.parameter import Parameter
from results_file import Row, print_rows, quick, wilson_interval, write_result
from sensor_msgs.msg import Image
from std_msgs.msg import Header
from tamp_interfaces.srv import PlanToGoal
from tamp_runtime.domain import reserve_domain
from tamp_runtime.messages.images import image_from_array
from tamp_runtime.node_process import prepare_process
from tamp_runtime.node_thread import NodeThread

from motion_node.node import MotionNode
from perception_node.node import PerceptionNode
from planner_node.cli.client import PlannerClient
from planner_node.node import PlannerNode
from scene_graph import Stacks, object_name
from sim_node import World, random_arrangement
from sim_node.node import SimNode
from tamp_bringup.scene_observer import SceneObserver, true_stacks

#: Of the first task; seeds from 1000 on are those of benchmarks.
FIRST_SEED = 1000
#: A task that is not done by then has failed [s].
TIMEOUT = 300.0
#: So often a plan is asked for again whose execution failed.
ATTEMPTS = 3


@dataclass(frozen=True)
class Outcome:
    """What became of a task.

    Attributes:
        reached: by the ground truth.
        moves: of all plans.
        planning_seconds: from the last request to its answer.
        message: of the planner.
    """

    seed: int
    reached: bool
    moves: int
    planning_seconds: float
    message: str


def task(seed: int) -> tuple[Stacks, Stacks]:
    """Start and goal: four or five boxes in random states that differ."""
    rng = np.random.default_rng([seed, 11])
    names = [object_name(color, "box") for color in COLORS[: 4 + seed % 2]]
    start = random_arrangement(names, rng)
    goal = start
    while goal == start:
        goal = random_arrangement(names, rng)
    return start, goal


def picture(goal: Stacks, seed: int) -> NDArray[np.uint8]:
    """What the simulator's camera would see of the goal."""
    with World() as world:
        world.reset(goal, seed + 1)
        return world.render().rgb


def run_task(planner: PlannerClient, observer: SceneObserver, seed: int) -> Outcome:
    """Has the goal image of a seed met."""
    start, goal = task(seed)
    observer.reset(seed=seed, layout=start)
    observer.confident_graph(60.0)
    image = image_from_array(picture(goal, seed), "rgb8", Header())
    begun = time.monotonic()
    seconds, moves, reached, message = 0.0, 0, False, ""
    for _ in range(ATTEMPTS):
        answer, seconds = _ask(planner, image)
        moves, message = moves + len(answer.plan.moves), answer.message
        reached = _reached(planner, observer, goal, image, begun + TIMEOUT)
        if reached or time.monotonic() > begun + TIMEOUT:
            break
    return Outcome(seed, reached, moves, seconds, message)


def _ask(planner: PlannerClient, image: Image) -> tuple[PlanToGoal.Response, float]:
    """The answer to the goal image, and how long it took; waits while the arm is not free."""
    while True:
        begun = time.monotonic()
        answer = planner.plan(goal_image=image, execute=True, timeout=60.0)
        if answer.status not in (answer.BUSY, answer.NO_SCENE_GRAPH):
            return answer, time.monotonic() - begun
        time.sleep(0.5)


def _reached(
    planner: PlannerClient, observer: SceneObserver, goal: Stacks, image: Image, deadline: float
) -> bool:
    """Whether the truth becomes the goal while the plan is carried out."""
    while time.monotonic() < deadline:
        if true_stacks(observer.fresh_truth()) == goal:
            return True
        if planner.plan(goal_image=image, timeout=60.0).status != PlanToGoal.Response.BUSY:
            return true_stacks(observer.fresh_truth()) == goal
        time.sleep(0.5)
    return False


def main() -> int:
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--n", type=int, default=3 if quick() else 20, help="tasks")
    options = parser.parse_args()
    begun = time.perf_counter()
    outcomes = run_all(options.n)
    reached = sum(outcome.reached for outcome in outcomes)
    seconds = [outcome.planning_seconds for outcome in outcomes]
    rows = [
        Row("goal images, 4 and 5 blocks", "tasks done through plan_to_goal", reached, "",
            len(outcomes), wilson_interval(reached, len(outcomes)), required=">= 18"),
        Row("goal images, 4 and 5 blocks", "plan_to_goal answers, median",
            float(np.median(seconds)), "s", len(seconds), (min(seconds), max(seconds))),
    ]  # fmt: skip
    print_rows(rows)
    details: dict[str, Any] = {"outcomes": [vars(outcome) for outcome in outcomes]}
    elapsed = time.perf_counter() - begun
    print(write_result("latent_tasks", "make eval-latent-tasks", rows, elapsed, details))
    return 0


def run_all(count: int) -> list[Outcome]:
    """All tasks on one graph."""
    prepare_process()
    rclpy.init(domain_id=reserve_domain())
    clock = [Parameter("use_sim_time", value=True)]
    latent = [*clock, Parameter("representation", value="latent")]
    nodes = [
        SimNode(parameter_overrides=[Parameter("real_time_factor", value=0.0)]),
        PerceptionNode(parameter_overrides=clock),
        PlannerNode(parameter_overrides=latent),
        MotionNode(parameter_overrides=clock),
    ]
    spinning = NodeThread(*nodes, threads=8)
    outcomes = []
    try:
        with PlannerClient() as planner, SceneObserver() as observer:
            for seed in range(FIRST_SEED, FIRST_SEED + count):
                outcomes.append(run_task(planner, observer, seed))
                print(outcomes[-1], flush=True)
    finally:
        spinning.stop()
        for node in reversed(nodes):
            node.destroy_node()
        rclpy.try_shutdown()
    return outcomes


if __name__ == "__main__":
    raise SystemExit(main())
