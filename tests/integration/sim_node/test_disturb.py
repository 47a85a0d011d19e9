# SPDX-License-Identifier: Apache-2.0
"""sim/disturb: what is asked for happens in the running simulator, and is told and seen."""

from __future__ import annotations

import threading
from typing import Any

import numpy as np
import pytest
from geometry_msgs.msg import Vector3
from rclpy.node import Node
from rclpy.parameter import Parameter
from ros2_run import Start, finish
from sensor_msgs.msg import Image
from tamp_interfaces.msg import SceneGraph
from tamp_interfaces.srv import Disturb, ResetScene
from tamp_runtime.messages.images import array_from_image
from tamp_runtime.messages.scene_graph import graph_from_message
from tamp_runtime.messages.stamps import nanoseconds, stamp_from_nanoseconds
from tamp_runtime.qos import LATCHED, NEWEST

from sim_node.disturbance.disturber import CALM
from sim_node.disturbance.kinds import KINDS
from sim_node.disturbance.request import MOMENTS
from sim_node.node import SimNode

LAYOUT = ["red_box,blue_box", "", "green_box"]


class Neighbour(Node):
    """Hears the truth and what the camera sees, and asks."""

    def __init__(self, **kwargs: Any) -> None:
        super().__init__("neighbour", **kwargs)
        self.truths: list[SceneGraph] = []
        self.labels: list[set[int]] = []
        self.create_subscription(SceneGraph, "sim/ground_truth", self.truths.append, LATCHED)
        self.create_subscription(Image, "camera/segmentation", self._on_labels, NEWEST)
        self.disturb = self.create_client(Disturb, "sim/disturb")
        self.reset = self.create_client(ResetScene, "sim/reset")

    def _on_labels(self, message: Image) -> None:
        self.labels.append(set(np.unique(array_from_image(message, "16UC1")).tolist()))

    def names(self) -> set[str]:
        """Of the blocks, by the newest truth."""
        return set(graph_from_message(self.truths[-1]).names) if self.truths else set()


class Bench:
    """A simulator and its neighbour, in a namespace of their own."""

    def __init__(self, ros: Any, namespace: str = "", factor: float = 0.0) -> None:
        self.ros = ros
        arguments = {"context": ros.context, "namespace": namespace}
        parameters = [
            Parameter("layout", value=LAYOUT),
            Parameter("real_time_factor", value=factor),
        ]
        self.sim = ros.add(SimNode(parameter_overrides=parameters, **arguments))
        self.node = ros.add(Neighbour(**arguments))
        ros.wait_until(lambda: self.node.truths, what="the truth")
        assert self.node.disturb.wait_for_service(timeout_sec=60.0)
        assert self.node.reset.wait_for_service(timeout_sec=60.0)

    def ask(self, kind: str, *blocks: str, **fields: Any) -> Disturb.Response:
        return self._answer(
            self.node.disturb.call_async(Disturb.Request(kind=kind, blocks=blocks, **fields))
        )

    def reset(self, **fields: Any) -> ResetScene.Response:
        return self._answer(self.node.reset.call_async(ResetScene.Request(**fields)))

    def _answer(self, future: Any) -> Any:
        self.ros.wait_until(future.done, what="the answer")
        return future.result()


@pytest.fixture
def bench(ros_context: Any) -> Bench:
    return Bench(ros_context)


def test_blocks_come_and_go_and_the_truth_and_the_camera_tell(
    ros_context: Any, bench: Bench
) -> None:
    added = bench.ask(Disturb.Request.ADD, "pink_box", on="stack1")
    assert (added.success, added.id) == (True, 1)
    assert added.message == "pink_box is added on stack1, now"
    ros_context.wait_until(lambda: "pink_box" in bench.node.names(), what="the added block")
    ros_context.wait_until(lambda: bench.node.labels[-1:] == [{0, 1, 2, 3, 4}])
    assert bench.ask(Disturb.Request.TAKE_AWAY, "red_box").id == 2
    ros_context.wait_until(lambda: "red_box" not in bench.node.names(), what="it is gone")
    ros_context.wait_until(
        lambda: (
            graph_from_message(bench.node.truths[-1]).stacks()
            == (("blue_box",), ("pink_box",), ("green_box",))
        ),
        what="blue_box has fallen",
    )


def test_the_interface_names_every_kind_and_moment() -> None:
    names = [name for name in dir(Disturb.Request) if name.isupper() and name != "SLOT_TYPES"]
    constants = {str(getattr(Disturb.Request, name)) for name in names}
    assert constants == {*KINDS, CALM, *MOMENTS}


def test_a_cover_is_drawn_for_a_while(ros_context: Any, bench: Bench) -> None:
    ros_context.wait_until(lambda: bench.node.labels)
    assert bench.ask(Disturb.Request.COVER, what="sheet", seconds=20.0).success
    ros_context.wait_until(lambda: {0} in bench.node.labels, what="nothing is seen")
    ros_context.wait_until(lambda: bench.node.labels[-1] == {0, 1, 2, 3}, what="it is gone")


