# SPDX-License-Identifier: Apache-2.0
"""What relays do to messages, without a graph: every mode against what is written down here."""

from __future__ import annotations

import math
from typing import Any

import numpy as np
import pytest
from builtin_interfaces.msg import Duration
from faults import damages, picture_damages
from faults.fault import Injection
from faults.modes import Change, Delay, Drop, Freeze, FreezeContent, Repeat, Swap
from faults.relay import Handler, Mode, read, write
from faults.topics import CLOCK, DEPTH, JOINTS, TOPICS, TRAJECTORY, groups_of, remappings
from sensor_msgs.msg import JointState
from std_msgs.msg import Header
from tamp_runtime.messages.images import array_from_image, image_from_array
from tamp_runtime.messages.stamps import nanoseconds, stamp_from_nanoseconds
from trajectory_msgs.msg import JointTrajectory, JointTrajectoryPoint


class FakeOutlet:
    """Keeps what comes out of a relay of joint states."""

    kind = JointState

    def __init__(self) -> None:
        self.last: bytes | None = None
        self.out: list[bytes] = []
        self.later: list[tuple[bytes, float]] = []

    def emit(self, message: bytes) -> None:
        self.out.append(message)

    def emit_later(self, message: bytes, seconds: float) -> None:
        self.later.append((message, seconds))

    def pass_through(self, mode: Mode, *messages: bytes) -> list[bytes]:
        handler: Handler = mode.begin(self)
        for message in messages:
            self.last = message
            handler(message)
        return self.out


def state(stamp: int = 0, *positions: float) -> JointState:
    message = JointState(header=Header(stamp=stamp_from_nanoseconds(stamp)))
    message.name = [f"joint{index}" for index in range(len(positions))]
    message.position = list(positions)
    return message


A, B, C, D = (write(state(stamp, float(stamp))) for stamp in (1, 2, 3, 4))


@pytest.fixture
def outlet() -> FakeOutlet:
    return FakeOutlet()


def test_drop_lets_nothing_pass(outlet: FakeOutlet) -> None:
    assert outlet.pass_through(Drop(), A, B) == []


def test_drop_can_let_every_second_message_pass(outlet: FakeOutlet) -> None:
    assert outlet.pass_through(Drop(keep=2), A, B, C, D) == [B, D]


def test_delay_sends_later(outlet: FakeOutlet) -> None:
    outlet.pass_through(Delay(1.5), A, B)
    assert outlet.out == [] and outlet.later == [(A, 1.5), (B, 1.5)]


def test_repeat_sends_twice_at_once_or_later(outlet: FakeOutlet) -> None:
    assert outlet.pass_through(Repeat(2), A) == [A, A]
    outlet.out.clear()
    assert outlet.pass_through(Repeat(2, after=3.0), B) == [B]
    assert outlet.later == [(B, 3.0)]


def test_swap_exchanges_neighbours(outlet: FakeOutlet) -> None:
    assert outlet.pass_through(Swap(), A, B, C, D) == [B, A, D, C]


def test_freeze_repeats_the_last_message_before_it(outlet: FakeOutlet) -> None:
    outlet.last = A
    assert outlet.pass_through(Freeze(), B, C) == [A, A]


def test_frozen_content_has_new_stamps(outlet: FakeOutlet) -> None:
    outlet.last = A
    frozen = [read(outlet, message) for message in outlet.pass_through(FreezeContent(), B, C)]
    assert [nanoseconds(item.header.stamp) for item in frozen] == [2, 3]
    assert [list(item.position) for item in frozen] == [[1.0], [1.0]]


def test_change_can_be_for_the_first_messages_only(outlet: FakeOutlet) -> None:
    outlet.pass_through(Change(damages.positions_nan, first=1), A, B)
    assert math.isnan(read(outlet, outlet.out[0]).position[0])
    assert outlet.out[1] == B


def test_a_message_that_a_damage_loses_does_not_pass(outlet: FakeOutlet) -> None:
    assert outlet.pass_through(Change(lambda _message: None), A) == []


