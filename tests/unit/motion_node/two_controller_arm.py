# SPDX-License-Identifier: Apache-2.0
"""An arm of two joints and its gripper, with a stock controller each, between them the topics."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, field, replace
from typing import Any

import numpy as np
from simulated_arm import HOME_Q, OPEN, SimulatedArm
from stock_oracle import StockOracle

from motion_node.conversions import trajectory_to_two_messages
from motion_node.robots import PANDA
from motion_node.robots.joints import JointValues
from motion_node.timing.trajectory import Trajectory

ARM = replace(PANDA, arm_joints=("shoulder", "elbow"), home=(0.0, 0.0), acceleration=(8.0, 8.0))


@dataclass
class Topic:
    """A topic and the controller at its end.

    Attributes:
        heard: the messages that were published.
        lost: nothing arrives.
        late: how much later everything arrives [s].
        stopped: the controller takes nothing, and holds where its joints are.
    """

    controller: StockOracle
    heard: list[Any] = field(default_factory=list)
    lost: bool = False
    late: float = 0.0
    stopped: bool = False


class TwoControllerArm(SimulatedArm):
    """As :class:`SimulatedArm`; what jumps by more than its hardware does is refused."""

    JUMP = 0.1

    def __init__(self) -> None:
        super().__init__()
        fingers = StockOracle(ARM.gripper.finger_joints, [OPEN, OPEN])
        self.arm_topic = Topic(StockOracle(ARM.arm_joints, HOME_Q.tolist()))
        self.gripper_topic = Topic(fingers)
        self.topics = {"arm": self.arm_topic, "gripper": self.gripper_topic}
        self.begins: list[float | None] = []
        self.history: list[tuple[float, JointValues]] = []
        self._under_way: list[tuple[float, Callable[[], object]]] = []

    @property
    def stamp(self) -> float:
        """The time by its clock [s]."""
        return self._stamp

    def send(self, trajectory: Trajectory, _begins: float | None = None) -> None:
        self.sent.append((trajectory, self.joints))
        self.begins.append(_begins)
        messages = trajectory_to_two_messages(trajectory, ARM, _begins)
        for topic, message in zip((self.arm_topic, self.gripper_topic), messages):
            topic.heard.append(message)
            if not topic.lost:
                arrives = self._stamp + topic.late
                self._under_way.append((arrives, lambda t=topic, m=message: self._arrive(t, m)))  # type: ignore[misc]

    def stop_controller(self, name: str) -> None:
        """One of the two stops."""
        self.topics[name].stopped = True
        self._know_states()
        self.topics[name].controller.stand()

    def _arrive(self, topic: Topic, message: Any) -> None:
        if topic.stopped:
            return
        self._know_states()
        before = topic.controller.__dict__.copy()
        topic.controller.hear(message, self._stamp)
        if topic is self.arm_topic:
            jump = np.abs(np.subtract(topic.controller.sample(self._stamp), self.joints.arm)).max()
            if jump > self.JUMP:
                topic.controller.__dict__.update(before)

    def _know_states(self) -> None:
        self.arm_topic.controller.state = self.joints.arm.tolist()
        self.gripper_topic.controller.state = self.joints.fingers.tolist()

    def _commanded(self) -> JointValues:
        for item in [item for item in self._under_way if item[0] <= self._stamp]:
            self._under_way.remove(item)
            item[1]()
        arm, fingers = (topic.controller.sample(self._stamp) for topic in self.topics.values())
        self.history.append((self._stamp, self.joints))
        return JointValues(np.array(arm), np.array(fingers))