def test_refusals_change_nothing_and_say_so(bench: Bench) -> None:
    before = bench.node.names()
    for answer in (
        bench.ask("explode"),
        bench.ask(Disturb.Request.TAKE_AWAY, "teapot"),
        bench.ask(Disturb.Request.PUSH, "red_box", direction=Vector3(x=float("nan"))),
        bench.ask(Disturb.Request.SLIP, when=Disturb.Request.RELEASE),
        bench.ask(
            Disturb.Request.SHOVE,
            when=Disturb.Request.AT,
            stamp=stamp_from_nanoseconds(1_000_000_000),
        ),
    ):
        assert (answer.success, answer.id) == (False, 0)
        assert answer.message.endswith("; the world is as it was")
    assert bench.ask(Disturb.Request.JAM).id == 1
    assert bench.node.names() == before


def test_a_reset_drops_what_is_pending(bench: Bench) -> None:
    assert bench.ask(Disturb.Request.SLIP, when=Disturb.Request.GRASP).success
    assert bench.ask(Disturb.Request.JAM, delay=3000.0).success
    answer = bench.reset(layout=LAYOUT)
    assert answer.message.endswith("dropped 2 disturbances, pending or under way")
    assert "dropped" not in bench.reset(layout=LAYOUT).message


def test_calm_drops_and_ends_without_a_reset(ros_context: Any, bench: Bench) -> None:
    assert bench.ask(Disturb.Request.COVER, what="sheet", seconds=60.0).success
    assert bench.ask(Disturb.Request.SLIP, when=Disturb.Request.GRASP).success
    assert bench.ask(Disturb.Request.CALM).message == "disturbances dropped or ended: 2"
    ros_context.wait_until(lambda: bench.node.labels[-1:] == [{0, 1, 2, 3}], what="it is gone")
    assert "dropped" not in bench.reset(layout=LAYOUT).message


def final_poses(ros: Any, namespace: str, factor: float) -> list[tuple[float, ...]]:
    """Where the blocks are 6 s after a reset, after a shove at 2 s."""
    bench = Bench(ros, namespace, factor=1.0)
    start = nanoseconds(bench.reset(layout=LAYOUT, seed=5).stamp)
    asked = threading.Event()
    # Time stands still until the request is there.
    bench.sim._physics.post(lambda: asked.wait() and None)
    future = bench.node.disturb.call_async(
        Disturb.Request(
            kind=Disturb.Request.SHOVE,
            when=Disturb.Request.AT,
            stamp=stamp_from_nanoseconds(start + 2_000_000_000),
        )
    )
    ros.wait_until(lambda: bench.sim._physics._calls.qsize() > 0, what="the request")
    bench.sim.set_parameters([Parameter("real_time_factor", value=factor)])
    asked.set()
    ros.wait_until(future.done, what="the answer")
    assert future.result().success, future.result().message
    end = start + 6_000_000_000

    def at_end() -> SceneGraph | None:
        stamped = ((nanoseconds(truth.header.stamp), truth) for truth in bench.node.truths)
        return next((truth for stamp, truth in stamped if stamp >= end), None)

    ros.wait_until(at_end, what="the end")
    truth = at_end()
    assert truth is not None
    bench.sim.set_parameters([Parameter("real_time_factor", value=0.1)])
    poses = [(item.pose.position, item.pose.orientation) for item in truth.objects]
    return [(p.x, p.y, p.z, q.x, q.y, q.z, q.w) for p, q in poses]


def test_at_a_stamp_it_is_the_same_every_time_however_quick(ros_context: Any) -> None:
    first = final_poses(ros_context, "first", 4.0)
    assert max(pose[2] for pose in first) < 0.04  # the tower has fallen
    assert final_poses(ros_context, "second", 1.0) == first


def test_the_command_says_what_comes_and_why_not(ros_context: Any, start: Start) -> None:
    bench = Bench(ros_context)
    code, stdout, _ = finish(
        start("sim_node", "disturb", "push", "red_box", "--force", "5", "--when", "in_air")
    )
    assert code == 0
    assert stdout.strip() == (
        "disturbance 1: red_box is pushed with 5 N towards (1, 0, 0) for 0.1 s, at the next lift "
        "to more than 0.015 m"
    )
    code, _, stderr = finish(start("sim_node", "disturb", "take_away", "teapot"))
    assert code == 1
    assert "there is no block 'teapot'; there are blue_box, green_box, red_box" in stderr
    code, _, stderr = finish(start("sim_node", "disturb", "explode"))
    assert code == 1
    assert stderr.startswith("disturb: kind is 'explode'; there are push, swap, take_away, add")
    assert bench.sim._disturber.pending == 1


@pytest.mark.parametrize(
    ("arguments", "code", "sentence"),
    [
        (["--help"], 0, "disturb push red_box"),
        (["push", "--force", "2", "red_box", "--timeout", "1"], 1, "sim_node does not answer"),
        ([], 2, "required: KIND"),
        (["push", "red_box", "--direction", "sideways"], 2, "'sideways' is no direction"),
        (["push", "red_box", "--force", "hard"], 2, "invalid float value: 'hard'"),
        (["add", "pink_box", "--position", "1,2"], 2, "'1,2' is not X,Y,Z"),
        (["jam", "--count", "-1"], 2, "--count -1: must not be negative"),
        (["jam", "--timeout", "1"], 1, "sim_node does not answer (waited 1 s); start it with"),
    ],
)
def test_the_command_without_a_simulator(
    start: Start, arguments: list[str], code: int, sentence: str
) -> None:
    ended = finish(start("sim_node", "disturb", *arguments))
    assert ended.code == code
    assert sentence in ended.stdout + ended.stderr