def test_names_and_values_stay_together_when_joints_are_reordered() -> None:
    message = state(0, 1.0, 2.0, 3.0)
    before = dict(zip(message.name, message.position))
    damages.joints_reversed(message)
    assert dict(zip(message.name, message.position)) == before
    assert message.name[0] == "joint2"


def test_stretched_trajectory_keeps_its_path() -> None:
    point = JointTrajectoryPoint(positions=[0.5], velocities=[0.6])
    point.time_from_start = Duration(sec=2)
    message = damages.stretched(3.0)(JointTrajectory(points=[point]))
    assert nanoseconds(message.points[0].time_from_start) == 6_000_000_000
    assert list(message.points[0].velocities) == pytest.approx([0.2])
    assert list(message.points[0].positions) == [0.5]


def test_fingers_are_the_last_two_joints() -> None:
    point = JointTrajectoryPoint(positions=[1.0, 2.0, 0.01, 0.02], velocities=[1.0] * 4)
    message = damages.fingers_kept_at(0.04)(JointTrajectory(points=[point]))
    assert list(message.points[0].positions) == [1.0, 2.0, 0.04, 0.04]
    assert list(message.points[0].velocities) == [1.0, 1.0, 0.0, 0.0]


@pytest.mark.parametrize(
    ("change", "expected"),
    [
        (picture_damages.black, [[0.0, 0.0]]),
        (picture_damages.millimetres, [[1000.0, 2000.0]]),
        (picture_damages.mirrored, [[2.0, 1.0]]),
        (picture_damages.nearer(0.5), [[0.5, 1.5]]),
        (picture_damages.covered(0.25), [[0.25, 2.0]]),
    ],
)
def test_pixels_change_and_the_message_stays_an_image(
    change: picture_damages.Pixels, expected: list[list[float]]
) -> None:
    header = Header(stamp=stamp_from_nanoseconds(7))
    image = image_from_array(np.array([[1.0, 2.0]], np.float32), "32FC1", header)
    damaged = picture_damages.pixels(change)(image)
    assert array_from_image(damaged, "32FC1").tolist() == expected
    assert nanoseconds(damaged.header.stamp) == 7


def test_shuffled_labels_still_tell_blocks_apart() -> None:
    labels = np.array([[0, 1, 2, 5]], np.uint16)
    assert np.asarray(picture_damages.labels_shuffled(labels)).tolist() == [[0, 5, 4, 1]]


def test_relays_stand_before_the_listeners_only() -> None:
    rules = remappings([TOPICS[JOINTS], TOPICS[TRAJECTORY], TOPICS[CLOCK]])
    assert rules["motion_node"] == {JOINTS: "faulty/joint_states", "/clock": "/faulty/clock"}
    assert rules["sim_node"] == {TRAJECTORY: "faulty/joint_trajectory"}
    assert rules["planner_node"] == {"/clock": "/faulty/clock"}


def test_topics_of_one_stream_are_relayed_together() -> None:
    assert groups_of([DEPTH]) == {"camera"}
    assert groups_of([JOINTS, TRAJECTORY]) == {"arm"}
    assert groups_of([]) == frozenset()


def test_every_declared_damage_can_be_applied_to_an_empty_message() -> None:
    """A damage that fails would leave the topic silent: a fault that nobody declared."""
    from faults.catalogue import CATALOGUE

    for fault in CATALOGUE:
        for injection in parts(fault.injection):
            mode: Any = getattr(injection, "mode", None)
            if mode is None:
                continue
            for topic in injection.topics:
                if TOPICS[topic].name.startswith("camera/") and "image" in topic:
                    continue  # an empty image has no pixels to change
                outlet = FakeOutlet()
                outlet.kind = TOPICS[topic].kind
                if topic == "camera/segmentation":
                    continue
                outlet.pass_through(mode, write(TOPICS[topic].kind()))


def parts(injection: Injection) -> tuple[Injection, ...]:
    return getattr(injection, "parts", (injection,))
