# SPDX-License-Identifier: Apache-2.0
"""The planner between fake neighbours."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from typing import Any

import pytest
from planner_neighbours import Behaviour, FakeMotion, FakePerception, World
from rclpy.parameter import Parameter
from tamp_interfaces.msg import MotionStatus

from planner_node.cli.client import PlannerClient
from planner_node.node import PlannerNode
from scene_graph import Stacks

START: Stacks = (("red_box", "blue_box"), ("green_box",), ())


def _parameters(values: dict[str, Any]) -> list[Parameter]:
    return [Parameter(name, value=value) for name, value in values.items()]


class Bench:
    """A planner, its neighbours and a client, all in one context.

    Args:
        earlier: a plan that the motion node carries out since before the planner was there.
        with_motion: whether there is a motion node.
    """

    def __init__(
        self,
        ros: Any,
        *behaviours: Behaviour,
        earlier: str = "",
        with_motion: bool = True,
        **parameters: Any,
    ) -> None:
        self.ros = ros
        self.world = World(START)
        self.perception = ros.add(FakePerception(self.world, context=ros.context))
        self.motion = FakeMotion(self.world, *behaviours, context=ros.context)
        if earlier:
            self.motion.busy.acquire()
            self.motion.report(earlier, MotionStatus.EXECUTING)
        if with_motion:
            ros.add(self.motion)
        else:
            self.motion.destroy_node()
        self.planner = ros.add(
            PlannerNode(
                context=ros.context,
                parameter_overrides=[
                    Parameter(name, value=parameters[name]) for name in parameters
                ],
            )
        )
        self.client = PlannerClient(ros.context)
        ros.wait_until(
            lambda: (
                self.planner.count_publishers("scene_graph") == 1
                and self.planner.count_publishers("motion_status") == with_motion
                and self.perception.count_subscribers("scene_graph") == 1
                and self.planner.count_subscribers("symbolic_plan") == with_motion
                and (not with_motion or self.motion.count_publishers("symbolic_plan") == 1)
            ),
            what="discovery",
        )

    def set(self, **parameters: Any) -> None:
        """Changes parameters of the planner."""
        results = self.planner.set_parameters(_parameters(parameters))
        assert all(result.successful for result in results), results

    def wait_for_scene(self) -> None:
        """Until plan_to_goal sees a scene."""
        answer = None
        for _ in range(100):
            answer = self.client.plan("red on stack0")
            if answer.status != answer.NO_SCENE_GRAPH:
                return
        raise AssertionError(answer)

    def achieve(self, goal: str, timeout: float = 60.0) -> Any:
        self.client.start(goal)
        return self.client.result(timeout)

    def feedback_until(self, condition: Callable[[Any], bool], timeout: float = 60.0) -> list[Any]:
        """All feedback up to the first that fulfils the condition."""
        seen: list[Any] = []

        def found() -> bool:
            feedback = self.client.next_feedback(timeout=0.05)
            if feedback:
                seen.append(feedback)
            return feedback is not None and condition(feedback)

        self.ros.wait_until(found, timeout, "feedback")
        return seen


@pytest.fixture
def make_bench(ros_context: Any) -> Iterator[Callable[..., Bench]]:
    """``make_bench(*behaviours_of_motion, **parameters)``."""
    benches: list[Bench] = []

    def make(*behaviours: Behaviour, **parameters: Any) -> Bench:
        benches.append(Bench(ros_context, *behaviours, **parameters))
        return benches[-1]

    yield make
    for bench in benches:
        bench.client.close()
