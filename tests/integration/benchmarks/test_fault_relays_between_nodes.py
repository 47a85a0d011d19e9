# SPDX-License-Identifier: Apache-2.0
"""Relays between a publisher and a listener: what arrives is what the mode says."""

from __future__ import annotations

from typing import Any

from faults import damages, picture_damages
from faults.modes import Change, Delay, Drop
from faults.relay import Relays, read
from faults.topics import EXTRINSICS, JOINTS, TOPICS
from geometry_msgs.msg import TransformStamped
from rclpy.node import Node
from sensor_msgs.msg import JointState
from tamp_runtime.qos import LATCHED, RELIABLE


def test_relay_passes_drops_damages_and_passes_again(ros_context: Any) -> None:
    node = ros_context.add(Node("neighbours", context=ros_context.context))
    heard: list[JointState] = []
    topic = TOPICS[JOINTS]
    node.create_subscription(JointState, topic.relayed, heard.append, topic.qos)
    publisher = node.create_publisher(JointState, topic.name, RELIABLE)
    with Relays([topic], context=ros_context.context) as relays:

        def arrives(position: float) -> bool:
            publisher.publish(JointState(name=["a", "b"], position=[position, 0.0]))
            return any(message.position[0] == position for message in heard)

        ros_context.wait_until(lambda: arrives(1.0), what="passed on")
        relays.set(JOINTS, Change(damages.joints_reversed))
        ros_context.wait_until(lambda: not arrives(2.0) and heard[-1].name[0] == "b")
        relays.set(JOINTS, Drop())
        for position in (3.0, 3.5):  # once the second has come, all of the first have
            ros_context.wait_until(
                lambda position=position: not arrives(position) and taken_in(relays) == position
            )
        relays.clear()
        ros_context.wait_until(lambda: arrives(4.0), what="passed on again")
    assert not any(message.position[0] == 3.0 for message in heard)


def taken_in(relays: Relays) -> float:
    """The position that came last to the relay, whatever became of it."""
    relay = relays[JOINTS]
    assert relay.last is not None
    position: float = read(relay, relay.last).position[0]
    return position


def test_what_is_delayed_is_lost_when_the_fault_ends(ros_context: Any) -> None:
    node = ros_context.add(Node("neighbours", context=ros_context.context))
    heard: list[float] = []
    topic = TOPICS[JOINTS]
    node.create_subscription(
        JointState, topic.relayed, lambda message: heard.append(message.position[0]), topic.qos
    )
    publisher = node.create_publisher(JointState, topic.name, RELIABLE)
    with Relays([topic], context=ros_context.context) as relays:

        def arrives(position: float) -> bool:
            publisher.publish(JointState(position=[position]))
            return position in heard

        ros_context.wait_until(lambda: arrives(1.0))
        relays.set(JOINTS, Delay(1000.0))
        for position in (2.0, 2.5):
            ros_context.wait_until(
                lambda position=position: not arrives(position) and taken_in(relays) == position
            )
        relays.clear()
        ros_context.wait_until(lambda: arrives(3.0))
    assert 2.0 not in heard


def test_a_lasting_message_is_damaged_and_mended_for_those_who_have_it(ros_context: Any) -> None:
    node = ros_context.add(Node("neighbours", context=ros_context.context))
    heard: list[float] = []
    topic = TOPICS[EXTRINSICS]
    node.create_subscription(
        TransformStamped,
        topic.relayed,
        lambda message: heard.append(message.transform.translation.y),
        LATCHED,
    )
    publisher = node.create_publisher(TransformStamped, topic.name, LATCHED)
    publisher.publish(TransformStamped())
    with Relays([topic], context=ros_context.context) as relays:
        ros_context.wait_until(lambda: heard, what="the calibration")
        relays.set(EXTRINSICS, Change(picture_damages.moved_by(y=0.25)))
        ros_context.wait_until(lambda: heard[-1] == 0.25, what="the damaged one")
        relays.clear()
        ros_context.wait_until(lambda: heard[-1] == 0.0, what="the right one again")
