# SPDX-License-Identifier: Apache-2.0
"""Quality-of-service profiles of the interface table in the design, one per kind of topic."""

from __future__ import annotations

from typing import Final

from rclpy.qos import (
    DurabilityPolicy,
    HistoryPolicy,
    QoSProfile,
    ReliabilityPolicy,
    qos_profile_sensor_data,
)

#: The newest message only, delivered for certain: images, scene graphs. Fast DDS drops a
#: best-effort message that is larger than its shared-memory segment, so images are reliable too.
NEWEST: Final = QoSProfile(
    history=HistoryPolicy.KEEP_LAST, depth=1, reliability=ReliabilityPolicy.RELIABLE
)

#: Every message counts: trajectories, markers.
RELIABLE: Final = QoSProfile(
    history=HistoryPolicy.KEEP_LAST, depth=20, reliability=ReliabilityPolicy.RELIABLE
)

#: Every message counts, and those who join later learn how things are: what becomes of a plan.
STATUS: Final = QoSProfile(
    history=HistoryPolicy.KEEP_LAST,
    depth=20,
    reliability=ReliabilityPolicy.RELIABLE,
    durability=DurabilityPolicy.TRANSIENT_LOCAL,
)

#: The last message is kept for those who join later: descriptions, plans, ground truth.
LATCHED: Final = QoSProfile(
    history=HistoryPolicy.KEEP_LAST,
    depth=1,
    reliability=ReliabilityPolicy.RELIABLE,
    durability=DurabilityPolicy.TRANSIENT_LOCAL,
)

#: Best effort, for streams of small messages: joint states, clock, pictures for people.
SENSOR_DATA: Final = qos_profile_sensor_data
