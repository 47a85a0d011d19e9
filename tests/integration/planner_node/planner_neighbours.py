# SPDX-License-Identifier: Apache-2.0
"""Stand-ins for perception_node and motion_node, and a world of stacks that they share."""

from __future__ import annotations

import threading
from collections.abc import Callable
from dataclasses import dataclass, field
from typing import Any

from geometry_msgs.msg import Point
from rclpy.callback_groups import ReentrantCallbackGroup
from rclpy.node import Node
from rclpy.time import Time
from std_msgs.msg import Header
from tamp_interfaces.msg import Base, MotionStatus, SceneGraph, SceneObject, SymbolicPlan
from tamp_interfaces.srv import ImageToSceneGraph
from tamp_runtime.messages.scene_graph import relations_to_messages
from tamp_runtime.qos import LATCHED, NEWEST, STATUS

from scene_graph import Move, Stacks, apply_move, up_relations

PERIOD = 0.05


@dataclass
class World:
    """What is on the table."""

    stacks: Stacks
    moves: list[Move] = field(default_factory=list)

    def carry_out(self, move: Move) -> None:
        self.stacks = apply_move(self.stacks, move)
        self.moves.append(move)


def scene_message(stacks: Stacks, stamp: Any, **fields: Any) -> SceneGraph:
    names = sorted(name for stack in stacks for name in stack)
    return SceneGraph(
        header=Header(stamp=stamp, frame_id="world"),
        objects=[
            SceneObject(name=name, color=name.split("_")[0], shape=name.split("_")[1])
            for name in names
        ],
        relations=fields.pop("relations", relations_to_messages(up_relations(stacks))),
        bases=[Base(index=i, position=Point(x=0.1 * i)) for i in range(len(stacks))],
        confidence=fields.pop("confidence", 0.9),
        **fields,
    )


class FakePerception(Node):
    """Publishes the world at 20 Hz, with the fields of ``fault`` when something is wrong.

    Attributes:
        silent: nothing is published.
        clock_offset: added to the stamps [s].
        shown: what goal images show; None: the service does not answer in time.
    """

    def __init__(self, world: World, **kwargs: Any) -> None:
        super().__init__("fake_perception", **kwargs)
        self.world = world
        self.fault: dict[str, Any] = {}
        self.silent = False
        self.clock_offset = 0.0
        self.shown: SceneGraph | None = None
        self.requests: list[ImageToSceneGraph.Request] = []
        self.released = threading.Event()
        self._publisher = self.create_publisher(SceneGraph, "scene_graph", NEWEST)
        self.create_timer(PERIOD, self.publish)

    def publish(self) -> None:
        if not self.silent and self.context.ok():
            self._publisher.publish(scene_message(self.world.stacks, self.stamp(), **self.fault))

    def publish_message(self, message: SceneGraph) -> None:
        self._publisher.publish(message)

    def serve_images(self) -> None:
        self.create_service(
            ImageToSceneGraph,
            "image_to_scene_graph",
            self._on_image,
            callback_group=ReentrantCallbackGroup(),
        )

    def stamp(self) -> Any:
        now = self.get_clock().now().nanoseconds + int(self.clock_offset * 1e9)
        return Time(nanoseconds=now).to_msg()

    def _on_image(
        self, request: ImageToSceneGraph.Request, response: ImageToSceneGraph.Response
    ) -> ImageToSceneGraph.Response:
        self.requests.append(request)
        if self.shown is None:
            self.released.wait(5.0)
        response.scene_graph = self.shown or SceneGraph()
        return response


#: What a motion node does with a plan; `motion.report` publishes.
Behaviour = Callable[["FakeMotion", SymbolicPlan], None]


class FakeMotion(Node):
    """Takes up plans and treats one after the other as ``behaviours`` say; then it obeys.

    Once a second it says that it lives, while it does nothing else.

    Attributes:
        arm, held: what it says of the arm.
    """

    def __init__(self, world: World, *behaviours: Behaviour, **kwargs: Any) -> None:
        super().__init__("fake_motion", **kwargs)
        self.world = world
        self.behaviours = list(behaviours)
        self.plans: list[SymbolicPlan] = []
        self.stops: list[SymbolicPlan] = []
        self.arm = MotionStatus.ARM_HOME
        self.held = ""
        self.busy = threading.Lock()
        self.stop_requested = threading.Event()
        self.closing = threading.Event()
        self._publisher = self.create_publisher(MotionStatus, "motion_status", STATUS)
        self.create_subscription(
            SymbolicPlan,
            "symbolic_plan",
            self._on_plan,
            LATCHED,
            callback_group=ReentrantCallbackGroup(),
        )
        self.create_timer(1.0, self._beat, callback_group=ReentrantCallbackGroup())

    def report(self, plan_id: str, state: int, **fields: Any) -> None:
        header = Header(stamp=self.get_clock().now().to_msg())
        fields = {"arm": self.arm, "held": self.held, **fields}
        self._publisher.publish(MotionStatus(header=header, plan_id=plan_id, state=state, **fields))

    def destroy_node(self) -> None:
        self.closing.set()
        super().destroy_node()

    def _beat(self) -> None:
        if self.context.ok() and self.busy.acquire(blocking=False):
            self.report("", MotionStatus.IDLE)
            self.busy.release()

    def _on_plan(self, plan: SymbolicPlan) -> None:
        if not plan.moves:
            self.stops.append(plan)
            self.stop_requested.set()
            if plan.plan_id.startswith("home-"):
                self._go_home(plan.plan_id)
            return
        if plan.plan_id not in {known.plan_id for known in self.plans}:
            self.take_up(plan)

    def take_up(self, plan: SymbolicPlan) -> None:
        """Treats a plan that is new."""
        self.plans.append(plan)
        behaviour = self.behaviours.pop(0) if self.behaviours else obey
        with self.busy:
            behaviour(self, plan)

    def _go_home(self, plan_id: str) -> None:
        with self.busy:
            self.report(plan_id, MotionStatus.EXECUTING, phase="home", arm=MotionStatus.ARM_MOVING)
            self.arm, self.held = MotionStatus.ARM_HOME, ""
            self.report(plan_id, MotionStatus.CANCELLED, message="at home")


def obey(motion: FakeMotion, plan: SymbolicPlan) -> None:
    """Everything goes well."""
    motion.report(plan.plan_id, MotionStatus.OPTIMISING, message="optimising")
    for index, move in enumerate(plan.moves):
        motion.world.carry_out(Move(move.source, move.target))
        motion.report(
            plan.plan_id,
            MotionStatus.EXECUTING,
            move=index,
            moves_done=index + 1,
            moves_total=len(plan.moves),
            object_name=move.object_name,
            phase="place",
            progress=(index + 1) / len(plan.moves),
        )
    motion.report(
        plan.plan_id,
        MotionStatus.SUCCEEDED,
        moves_done=len(plan.moves),
        moves_total=len(plan.moves),
        progress=1.0,
        optimisation_seconds=0.01,
    )


def run_until_stopped(motion: FakeMotion, plan: SymbolicPlan) -> None:
    """Moves on and on; puts down what it holds when it is stopped."""
    while not motion.stop_requested.wait(PERIOD) and not motion.closing.is_set():
        if not motion.context.ok():
            return
        motion.report(plan.plan_id, MotionStatus.EXECUTING, moves_total=len(plan.moves))
    motion.world.carry_out(Move(plan.moves[0].source, plan.moves[0].target))
    motion.report(
        plan.plan_id, MotionStatus.CANCELLED, moves_done=1, message="put red_box down first"
    )
