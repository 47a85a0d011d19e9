# SPDX-License-Identifier: Apache-2.0
"""Fast DDS takes what it is told of shared memory, and not only the file's name."""

from __future__ import annotations

import sys

from ros2_run import Spawn, finish

#: Colours and depth of a picture of 640x480 [bytes].
PICTURE = 640 * 480 * (3 + 4)
PROGRAM = """
from pathlib import Path
from tamp_runtime.large_messages import make_room_for_pictures
make_room_for_pictures()
import rclpy
rclpy.init()
node = rclpy.create_node("camera")
sizes = [0]
for line in Path("/proc/self/maps").read_text().splitlines():
    if "/fastrtps_" in line:
        first, last = (int(end, 16) for end in line.split()[0].split("-"))
        sizes.append(last - first)
print(max(sizes))
"""


def test_a_process_that_publishes_pictures_has_shared_memory_for_them(
    domain_id: int, spawn: Spawn
) -> None:
    del domain_id  # it is in the environment
    ended = finish(spawn(sys.executable, "-c", PROGRAM))
    assert ended.code == 0, ended
    assert int(ended.stdout) > PICTURE
