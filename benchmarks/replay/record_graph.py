# SPDX-License-Identifier: Apache-2.0
"""Executes tasks by the running graph, and records what passes over its topics."""

from __future__ import annotations

import threading
import time
from dataclasses import dataclass, replace
from typing import Any, Final

import numpy as np
import rclpy
from numpy.typing import NDArray
from sensor_msgs.msg import JointState
from tamp_interfaces.msg import SceneGraph as SceneGraphMsg
from tamp_runtime.messages.scene_graph import graph_from_message
from tamp_runtime.messages.stamps import nanoseconds, seconds
from tamp_runtime.node_thread import NodeThread
from tamp_runtime.qos import LATCHED, RELIABLE, SENSOR_DATA
from trajectory_msgs.msg import JointTrajectory

from planner_node.cli.client import PlannerClient
from scene_graph import SceneGraph
from sim_node.conversions import trajectory_arrays
from sim_node.layouts import random_layout
from sim_node.world import World
from tamp_bringup.processes import NodeProcesses
from tamp_bringup.scene_observer import SceneObserver, SimulationError
from tamp_bringup.task import goal_text, random_goal
from tamp_bringup.task_runner import run_task

from .alignment import beginning
from .arm_links import bodies_in
from .recording import Body, Command, Recording, RecordingError, Trace

Array = NDArray[np.float64]

#: A scene that is farther from the one that its seed means is another one [m].
_SAME_SCENE: Final = 0.001
#: Between joint states that are farther apart nobody knows where the hand was [s].
_JOINTS_GAP: Final = 0.05


@dataclass(frozen=True)
class Heard:
    """Messages of one task.

    Attributes:
        truths, states: in the order of their arrival.
        trajectories: each with its stamp, or the simulated time at which it arrived [s].
    """

    truths: tuple[SceneGraphMsg, ...]
    states: tuple[JointState, ...]
    trajectories: tuple[tuple[float, JointTrajectory], ...]


class TopicRecorder:
    """Keeps what passes over ``joint_trajectory``, ``joint_states`` and ``sim/ground_truth``."""

    def __init__(self, **node_arguments: Any) -> None:
        """``node_arguments`` go to the node."""
        self._node = rclpy.create_node("replay_recorder", **node_arguments)
        self._news = threading.Condition()
        self._truths: list[SceneGraphMsg] = []
        self._states: list[JointState] = []
        self._trajectories: list[tuple[float, JointTrajectory]] = []
        node = self._node
        node.create_subscription(JointTrajectory, "joint_trajectory", self._on_trajectory, RELIABLE)
        node.create_subscription(JointState, "joint_states", self._on_state, SENSOR_DATA)
        node.create_subscription(SceneGraphMsg, "sim/ground_truth", self._on_truth, LATCHED)
        self._thread = NodeThread(node)

    def __enter__(self) -> TopicRecorder:
        return self

    def __exit__(self, *_error: object) -> None:
        self._thread.stop()
        self._node.destroy_node()

    def begin(self, timeout: float = 20.0) -> None:
        """Forgets everything, and returns when a scene and the arm have been heard of again.

        Raises:
            SimulationError: nothing arrives.
        """
        deadline = time.monotonic() + timeout
        with self._news:
            for kept in (self._truths, self._states, self._trajectories):
                kept.clear()
            while not (self._truths and self._states):
                if not self._news.wait(max(0.0, deadline - time.monotonic())):
                    raise SimulationError(
                        f"sim_node publishes no ground truth within {timeout:g} s"
                    )

    def heard(self) -> Heard:
        """What has passed since :meth:`begin`."""
        with self._news:
            return Heard(tuple(self._truths), tuple(self._states), tuple(self._trajectories))

    def _on_truth(self, message: SceneGraphMsg) -> None:
        with self._news:
            self._truths.append(message)
            self._news.notify_all()

    def _on_state(self, message: JointState) -> None:
        with self._news:
            self._states.append(message)
            self._news.notify_all()

    def _on_trajectory(self, message: JointTrajectory) -> None:
        with self._news:
            stamp = seconds(message.header.stamp)
            if not stamp and self._states:
                stamp = seconds(self._states[-1].header.stamp)
            self._trajectories.append((stamp, message))


def recording_of(
    heard: Heard, bodies: tuple[Body, ...], joints: tuple[str, ...], step: float, **about: Any
) -> Recording:
    """A recording of what was heard; it begins with the first ground truth.

    Args:
        bodies: of the scene; blocks are where that ground truth has them.
        joints: names, in the recording's order.
        step: of the controller [s].
        about: what else a recording has to say.

    Raises:
        RecordingError: a block is not where ``bodies`` has it.
    """
    truths, states = list(heard.truths), heard.states
    zero = seconds(truths[0].header.stamp)
    names = tuple(body.name for body in bodies if body.mass > 0.0)
    at = np.array([seconds(state.header.stamp) - zero for state in states])
    positions = np.array([_ordered(state, joints) for state in states])
    truths = [truths[0], *(t for t in truths[1:-1] if _known(t, at + zero)), truths[-1]]
    times = np.array([seconds(truth.header.stamp) - zero for truth in truths])
    graphs = [graph_from_message(truth) for truth in truths]
    trace = Trace(
        times,
        np.array([np.interp(times, at, column) for column in positions.T]).T,
        np.array([_poses(graph, names) for graph in graphs]),
        names,
    )
    commands = []
    for stamp, message in heard.trajectories:
        since, points, rates = trajectory_arrays(message)
        if message.points:
            order = [message.joint_names.index(name) for name in joints]
            points = points[:, order]
            rates = None if rates is None else rates[:, order]
        began = max(stamp - zero, 0.0)
        if message.points and not nanoseconds(message.header.stamp):
            began = beginning(began, since, points, at, positions, step)
        commands.append(Command(began, since, points, rates))
    commands.sort(key=lambda command: command.begins)
    relations = sorted((r.subject, r.predicate, r.object) for r in graphs[-1].relations)
    return Recording(
        source="graph",
        joints=joints,
        bodies=tuple(_placed(body, graphs[0]) for body in bodies),
        start=positions[0],
        commands=tuple(commands),
        trace=trace,
        relations=tuple(relations),
        **about,
    )


def record_task(
    processes: NodeProcesses,
    observer: SceneObserver,
    planner: PlannerClient,
    recorder: TopicRecorder,
    world: World,
    seed: int,
    blocks: int,
) -> Recording:
    """Has the graph execute the task of a seed, as ``make eval-tasks`` draws it.

    Args:
        world: is reset to the same scene, for what no topic says: masses and frictions.

    Raises:
        RecordingError: the simulator's scene is not the one that its seed means.
        SimulationError, NodeDiedError: the graph is not well.
    """
    world.reset(random_layout(seed, blocks, world.config.stack_count), seed)
    initial = observer.reset(seed, blocks, timeout=60.0)
    recorder.begin()
    goal = goal_text(random_goal(initial.names, seed))
    result = run_task(planner, observer, initial, goal, check_alive=processes.check)
    return recording_of(
        recorder.heard(),
        bodies_in(world),
        world.arm.joints,
        world.timestep,
        seed=seed,
        goal=goal,
        success=result.success,
        robot=world.arm.name,
        places=world.config.stack_positions,
    )


def _known(truth: SceneGraphMsg, stamps: Array) -> bool:
    """Whether joint states are known close to a ground truth: on a busy machine some get lost."""
    stamp = seconds(truth.header.stamp)
    after = int(np.searchsorted(stamps, stamp))
    return 0 < after < len(stamps) and stamps[after] - stamps[after - 1] < _JOINTS_GAP


def _placed(body: Body, graph: SceneGraph) -> Body:
    """A block where the graph has it."""
    if body.mass == 0.0:
        return body
    seen = graph.object(body.name)
    off = float(np.abs(np.subtract(seen.position_world, body.position)).max())
    if off > _SAME_SCENE:
        raise RecordingError(
            f"{body.name} is {1e3 * off:.1f} mm from where a scene of this seed has it; does the "
            "simulator run the same code?"
        )
    return replace(body, position=seen.position_world, quaternion=seen.quaternion_world)


def _poses(graph: SceneGraph, names: tuple[str, ...]) -> Array:
    found = {item.name: item for item in graph.objects}
    return np.array(
        [[*found[name].position_world, *found[name].quaternion_world] for name in names]
    )


def _ordered(state: JointState, joints: tuple[str, ...]) -> list[float]:
    found = dict(zip(state.name, state.position))
    return [found[name] for name in joints]
